// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/reduction.h"

#include <openvdb/Metadata.h>

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/grids/detail/active_tiles.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/reduced_labels.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kReducedLeafGrain = 4;

int floorDiv(int a, int b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

}  // namespace

void convertUnit(const std::string& from, const std::string& to,
                 openvdb::math::Transform& transform) {
  if (from != to) transform.postScale(unitsPerMetre(to).value() / unitsPerMetre(from).value());
}

Coord floorDiv(const Coord& a, int b) {
  return {floorDiv(a.x(), b), floorDiv(a.y(), b), floorDiv(a.z(), b)};
}

int64_t fineVoxels(const Coord& coarse, int factor, const std::optional<Domain>& domain) {
  const Coord low(coarse.x() * factor, coarse.y() * factor, coarse.z() * factor);
  CoordBBox box(low, low.offsetBy(factor - 1));
  if (domain) box.intersect(domain->box());
  return int64_t(box.volume());
}

namespace {

/// A coarse voxel is inside if at least half of its fine ones in the box of the region are: then
/// those that get a label are.
class RegionReduction {
 public:
  explicit RegionReduction(int factor) : factor_(factor) {}

  Domain reduce(const Domain& domain) {
    const MaskTree& region = *domain.region();
    forEachActiveTile(region, [&](const CoordBBox& box) { addBox(box); });
    for (auto leaf = region.cbeginLeaf(); leaf; ++leaf)
      for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel)
        add(detail::floorDiv(voxel.getCoord(), factor_), 1);
    const std::optional<Domain> box(domain.box());
    for (auto voxel = inPart_.cbeginValueOn(); voxel; ++voxel)
      if (2 * int64_t(*voxel) >= fineVoxels(voxel.getCoord(), factor_, box))
        inside_.setValueOn(voxel.getCoord());
    return Domain(inside_);
  }

 private:
  CoordBBox fineBox(const Coord& coarse) const {
    const Coord low(coarse.x() * factor_, coarse.y() * factor_, coarse.z() * factor_);
    return {low, low.offsetBy(factor_ - 1)};
  }

  void addBox(const CoordBBox& box) {
    const CoordBBox touched(detail::floorDiv(box.min(), factor_),
                            detail::floorDiv(box.max(), factor_));
    const CoordBBox whole(detail::floorDiv(box.min().offsetBy(factor_ - 1), factor_),
                          detail::floorDiv(box.max().offsetBy(1), factor_).offsetBy(-1));
    if (!whole.empty()) inside_.sparseFill(whole, true, true);
    if (whole == touched) return;
    for (auto coarse = touched.begin(); coarse != touched.end(); ++coarse) {
      if (whole.isInside(*coarse)) continue;
      CoordBBox part = fineBox(*coarse);
      part.intersect(box);
      add(*coarse, int32_t(part.volume()));
    }
  }

  void add(const Coord& coarse, int32_t fine) {
    accessor_.setValueOn(coarse, accessor_.getValue(coarse) + fine);
  }

  const int factor_;
  MaskTree inside_;
  Int32Tree inPart_;  // fine voxels of coarse ones that no box covers alone
  openvdb::tree::ValueAccessor<Int32Tree> accessor_{inPart_};
};

}  // namespace

Domain reducedDomain(const Domain& domain, int factor) {
  if (!domain.isBox()) return RegionReduction(factor).reduce(domain);
  return CoordBBox(floorDiv(domain.box().min(), factor), floorDiv(domain.box().max(), factor));
}

Reduction::Reduction(const Int32Grid& labels, int factor, const std::optional<Domain>& domain)
    : tree_(withoutTiles(labels)), factor_(factor), domain_(domain) {
  if (factor < 1 || factor > kMaxReduction)
    throw InvalidInput("the reduction must lie between 1 and 256");
  for (const Leaf* leaf : leavesOf(*tree_)) {
    const CoordBBox reduced(floorDiv(leaf->origin(), factor),
                            floorDiv(leaf->origin().offsetBy(7), factor));
    forEachLeafOrigin(reduced, [&](const Coord& origin) { pairs_.push_back({origin, leaf}); });
  }
  std::sort(pairs_.begin(), pairs_.end());
  for (size_t i = 0; i < pairs_.size(); ++i)
    if (i == 0 || pairs_[i].origin != pairs_[i - 1].origin) first_.push_back(i);
  first_.push_back(pairs_.size());
}

void Reduction::run(const std::function<void(size_t, const Coord&, const Cells&)>& f,
                    Interrupter* interrupter) const {
  parallelFor(leafCount(), kReducedLeafGrain, interrupter, [&](size_t begin, size_t end) {
    std::vector<uint64_t> keys;
    for (size_t n = begin; n < end; ++n) {
      const Coord origin = pairs_[first_[n]].origin;
      keys.clear();
      for (size_t i = first_[n]; i < first_[n + 1]; ++i) collect(*pairs_[i].fine, origin, keys);
      std::sort(keys.begin(), keys.end());
      f(n, origin, count(keys, origin));
    }
  });
}

/// One key per labeled voxel: its coarse voxel, then its label.
void Reduction::collect(const Leaf& leaf, const Coord& origin, std::vector<uint64_t>& keys) const {
  const int32_t* values = leaf.buffer().data();
  for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
    const int32_t label = labelAt(leaf, values, voxel.pos());
    if (label == 0) continue;
    const Coord p = floorDiv(voxel.getCoord(), factor_);
    if ((p & ~7) == origin)
      keys.push_back(uint64_t(Leaf::coordToOffset(p)) << 32 | uint32_t(label));
  }
}

Cells Reduction::count(const std::vector<uint64_t>& keys, const Coord& origin) const {
  Cells cells;
  for (size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    const size_t offset = keys[begin] >> 32;
    int64_t most = 0;
    while (end < keys.size() && keys[end] >> 32 == offset) {
      const size_t run = end;
      while (end < keys.size() && keys[end] == keys[run]) ++end;
      if (int64_t(end - run) > most) {
        most = int64_t(end - run);
        cells[offset].label = int32_t(keys[run] & 0xffffffffu);
      }
    }
    Cell& cell = cells[offset];
    cell.labelled = int64_t(end - begin);
    const Coord coarse = origin + Leaf::offsetToLocalCoord(openvdb::Index(offset));
    cell.all = std::max(fineVoxels(coarse, factor_, domain_), cell.labelled);
    cell.majority = most > cell.all - cell.labelled ? cell.label : 0;
  }
  return cells;
}

void forEachPart(const LabelSlabs& labels, int factor,
                 const std::function<void(const Int32Grid&)>& f, Interrupter* interrupter) {
  using Leaf = Int32Tree::LeafNodeType;
  Int32Grid::Ptr waiting = labels.about->deepCopy();
  for (size_t s = 0; s < labels.slabCount(); ++s) {
    const Int32Grid::Ptr slab = labels.read(s, interrupter);
    slab->tree().voxelizeActiveTiles();
    // Nodes are taken from a slab, but not from labels that are whole and may be the caller's.
    if (waiting->empty())
      waiting->setTree(slab->treePtr());
    else
      waiting->tree().merge(slab->tree());
    const int64_t layer = 8 * int64_t(factor), cut = labels.cuts[s + 1];
    const int64_t end = cut - (cut % layer + layer) % layer;
    const Int32Grid::Ptr above = labels.about->deepCopy();
    if (s + 1 < labels.slabCount()) {
      std::vector<Coord> origins;
      for (auto leaf = waiting->tree().cbeginLeaf(); leaf; ++leaf)
        if (leaf->origin().z() >= end) origins.push_back(leaf->origin());
      for (const Coord& origin : origins)
        above->tree().addLeaf(waiting->tree().stealNode<Leaf>(origin, 0, false));
    }
    f(*waiting);
    waiting = above;
  }
}

void placeReduced(openvdb::GridBase& grid, const Int32Grid& labels, int factor,
                  const std::string& name) {
  grid.setName(name);
  copyProvenance(labels, grid);
  if (factor == 1) return;
  // index fine = factor * coarse + (factor - 1) / 2; what is applied first comes last here.
  const auto transform = labels.transform().copy();
  transform->preTranslate(openvdb::Vec3d((factor - 1) / 2.0));
  transform->preScale(factor);
  if (const auto domain = storedDomain(labels)) setDomain(grid, reducedDomain(*domain, factor));
  if (const auto size = storedVoxelSize(labels)) {
    const VoxelSize coarse(
        {size->edges()[0] * factor, size->edges()[1] * factor, size->edges()[2] * factor});
    setStoredVoxelSize(grid, coarse);  // maybe in another unit
    convertUnit(size->unit(), coarse.unit(), *transform);
  }
  grid.setTransform(transform);
}

}  // namespace vdb_madf::detail
