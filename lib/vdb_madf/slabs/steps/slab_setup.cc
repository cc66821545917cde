// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_setup.h"

#include <vector>

#include "vdb_madf/method/detail/check_background.h"
#include "vdb_madf/segmentation/detail/prepare.h"

namespace vdb_madf::detail {

namespace {

class Setup {
 public:
  Setup(SlabWork& work, SlabSegmentation& result) : work_(work), result_(result) {}

  void run() {
    const MaskGrid& about = *work_.plan.object.about;
    Obstacles& obstacles = work_.facts.obstacles;
    obstacles = prepare(about, work_.options, result_);
    CoordBBox extent = countObject();
    fillHoles(extent);
    chooseWeights(about, work_.options, obstacles, extent, result_);
    work_.facts.weights = result_.weights;
    work_.facts.domain = result_.domain;
    checkBackground(obstacles, result_.counts.objectVoxels);
  }

 private:
  /// Returns its box.
  CoordBBox countObject() {
    SegmentCounts& counts = result_.counts;
    CoordBBox extent;
    std::vector<int64_t> sums{0, 0};
    for (size_t s = work_.plan.firstOwn(); s < work_.plan.endOwn(); ++s) {
      const LeafIndex index(work_.plan.object.leaves(s));
      resolveBoundary(index, work_.options.boundary, result_.domain);
      sums[0] += index.voxelCount();
      sums[1] += int64_t(index.leafCount());
      extent.expand(index.boundingBox());
    }
    work_.team.sum(sums);
    counts.objectVoxels = sums[0];
    counts.leaves = sums[1];
    return ofAll(extent);
  }

  CoordBBox ofAll(const CoordBBox& box) const {
    std::vector<int64_t> ends;
    for (int axis = 0; axis < 3; ++axis) {
      ends.push_back(-int64_t(box.min()[axis]));
      ends.push_back(box.max()[axis]);
    }
    work_.team.max(ends);
    return {Coord(int(-ends[0]), int(-ends[2]), int(-ends[4])),
            Coord(int(ends[1]), int(ends[3]), int(ends[5]))};
  }

  /// Adds what is filled to the box.
  void fillHoles(CoordBBox& extent) {
    SegmentCounts& counts = result_.counts;
    const __int128 background =
        work_.facts.obstacles.open ? work_.facts.obstacles.domain.voxelCount() - counts.objectVoxels
                                   : 0;
    const bool any = result_.fillHoles > 1 && counts.objectVoxels > 0 &&
                     !(work_.facts.obstacles.open && background < result_.fillHoles);
    work_.steps.forEachSlab(Step::cavities, [&](size_t s) {
      WorkPart part = work_.steps.part(Step::cavities, s);
      std::vector<LeafIndex::LeafVoxels> found;
      if (any)
        found =
            slabHoles(work_.plan.object, result_.domain, s, result_.open, result_.fillHoles, &part);
      work_.store.write(kCavities, s, found);
      work_.store.send(kHoles, s, kRoot, found);
    });
    const Holes holes = countHoles();
    // Not all background may be filled.
    work_.facts.fillsNone = work_.facts.obstacles.open && background == holes.voxels;
    if (work_.facts.fillsNone) return;
    counts.cavities = holes.count;
    counts.cavityVoxels = holes.voxels;
    extent.expand(holes.box);
  }

  struct Holes {
    int64_t voxels, count;
    CoordBBox box;
  };
  Holes countHoles() {
    Holes found{};
    if (work_.plan.isRoot()) {
      HoleCount holes;
      for (size_t s = 0; s < work_.plan.slabCount(); ++s)
        holes.add(work_.store.receive(kHoles, s, kRoot), work_.plan.begin(s), work_.plan.end(s));
      found = {holes.voxels(), holes.count(), holes.boundingBox()};
    }
    return work_.store.broadcast(found);
  }

  SlabWork& work_;
  SlabSegmentation& result_;
};

}  // namespace

void setUpSlabs(SlabWork& work, SlabSegmentation& result) {
  Setup(work, result).run();
}

}  // namespace vdb_madf::detail
