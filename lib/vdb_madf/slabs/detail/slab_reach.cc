// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_reach.h"

#include <array>
#include <memory>
#include <utility>

#include "vdb_madf/slabs/detail/column_steps.h"

namespace vdb_madf::detail {

namespace {

ByteWriter toBytes(const ColumnSteps& steps) {
  ByteWriter bytes;
  bytes.add(steps.leaves());
  bytes.add(steps.rows());
  return bytes;
}

ColumnSteps toSteps(ByteReader bytes) {
  auto leaves = bytes.vector<std::array<int, 2>>();
  return {std::move(leaves), bytes.vector<ColumnSteps::Rows>()};
}

SlabFaces cutsOf(const SlabWork& work, size_t slab) {
  SlabFaces faces;
  faces.begin = work.begin(slab);
  faces.end = work.end(slab);
  faces.hasBelow = slab > 0;
  faces.hasAbove = slab + 1 < work.slabCount();
  return faces;
}

// Pieces: the columns below a slab's upper cut, and above its lower one. Messages: "steps".
constexpr char kBelowUpper[] = "columns-below-upper", kAboveLower[] = "columns-above-lower";
constexpr char kSteps[] = "steps";

}  // namespace

void exchangeColumns(SlabWork& work) {
  work.forEachSlab([&](size_t s) {
    const SlabBody slab = work.body(s);
    const SlabFaces faces = cutsOf(work, s);
    if (faces.hasAbove)
      work.write(kBelowUpper, s, toBytes(columnSteps(slab.index, work.obstacles, faces, false)));
    if (faces.hasBelow)
      work.write(kAboveLower, s, toBytes(columnSteps(slab.index, work.obstacles, faces, true)));
  });
  work.upward([&](size_t s) {
    if (s + 1 == work.slabCount()) return;
    const SlabFaces faces = facesOf(work, s);
    work.send(kSteps, s, s + 1,
              toBytes(passOn(toSteps(work.read(kBelowUpper, s)), faces.below,
                             work.end(s) - work.begin(s))));
  });
  work.downward([&](size_t s) {
    if (s == 0) return;
    const SlabFaces faces = facesOf(work, s);
    work.send(kSteps, s, s - 1,
              toBytes(passOn(toSteps(work.read(kAboveLower, s)), faces.above,
                             work.end(s) - work.begin(s))));
  });
}

SlabFaces facesOf(const SlabWork& work, size_t slab) {
  SlabFaces faces = cutsOf(work, slab);
  if (work.hasMessage(kSteps, slab - 1, slab))
    faces.below = toSteps(work.receive(kSteps, slab - 1, slab));
  if (work.hasMessage(kSteps, slab + 1, slab))
    faces.above = toSteps(work.receive(kSteps, slab + 1, slab));
  return faces;
}

void forgetColumns(SlabWork& work, size_t slab) {
  work.remove(kBelowUpper, slab);
  work.remove(kAboveLower, slab);
  work.removeMessage(kSteps, slab - 1, slab);
  work.removeMessage(kSteps, slab + 1, slab);
}

void SlabOffers::offer(size_t slab,
                       const std::function<std::vector<ForeignSite>(bool isUpper)>& sites) {
  if (slab + 1 < work_.slabCount()) work_.writeVector(up_.c_str(), slab, sites(true));
  if (slab > 0) work_.writeVector(down_.c_str(), slab, sites(false));
}

void SlabOffers::passOn() {
  const auto pass = [&](size_t s, bool isUpper) {
    const std::string& name = isUpper ? up_ : down_;
    const ColumnSteps columns = toSteps(work_.read(isUpper ? kBelowUpper : kAboveLower, s));
    work_.sendVector(
        name.c_str(), s, isUpper ? s + 1 : s - 1,
        detail::passOn(work_.readVector<ForeignSite>(name.c_str(), s), from(name, s, isUpper),
                       columns, work_.weights.z, work_.cut(s, isUpper)));
  };
  work_.upward([&](size_t s) {
    if (s + 1 < work_.slabCount()) pass(s, true);
  });
  work_.downward([&](size_t s) {
    if (s > 0) pass(s, false);
  });
}

std::vector<ForeignSite> SlabOffers::from(const std::string& name, size_t slab, bool below) const {
  return work_.receiveVector<ForeignSite>(name.c_str(), below ? slab - 1 : slab + 1, slab);
}

std::shared_ptr<const ForeignSites> SlabOffers::received(size_t slab, LeafIndex& index) const {
  return std::make_shared<ForeignSites>(from(up_, slab, true), from(down_, slab, false),
                                        work_.begin(slab), work_.end(slab), index);
}

void SlabOffers::forget(size_t slab) {
  for (const std::string& name : {up_, down_}) {
    work_.remove(name.c_str(), slab);
    work_.removeMessage(name.c_str(), slab - 1, slab);
    work_.removeMessage(name.c_str(), slab + 1, slab);
  }
}

}  // namespace vdb_madf::detail
