// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/simd_level.h"

#include "vdb_madf/base/detail/simd.h"

namespace vdb_madf {

const char* simdLevel() {
#ifdef VDB_MADF_SIMD_V4
  if (__builtin_cpu_supports("x86-64-v4")) return "x86-64-v4";
#endif
#ifdef VDB_MADF_SIMD_V3
  if (__builtin_cpu_supports("x86-64-v3")) return "x86-64-v3";
#endif
  return "baseline";
}

}  // namespace vdb_madf
