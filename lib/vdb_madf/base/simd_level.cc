// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/simd_level.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf {

namespace {

using detail::SimdLevel;

SimdLevel levelOfProcessor() {
#ifdef VDB_MADF_SIMD_LEVELS
  if (__builtin_cpu_supports("x86-64-v4")) return SimdLevel::v4;
  if (__builtin_cpu_supports("x86-64-v3")) return SimdLevel::v3;
#endif
  return SimdLevel::baseline;
}

SimdLevel wantedLevel() {
  const char* const text = std::getenv("VDB_MADF_SIMD_LEVEL");
  if (!text || !*text) return SimdLevel::v4;
  for (const SimdLevel level : {SimdLevel::v4, SimdLevel::v3, SimdLevel::baseline})
    if (text == std::to_string(int(level))) return level;
  throw InvalidInput(
      std::string("the environment variable VDB_MADF_SIMD_LEVEL is 4, 3 or 0, not ") + text);
}

}  // namespace

detail::SimdLevel detail::bestSimdLevel() {
  static const SimdLevel level = std::min(levelOfProcessor(), wantedLevel());
  return level;
}

const char* simdLevel() {
  switch (detail::bestSimdLevel()) {
    case SimdLevel::v4:
      return "x86-64-v4";
    case SimdLevel::v3:
      return "x86-64-v3";
    default:
      return "baseline";
  }
}

}  // namespace vdb_madf
