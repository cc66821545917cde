// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf::python {

/// \param triangles: None for all that there are. @throw InvalidInput
inline GrainMeshOptions meshOptions(int smoothing, const std::optional<int64_t>& triangles) {
  if (triangles && *triangles < 1) throw InvalidInput("triangles: must be 1 or more");
  GrainMeshOptions options;
  options.smoothing = smoothing;
  options.triangles = uint64_t(triangles.value_or(0));
  return options;
}

}  // namespace vdb_madf::python
