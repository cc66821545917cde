// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/domain.h"

namespace vdb_madf::detail {

/// How many pairs of voxels of a domain lie some way apart along an axis. Of a region it keeps the
/// runs of voxels in its rows.
class DomainPairs {
 public:
  DomainPairs(const Domain& domain, int axis);

  /// Counts the pairs of voxels that lie `lag` apart, 1 or more. @throw Interrupted
  double count(int lag, Interrupter* interrupter) const;

 private:
  struct Run {
    int32_t begin, end;
  };
  class RowCollector;

  double section_ = 0;  // of a box
  int extent_ = 0;
  bool isBox_ = true;
  std::vector<Run> runs_;     // of a region: row by row, ascending in each
  std::vector<size_t> rows_;  // the first run of each row, and the end of the last
};

}  // namespace vdb_madf::detail
