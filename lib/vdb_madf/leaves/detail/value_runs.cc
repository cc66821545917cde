// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/value_runs.h"

#include <algorithm>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf::detail {

namespace {

VDB_MADF_KERNEL uint64_t differing(const uint32_t* values, const uint32_t* others) {
  uint8_t differ[64];
  for (size_t i = 0; i < 64; ++i) differ[i] = values[i] != others[i];
  return wordOfBytes(differ);
}

}  // namespace

uint64_t runStarts(const uint32_t* values, size_t count, uint32_t before) {
  uint32_t row[1 + 64];
  row[0] = before;
  std::copy_n(values, count, row + 1);
  std::fill(row + 1 + count, row + 65, row[count]);  // no further start
  return atBestLevel([&]() VDB_MADF_INLINE { return differing(row + 1, row); });
}

}  // namespace vdb_madf::detail
