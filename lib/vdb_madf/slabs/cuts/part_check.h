// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "vdb_madf/segmentation/graph_part.h"

namespace vdb_madf::detail {

/// Are parts those of one graph, slab after slab from the lowest on? So that merging them is safe.
class PartCheck {
 public:
  /// @param criticalPoints how many the graph has
  explicit PartCheck(uint32_t criticalPoints) : seen_(criticalPoints, false) {}
  /// @throw InvalidInput
  void add(const GraphPart& part);
  /// Comes after the last part. @throw InvalidInput
  void finish() const;

 private:
  std::vector<bool> seen_;                          // by number - 1
  std::map<uint32_t, ManifoldGraph::Node> goesOn_;  // by number
};

}  // namespace vdb_madf::detail
