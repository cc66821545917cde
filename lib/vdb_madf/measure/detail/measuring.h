// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "vdb_madf/labels/detail/label_digest.h"
#include "vdb_madf/measure/detail/component_count.h"
#include "vdb_madf/measure/detail/grain_representatives.h"
#include "vdb_madf/measure/detail/grain_shapes.h"
#include "vdb_madf/measure/detail/label_sums.h"
#include "vdb_madf/measure/detail/voronoi_cells.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf::detail {

/// Measures labels that come in slabs, of which all labels may be the only one. First each is
/// surveyed, then each is added, in ascending order.
class Measuring {
 public:
  /// \p about: has the transform and the metadata of the labels.
  /// @throw InvalidInput for options that are wrong
  Measuring(const Int32Grid& about, const MeasureOptions& options);

  /// @throw InvalidInput if labels leave the domain, or options do not fit it
  void survey(const LabelLeaves& slab);

  // What the survey finds.
  const CoordBBox& object() const { return object_; }
  int64_t voxels() const { return voxels_; }
  const Obstacles& obstacles() const { return obstacles_; }
  const Domain& whole() const { return *whole_; }  ///< the domain, or what stands for it
  /// The metric of the object. @throw InvalidInput if no weights fit
  const VoxelWeights& weights();
  /// Distances have to be measured for representatives; otherwise there is no background.
  bool hasBackground() const;
  /// Depths of bonds, to be filled with the representatives; null: not asked for.
  BondDepths* bondDepths() { return options_.bondRadii ? &bondDepths_ : nullptr; }

  /// A label, and whether none of its voxels are in slabs to come.
  using IsComplete = std::function<bool(int32_t label)>;
  /// \p slab: the leaves in these layers; \p around: also those next to them. @throw Interrupted
  void add(const LabelLeaves& slab, const LabelLeaves& around, const LeafLayers& layers,
           const IsComplete& isComplete, Interrupter* interrupter);

  /// \p correlationLengths: in voxels. @throw Interrupted
  Measurements finish(const GrainRepresentatives& representatives,
                      const std::array<std::optional<double>, 3>& correlationLengths,
                      Interrupter* interrupter);

 private:
  void setCells(std::vector<GrainMeasures>& grains, Interrupter* interrupter) const;
  void setRepresentatives(const GrainRepresentatives& representatives, Measurements& result);

  const Int32Grid* about_;
  MeasureOptions options_;
  VoxelShape voxel_;
  std::optional<Domain> domain_;
  Obstacles obstacles_;
  CoordBBox object_;
  int64_t voxels_ = 0;
  LabelDigest digest_;
  std::optional<Domain> whole_;
  std::optional<VoxelWeights> weights_;
  std::optional<LabelSums> sums_;
  std::vector<BondMeasures> bonds_;
  BondDepths bondDepths_;
  GrainShapes shapes_;
  std::optional<VoronoiCells> cells_;
  ComponentCount components_;
  int64_t euler_ = 0;
};

}  // namespace vdb_madf::detail
