// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/method/graph_part.h"
#include "vdb_madf/slabs/detail/merge_group.h"

namespace vdb_madf::detail {

/// The grains of a graph, as merge() makes and numbers them.
struct PartGrains {
  std::vector<uint32_t> grainOfClass;  ///< 0: the class holds no voxel of the object
  std::vector<Coord> representative;   ///< of grain g at g - 1
};

/// merge() for a graph that comes in parts, one after the other. In memory are the classes and edges
/// that later parts may still decide about, and a few numbers for each class.
class MergeParts {
 public:
  explicit MergeParts(const MergeRule& rule) : rule_(rule) {}

  /// @return the class of each node of the part
  std::vector<uint32_t> add(const GraphPart& part);
  /// After the last part.
  PartGrains finish();

 private:
  /// What is known of a class.
  struct About {
    Coord representative;  ///< so far: of largest D, then of smaller coordinate
    int32_t top = -1;
    bool hasVoxels = false;
    void add(const About& other);
  };
  static constexpr uint32_t kNone = ~0u;

  std::vector<uint32_t> placesOf(const GraphPart& part);
  void addEdges(const ManifoldGraph& graph, const std::vector<uint32_t>& place);
  void follow(const std::vector<uint32_t>& after);
  void dropDecided();

  MergeRule rule_;
  MergeGroup group_;
  std::vector<About> about_;        // of each class of the group
  std::vector<uint32_t> number_;    // of each class of the group; kNone: it has none yet
  std::map<Coord, uint32_t> open_;  // class, in the group, of each node that goes on
  DisjointSets numbers_{0};
  std::vector<About> aboutNumber_;  // of each number that is the root of its set
};

}  // namespace vdb_madf::detail
