// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_reach.h"

#include <array>
#include <memory>
#include <utility>

#include "vdb_madf/slabs/cuts/column_steps.h"

namespace vdb_madf::detail {

template <>
struct Stored<ColumnSteps> {
  static void write(ByteWriter& bytes, const ColumnSteps& steps) {
    bytes.add(steps.leaves());
    bytes.add(steps.rows());
  }
  static ColumnSteps read(ByteReader bytes) {
    auto leaves = bytes.vector<std::array<int, 2>>();
    return {std::move(leaves), bytes.vector<ColumnSteps::Rows>()};
  }
};

namespace {

SlabFaces cutsOf(const SlabWork& work, size_t slab) {
  SlabFaces faces;
  faces.begin = work.plan.begin(slab);
  faces.end = work.plan.end(slab);
  faces.hasBelow = slab > 0;
  faces.hasAbove = slab + 1 < work.plan.slabCount();
  return faces;
}

}  // namespace

void exchangeColumns(SlabWork& work) {
  work.steps.forEachSlab(Step::columns, [&](size_t s) {
    const SlabBody slab = work.body(s);
    const SlabFaces faces = cutsOf(work, s);
    const auto columns = [&](bool above) {
      return columnSteps(slab.index, work.facts.obstacles, faces, above);
    };
    if (faces.hasAbove) work.store.write(kColumnsBelowUpper, s, columns(false));
    if (faces.hasBelow) work.store.write(kColumnsAboveLower, s, columns(true));
  });
  const auto tell = [&](size_t s, size_t to, const ColumnSteps& own, const ColumnSteps& beyond) {
    work.store.send(kColumnsBeyond, s, to,
                    passOn(own, beyond, work.plan.end(s) - work.plan.begin(s)));
  };
  work.steps.upward(Step::columnsUp, [&](size_t s) {
    if (s + 1 < work.plan.slabCount())
      tell(s, s + 1, work.store.read(kColumnsBelowUpper, s), facesOf(work, s).below);
  });
  work.steps.downward(Step::columnsDown, [&](size_t s) {
    if (s > 0) tell(s, s - 1, work.store.read(kColumnsAboveLower, s), facesOf(work, s).above);
  });
}

SlabFaces facesOf(const SlabWork& work, size_t slab) {
  SlabFaces faces = cutsOf(work, slab);
  faces.below = work.store.receive(kColumnsBeyond, slab - 1, slab);
  faces.above = work.store.receive(kColumnsBeyond, slab + 1, slab);
  return faces;
}

void SlabOffers::offer(size_t slab,
                       const std::function<std::vector<ForeignSite>(bool isUpper)>& sites) {
  if (slab + 1 < work_.plan.slabCount()) work_.store.write(names_.up, slab, sites(true));
  if (slab > 0) work_.store.write(names_.down, slab, sites(false));
}

void SlabOffers::passOn() {
  const auto joined = [&](size_t s, bool isUpper) {
    return detail::passOn(work_.store.read(isUpper ? names_.up : names_.down, s),
                          isUpper ? fromBelow(s) : fromAbove(s),
                          work_.store.read(isUpper ? kColumnsBelowUpper : kColumnsAboveLower, s),
                          work_.facts.weights.z, work_.plan.cut(s, isUpper));
  };
  work_.steps.upward(names_.stepUp, [&](size_t s) {
    if (s + 1 < work_.plan.slabCount())
      work_.store.send(names_.fromBelow, s, s + 1, joined(s, true));
  });
  work_.steps.downward(names_.stepDown, [&](size_t s) {
    if (s > 0) work_.store.send(names_.fromAbove, s, s - 1, joined(s, false));
  });
}

std::vector<ForeignSite> SlabOffers::fromBelow(size_t slab) const {
  return work_.store.receive(names_.fromBelow, slab - 1, slab);
}
std::vector<ForeignSite> SlabOffers::fromAbove(size_t slab) const {
  return work_.store.receive(names_.fromAbove, slab + 1, slab);
}

std::shared_ptr<const ForeignSites> SlabOffers::received(size_t slab, LeafIndex& index) const {
  return std::make_shared<ForeignSites>(fromBelow(slab), fromAbove(slab), work_.plan.begin(slab),
                                        work_.plan.end(slab), index);
}

}  // namespace vdb_madf::detail
