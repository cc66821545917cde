// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/grain_name.h"

#include <cstdio>

namespace vdb_madf {

std::string grainName(int32_t label) {
  char name[24];
  std::snprintf(name, sizeof name, "grain_%06d", int(label));
  return name;
}

}  // namespace vdb_madf
