// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/grain_shape.h"

namespace vdb_madf {

int zinggClass(const std::array<double, 3>& axes) {
  const bool thickAcross = 3 * axes[1] > 2 * axes[0], thickThrough = 3 * axes[2] > 2 * axes[1];
  if (thickAcross) return thickThrough ? 2 : 1;
  return thickThrough ? 4 : 3;
}

}  // namespace vdb_madf
