// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/resampled_grid.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/cubes_along.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/active_tiles.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/grids/grid_metadata.h"

namespace vdb_madf {

namespace {

using openvdb::Index;
using openvdb::Vec3d;
using MaskLeaf = MaskTree::LeafNodeType;
using LabelLeaf = Int32Tree::LeafNodeType;

constexpr size_t kResampledLeafGrain = 4;

/// The cubes in the place of a grid's voxels.
class Cubes {
 public:
  Cubes(const openvdb::GridBase& grid, double edge)
      : grid_(grid), domain_(storedDomain(grid)), size_(edge) {
    const CoordBBox active = grid.evalActiveVoxelBoundingBox();
    box_ = domain_ ? domain_->box() : active;
    if (domain_ && !active.empty() && !box_.isInside(active))
      throw InvalidInput("it leaves its domain: crop it, or give a domain that holds it");
    if (box_.empty()) box_ = CoordBBox(Coord(0), Coord(0));
    const auto voxels = storedVoxelSize(grid);
    if (!voxels || !hasVoxelsAlongAxes(grid))
      throw InvalidInput("the size of its voxels is unknown: give it", Hint::voxelSize);
    for (size_t axis = 0; axis < 3; ++axis) {
      along_.emplace_back(voxels->edges()[axis], edge);
      count_[int(axis)] =
          along_[axis].countFor(int64_t(box_.max()[int(axis)]) - box_.min()[int(axis)] + 1);
    }
  }

  const std::optional<Domain>& domain() const { return domain_; }  ///< of the voxels
  const CoordBBox& box() const { return box_; }                    ///< of the voxels
  const detail::CubesAlong& along(int axis) const { return along_[size_t(axis)]; }
  CoordBBox cubes() const { return {Coord(0), count_.offsetBy(-1)}; }
  /// Cubes in the place of one voxel.
  double perVoxel() const {
    double cubes = 1;
    for (const detail::CubesAlong& along : along_)
      cubes *= double(along.voxelEdge()) / double(along.cubeEdge());
    return cubes;
  }
  /// The volume of a cube.
  int64_t volume() const {
    return along_[0].cubeEdge() * along_[1].cubeEdge() * along_[2].cubeEdge();
  }

  /// The cubes that some voxels of the box touch; those that they fill.
  CoordBBox touched(const CoordBBox& voxels) const { return cubesOf(voxels, false); }
  CoordBBox filled(const CoordBBox& voxels) const { return cubesOf(voxels, true); }

  /// Tells a grid of cubes what its voxels' grid says of itself, but for the domain, and where it
  /// lies.
  void place(openvdb::GridBase& result) const {
    result.setName(grid_.getName());
    copyProvenance(grid_, result);
    const Vec3d edges = *detail::edgesAlongAxes(grid_.transform());
    const Vec3d corner = grid_.transform().indexToWorld(box_.min().asVec3d() - Vec3d(0.5));
    const auto voxels = *storedVoxelSize(grid_);
    setVoxelSize(result, size_);  // maybe in another unit
    Vec3d center, signs;
    for (int axis = 0; axis < 3; ++axis) {
      const double meters = voxels.edges()[size_t(axis)] / std::abs(edges[axis]);
      signs[axis] = edges[axis] < 0 ? -1 : 1;
      center[axis] = corner[axis] * meters * (size_.inUnit() / size_.edge()) +
                     signs[axis] * size_.inUnit() / 2;
    }
    if (signs != Vec3d(1)) result.transform().preScale(signs);
    if (center != Vec3d(0)) result.transform().postTranslate(center);
  }

 private:
  CoordBBox cubesOf(const CoordBBox& voxels, bool whole) const {
    CoordBBox result;
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t cube = along(axis).cubeEdge(),
                    begin =
                        (int64_t(voxels.min()[axis]) - box_.min()[axis]) * along(axis).voxelEdge(),
                    end = (int64_t(voxels.max()[axis]) - box_.min()[axis] + 1) *
                          along(axis).voxelEdge();
      result.min()[axis] = int((begin + (whole ? cube - 1 : 0)) / cube);
      result.max()[axis] = int((end + (whole ? 0 : cube - 1)) / cube) - 1;
    }
    result.intersect(cubes());
    return result;
  }

  const openvdb::GridBase& grid_;
  const std::optional<Domain> domain_;
  const VoxelSize size_;
  CoordBBox box_;
  std::vector<detail::CubesAlong> along_;
  Coord count_;
};

/// The voxels of a tree by the share of cubes that they fill.
class AreaResampling {
 public:
  AreaResampling(const MaskTree& tree, const Cubes& cubes) : cubes_(cubes) {
    detail::forEachActiveTile(tree, [&](const CoordBBox& box) { addTile(box); });
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf)
      if (!leaf->isEmpty()) add({leaf->getNodeBoundingBox(), &*leaf}, CoordBBox());
    std::sort(pairs_.begin(), pairs_.end());
    for (size_t i = 0; i < pairs_.size(); ++i)
      if (i == 0 || pairs_[i].first != pairs_[i - 1].first) first_.push_back(i);
    first_.push_back(pairs_.size());
  }

  MaskTree run(Interrupter* interrupter) {
    detail::addLeaves(result_, first_.size() - 1, kResampledLeafGrain, interrupter,
                      [&](size_t n) { return leafOf(n); });
    return std::move(result_);
  }

 private:
  /// Active voxels: those of a leaf node, or all of a box.
  struct Piece {
    CoordBBox box;
    const MaskLeaf* leaf;
  };
  /// What a voxel (or a whole box) and a cube have in common along an axis.
  struct Overlap {
    Index part, cube;  ///< within their leaf nodes; 0 for a whole box
    int64_t length;
  };
  using Sums = std::array<int64_t, MaskLeaf::SIZE>;

  /// Leaf nodes of cubes inside the box are full.
  void addTile(const CoordBBox& box) {
    const CoordBBox filled = cubes_.filled(box);
    CoordBBox leaves;  // whole ones
    if (!filled.empty())
      leaves = {filled.min().offsetBy(7) & ~7, (filled.max().offsetBy(1) & ~7).offsetBy(-1)};
    if (!leaves.empty()) result_.sparseFill(leaves, true, true);
    add({box, nullptr}, leaves);
  }

  void add(const Piece& piece, const CoordBBox& done) {
    const auto number = uint32_t(pieces_.size());
    pieces_.push_back(piece);
    CoordBBox voxels = piece.box;
    voxels.intersect(cubes_.box());
    detail::forEachLeafOrigin(cubes_.touched(voxels), [&](const Coord& origin) {
      if (!done.isInside(origin)) pairs_.emplace_back(origin, number);
    });
  }

  std::unique_ptr<MaskLeaf> leafOf(size_t n) const {
    Sums sums{};
    const Coord origin = pairs_[first_[n]].first;
    for (size_t i = first_[n]; i < first_[n + 1]; ++i)
      addVolumes(pieces_[pairs_[i].second], origin, sums);
    std::unique_ptr<MaskLeaf> leaf;
    for (Index i = 0; i < MaskLeaf::SIZE; ++i) {
      if (2 * sums[i] < cubes_.volume()) continue;
      if (!leaf) leaf = std::make_unique<MaskLeaf>(origin, false);
      leaf->setValueOn(i);
    }
    return leaf;
  }

  void addVolumes(const Piece& piece, const Coord& origin, Sums& sums) const {
    std::array<std::vector<Overlap>, 3> overlaps;
    for (int axis = 0; axis < 3; ++axis)
      overlaps[size_t(axis)] = overlapsAlong(piece, origin, axis);
    for (const Overlap& x : overlaps[0])
      for (const Overlap& y : overlaps[1])
        for (const Overlap& z : overlaps[2])
          if (!piece.leaf || piece.leaf->isValueOn(x.part * 64 + y.part * 8 + z.part))
            sums[x.cube * 64 + y.cube * 8 + z.cube] += x.length * y.length * z.length;
  }

  std::vector<Overlap> overlapsAlong(const Piece& piece, const Coord& origin, int axis) const {
    const int64_t voxel = cubes_.along(axis).voxelEdge(), cube = cubes_.along(axis).cubeEdge();
    const int64_t first = int64_t(piece.box.min()[axis]) - cubes_.box().min()[axis],
                  last = int64_t(piece.box.max()[axis]) - cubes_.box().min()[axis];
    const int64_t step = piece.leaf ? 1 : last - first + 1;
    const int lastCube = std::min(origin[axis] + 7, cubes_.cubes().max()[axis]);
    std::vector<Overlap> overlaps;
    for (int64_t i = std::max(first, int64_t(0)); i <= last; i += step) {
      const int64_t begin = i * voxel, end = (i + step) * voxel;
      for (int64_t j = std::max(begin / cube, int64_t(origin[axis]));
           j <= lastCube && j * cube < end; ++j)
        overlaps.push_back({piece.leaf ? Index(i - first) : 0, Index(j - origin[axis]),
                            std::min(end, (j + 1) * cube) - std::max(begin, j * cube)});
    }
    return overlaps;
  }

  const Cubes& cubes_;
  MaskTree result_;
  std::vector<Piece> pieces_;
  std::vector<std::pair<Coord, uint32_t>>
      pairs_;                  // a leaf node of cubes, and what fills some of it
  std::vector<size_t> first_;  // of each leaf node
};

/// The domain of a grid of cubes; none if that of the voxels is unknown.
std::optional<Domain> domainOf(const Cubes& cubes, Interrupter* interrupter) {
  const auto& domain = cubes.domain();
  if (!domain || domain->isBox())
    return domain ? std::optional<Domain>(cubes.cubes()) : std::nullopt;
  return Domain(AreaResampling(*domain->region(), cubes).run(interrupter));
}

/// The labels nearest to cubes.
class NearestLabels {
 public:
  NearestLabels(const Int32Tree& tree, const Cubes& cubes, const std::optional<Domain>& domain)
      : tree_(tree), cubes_(cubes), domain_(domain) {
    detail::forEachActiveTile(tree, [&](const CoordBBox& box) { add(box); });
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf)
      if (!leaf->isEmpty()) add(leaf->getNodeBoundingBox());
    detail::sortUnique(origins_);
  }

  void run(Int32Tree& result, Interrupter* interrupter) const {
    std::vector<std::unique_ptr<LabelLeaf>> leaves(origins_.size());
    detail::parallelFor(leaves.size(), kResampledLeafGrain, interrupter,
                        [&](size_t begin, size_t end) {
                          const openvdb::tree::ValueAccessor<const Int32Tree, false> voxels(tree_);
                          for (size_t n = begin; n < end; ++n)
                            leaves[n] = leafOf(origins_[n], voxels);
                        });
    for (auto& leaf : leaves)
      if (leaf) result.addLeaf(leaf.release());
  }

 private:
  void add(CoordBBox voxels) {
    voxels.intersect(cubes_.box());
    detail::forEachLeafOrigin(cubes_.touched(voxels),
                              [&](const Coord& origin) { origins_.push_back(origin); });
  }

  template <typename Accessor>
  std::unique_ptr<LabelLeaf> leafOf(const Coord& origin, const Accessor& voxels) const {
    CoordBBox box = CoordBBox::createCube(origin, 8);
    box.intersect(domain_ ? domain_->box() : cubes_.cubes());
    std::unique_ptr<LabelLeaf> leaf;
    for (auto cube = box.begin(); cube; ++cube) {
      Coord voxel = cubes_.box().min();
      for (int axis = 0; axis < 3; ++axis)
        voxel[axis] += int(cubes_.along(axis).nearestVoxel((*cube)[axis]));
      int32_t label = 0;
      if (!voxels.probeValue(voxel, label) || label <= 0) continue;
      if (domain_ && !domain_->isInside(*cube)) continue;
      if (!leaf) leaf = std::make_unique<LabelLeaf>(origin, 0, false);
      leaf->setValueOn(LabelLeaf::coordToOffset(*cube), label);
    }
    return leaf;
  }

  const Int32Tree& tree_;
  const Cubes& cubes_;
  const std::optional<Domain>& domain_;
  std::vector<Coord> origins_;
};

/// Of a leaf node, with its share of the tree.
constexpr double kMaskLeafBytes = 128, kLabelLeafBytes = 2224;

void checkSize(const openvdb::GridBase& grid, const Cubes& cubes, double leafBytes) {
  const double voxels = double(grid.activeVoxelCount()) * cubes.perVoxel();
  detail::checkCubes(voxels, voxels / LabelLeaf::SIZE * leafBytes);
}

}  // namespace

MaskGrid::Ptr resampleMask(const MaskGrid& mask, double edge, Interrupter* interrupter) {
  const Cubes cubes(mask, edge);
  checkSize(mask, cubes, kMaskLeafBytes);
  detail::WorkPart region(interrupter, 0, 20), object(interrupter, 20, 100);
  const auto domain = domainOf(cubes, &region);
  const auto tree = std::make_shared<MaskTree>(AreaResampling(mask.tree(), cubes).run(&object));
  const auto result = MaskGrid::create(tree);
  cubes.place(*result);
  if (domain) setDomain(*result, *domain);
  return result;
}

Int32Grid::Ptr resampleLabels(const Int32Grid& labels, double edge, Interrupter* interrupter) {
  const Cubes cubes(labels, edge);
  checkSize(labels, cubes, kLabelLeafBytes);
  detail::WorkPart region(interrupter, 0, 20), object(interrupter, 20, 100);
  const auto domain = domainOf(cubes, &region);
  const auto result = Int32Grid::create(0);
  NearestLabels(labels.tree(), cubes, domain).run(result->tree(), &object);
  cubes.place(*result);
  if (domain) setDomain(*result, *domain);
  return result;
}

}  // namespace vdb_madf
