// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/slabs/scratch.h"
#include "vdb_madf/slabs/team.h"

namespace vdb_madf {

/// An object cut into slabs along z.
struct SlabObject {
  /// Slab s is cuts[s] <= z < cuts[s + 1]: multiples of 8, ascending, around the domain (an open
  /// one) or else the object.
  std::vector<int> cuts;
  /// The leaves of a slab that hold object, ascending by origin. Called more than once.
  std::function<std::vector<LeafIndex::LeafVoxels>(size_t slab)> leaves;
  /// Its transform and metadata are those of the object, as segment() reads them; it has no voxels.
  MaskGrid::ConstPtr about;

  size_t slabCount() const { return cuts.empty() ? 0 : cuts.size() - 1; }
};

/// What a part of the work took. Of a run that goes on: of that run alone.
struct SlabStage {
  std::string name;
  double seconds = 0;        ///< of the member that took longest
  int64_t messageBytes = 0;  ///< sent from slab to slab, by all members
};

/// What segmentSlabs() finds beside the labels.
struct SlabSegmentation : SegmentationRecord {
  std::vector<int64_t> grainVoxels;  ///< voxels of grain g at g - 1
  std::vector<SlabStage> stages;     ///< in their order
  int64_t exchanges = 0;             ///< how often messages were exchanged
};

/// The parts that lie in a slab of grids of a Segmentation, with their metadata.
struct SlabGrids {
  Int32Grid::Ptr grain;
  /// None unless kept; carries its part of the graph (graph_metadata.h) in place of the graph.
  Int32Grid::Ptr manifold;
};

/// Gets the grids of a slab.
using PutSlab = std::function<void(size_t slab, const SlabGrids& grids)>;

/// segment() for an object that need not fit in memory: the same labels, bit for bit. One slab is
/// worked on at a time; what is known of the others is in `scratch`. Memory and proofs: README.md.
///
/// If the pieces of a run that did not end are in `scratch`, of the same object and options, it
/// goes on where that stopped.
/// @param put is called for each slab, from the lowest on (not again for those that a run before
///   had put: isSlabPut())
/// keepManifold is the only option that keeps a grid here. maxMemory has to be 0: what a slab
/// takes follows from the cuts.
/// @throw as segment(); InvalidInput for other options, cuts that are none, slabs, but for the
///   first and the last, lower than `tidy` has rounds, or balls that reach too far; what scratch
///   and put throw.
SlabSegmentation segmentSlabs(const SlabObject& object, const SegmentOptions& options,
                              Scratch& scratch, const PutSlab& put,
                              Interrupter* interrupter = nullptr);

/// Lets several processes do the same: all call it, with equal arguments but for their scratch (it
/// may be one that all share). Each works on slabs of its own, which alone it asks for and puts
/// (with cavities to fill it also asks for those that are less than `fillHoles` voxels away, and in
/// a region, where scratch is shared, for any). Counts and boundary are known to all, the voxels of
/// grains to member 0. What is in a scratch that was shared does not depend on the number of
/// members: any number may go on with it.
SlabSegmentation segmentSlabs(const SlabObject& object, const SegmentOptions& options,
                              Scratch& scratch, Team& team, const PutSlab& put,
                              Interrupter* interrupter = nullptr);

/// Were the labels of a slab put by a run before, so that they are not put again?
bool isSlabPut(const Scratch& scratch, size_t slab);

}  // namespace vdb_madf
