// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/method/hierarchy.h"
#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/method/merge.h"
#include "vdb_madf/method/tidy.h"

namespace vdb_madf::detail {

/// Manifolds that are a grain of the segmentation or a part of one, with their voxels.
struct GrainPart {
  /// The grain's number for the part that has the representative of its grain; for others the
  /// number of grains plus that of the manifold that represents the part. No two disjoint parts
  /// share it.
  int32_t number = 0;
  int32_t grain = 0;            ///< of the segmentation
  std::vector<uint32_t> nodes;  ///< of the graph, ascending; of a whole grain none until wanted
  std::vector<LeafIndex::LeafVoxels> voxels;  ///< ascending by origin, none empty
  int64_t voxelCount = 0;
};

/// What the grains of a segmentation consist of, as its manifolds and their graph tell it: a tree
/// of parts for each grain, which depends on the segmentation alone. The halves of a part are the
/// two sides of the last join that made it, if score merged it (last_join.h), else, or if it is of
/// one class, of its weakest neck (weakest_neck.h). A voxel goes to the half that has its manifold;
/// what tidying gave to the grain from others is filled from the voxels around, in synchronous
/// rounds; then the halves are tidied, in as many rounds as the segmentation was, without regard to
/// other grains.
class GrainParts {
 public:
  /// @param labels whose metadata say how the manifolds were merged
  /// @throw InvalidInput if they do not, or there is no graph, or it does not fit; Interrupted.
  GrainParts(const Int32Grid& manifold, const Int32Grid& labels, Interrupter* interrupter);

  /// What a grain of edited labels is divided into, two or more, ascending by number.
  /// @throw InvalidInput if it is a single manifold, or its voxels are not those of parts.
  std::vector<GrainPart> divide(const Int32Grid& labels, int32_t grain,
                                Interrupter* interrupter) const;

  /// No part has a greater number.
  int32_t largestNumber() const { return largestNumber_; }

 private:
  std::vector<LeafIndex::LeafVoxels> voxelsOf(int32_t grain, Interrupter* interrupter) const;
  static GrainPart wholeGrain(int32_t grain, std::vector<LeafIndex::LeafVoxels> voxels);
  std::vector<uint32_t> nodesOf(int32_t grain) const;
  /// Adds the largest parts of a grain of the segmentation that `wanted` consists of; false if some
  /// of it is none.
  bool addParts(GrainPart whole, const std::vector<LeafIndex::LeafVoxels>& wanted,
                std::vector<GrainPart>& parts, Interrupter* interrupter) const;
  /// Absent: the voxels are all of one manifold.
  std::optional<std::array<GrainPart, 2>> halves(const GrainPart& part,
                                                 Interrupter* interrupter) const;
  VoxelArray<uint32_t> placesIn(const GrainPart& part, const LeafIndex& index,
                                Interrupter* interrupter) const;
  int32_t numberOf(int32_t grain, const std::vector<uint32_t>& nodes) const;

  const Int32Grid& manifold_;
  ManifoldGraph graph_;
  Merging merging_;
  std::optional<Hierarchy> hierarchy_;  // if score merged them
  int tidyRounds_ = 0;
  LeafIndex index_;     // of all manifolds
  GrainLabels grains_;  // of the segmentation, on these
  int32_t largestNumber_ = 0;
};

}  // namespace vdb_madf::detail
