// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/slabs/cuts/merge_group.h"
#include "vdb_madf/slabs/cuts/slab_part.h"

namespace vdb_madf::detail {

/// What others still decide about of the graph in a range of slabs.
struct OpenGraph {
  /// What is known of a class.
  struct About {
    Coord representative;  ///< so far: of largest D, then of smaller coordinate
    int32_t top = -1;
    bool hasVoxels = false;
    void add(const About& other);
  };
  /// A critical point that slabs below or above the range know, too.
  struct Node {
    Coord position;
    uint32_t classIndex;
    bool startsBelow, goesOn;
  };
  MergeGroup group;
  std::vector<About> about;  ///< what is known of each class of the group
  std::vector<Node> nodes;   ///< ascending

  template <typename Self>
  static auto storedFields(Self& self) {
    return std::tie(self.group.classes, self.group.edges, self.about, self.nodes);
  }
};

/// merge() for the graph in a range of slabs, which grows upward: by the part of the next slab, or
/// by the next range, merged apart. In memory are the classes and edges that slabs beyond the range
/// may still decide about, and a few numbers for each class. How the whole is divided into ranges,
/// and in what order neighbors are joined, does not matter (README.md says why).
class MergeParts {
 public:
  /// @param keepsEmpty are classes without a voxel of the object numbered, too?
  explicit MergeParts(const MergeRule& rule, bool keepsEmpty = false)
      : rule_(rule), keepsEmpty_(keepsEmpty) {}

  /// The part of the next slab. @return the class of each node of the part
  std::vector<uint32_t> add(const SlabPart& part);
  /// What is open of the next range. @return the class of each one in it
  std::vector<uint32_t> add(OpenGraph above);

  /// Nothing is added any more: what is open is handed over.
  OpenGraph handOver();
  /// The grains that nothing open belongs to: their representatives, ascending.
  std::vector<Coord> decided();
  /// The grain of each class; 0: it holds no voxel of the object.
  /// @param ofDecided those of decided()
  /// @param ofOpen those of the classes that were handed over; none if nobody has them
  std::vector<uint32_t> grains(const std::vector<uint32_t>& ofDecided,
                               const std::vector<uint32_t>& ofOpen);

 private:
  using About = OpenGraph::About;
  static constexpr uint32_t kNone = ~0u;

  OpenGraph openGraph(const SlabPart& part) const;
  void joinNodes(const std::vector<OpenGraph::Node>& above);
  void follow(const std::vector<uint32_t>& after);
  void dropDecided();

  MergeRule rule_;
  bool keepsEmpty_;
  OpenGraph open_;
  std::vector<uint32_t> number_;  // of each class that is open; kNone: it has none yet
  DisjointSets numbers_{0};
  std::vector<About> aboutNumber_;  // of each number that is the root of its set
  std::vector<uint32_t> decided_;   // numbers
};

}  // namespace vdb_madf::detail
