// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/level_sets.h"

#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>
#include <memory>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/grain_name.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/shapes/detail/mesh_distance.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf {

namespace {

constexpr float kMaxHalfWidth = 16;
void check(const Int32Grid& labels, const LevelSetOptions& options) {
  if (!(options.halfWidth >= 1) || options.halfWidth > kMaxHalfWidth)
    throw InvalidInput("the half width of the narrow band must lie between 1 and 16 voxels");
  requireCubicVoxels(labels, "a level set");  // OpenVDB's level sets have one edge
}

using FloatLeaf = FloatGrid::TreeType::LeafNodeType;

/// The part of a level set in a box of voxels with these squared distances, if it has any voxel of
/// the band; `inside`: the leaf of the labels, if there is one.
std::unique_ptr<FloatLeaf> makeLeaf(const Coord& origin, const CoordBBox& box,
                                    const std::vector<float>& squares,
                                    const Int32Tree::LeafNodeType* inside, int32_t label,
                                    float halfWidth, float edge) {
  const Coord size = box.dim(), from = origin - box.min();
  const float outside = halfWidth * edge;
  std::unique_ptr<FloatLeaf> leaf;
  const auto squareAt = [&](openvdb::Index i) {
    const Coord p = from + FloatLeaf::offsetToLocalCoord(i);
    return squares[(size_t(p.x()) * size_t(size.y()) + size_t(p.y())) * size_t(size.z()) +
                   size_t(p.z())];
  };
  for (openvdb::Index i = 0; i < FloatLeaf::SIZE; ++i) {
    const float square = squareAt(i);
    if (square >= halfWidth * halfWidth) continue;
    if (!leaf) leaf = std::make_unique<FloatLeaf>(origin, outside);
    leaf->setValueOn(i, std::sqrt(square) * edge);
  }
  if (!leaf || !inside) return leaf;
  float* distances = leaf->buffer().data();
  const int32_t* labels = inside->buffer().data();
  for (openvdb::Index i = 0; i < FloatLeaf::SIZE; ++i)
    if (detail::labelAt(*inside, labels, i) == label) distances[i] = -distances[i];
  return leaf;
}

/// \p leaves: the tree of the labels without tiles.
FloatGrid::Ptr levelSet(const GrainMesh& mesh, size_t grain, const Int32Grid& labels,
                        const Int32Tree& leaves, const LevelSetOptions& options,
                        Interrupter* interrupter) {
  const float edge = float(labels.voxelSize()[0]);
  const detail::MeshDistance distance(mesh, grain, options.halfWidth);
  const std::vector<CoordBBox>& blocks = distance.blocks();
  std::vector<std::vector<std::unique_ptr<FloatLeaf>>> made(blocks.size());
  detail::parallelForEach(blocks.size(), 1, interrupter, [&](size_t block) {
    const std::vector<float> squares = distance.squaredDistances(block);
    detail::forEachLeafOrigin(blocks[block], [&](const Coord& origin) {
      auto leaf = makeLeaf(origin, blocks[block], squares, leaves.probeConstLeaf(origin),
                           mesh.labels[grain], options.halfWidth, edge);
      if (leaf) made[block].push_back(std::move(leaf));
    });
  });
  const auto grid = FloatGrid::create(options.halfWidth * edge);
  for (auto& block : made)
    for (auto& leaf : block) grid->tree().addLeaf(leaf.release());
  openvdb::tools::signedFloodFill(grid->tree());
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  copyProvenance(labels, *grid);
  return grid;
}

/// A copy without tiles, with all labels as label 1.
Int32Grid::Ptr asOneLabel(const Int32Grid& labels) {
  const auto one = Int32Grid::create(std::make_shared<Int32Tree>(labels.tree()));
  one->tree().voxelizeActiveTiles();
  copyProvenance(labels, *one);
  const auto leaves = detail::leavesOf(one->tree());
  detail::parallelForEach(leaves.size(), detail::kLightLeafGrain, nullptr, [&](size_t n) {
    int32_t* values = leaves[n]->buffer().data();
    for (openvdb::Index i = 0; i < Int32Tree::LeafNodeType::SIZE; ++i)
      values[i] = detail::labelAt(*leaves[n], values, i) ? 1 : 0;
  });
  return one;
}

}  // namespace

std::vector<FloatGrid::Ptr> grainLevelSets(const Int32Grid& labels, const LevelSetOptions& options,
                                           Interrupter* interrupter) {
  check(labels, options);
  const size_t count = detail::LabelBlocks(labels).labels().size();
  if (count > kMaxGrainGrids)
    throw InvalidInput("one grid for each of " + std::to_string(count) +
                       " grains is too much (at most 2000): export a mesh, or a preview");
  GrainMeshOptions meshOptions;
  meshOptions.smoothing = options.smoothing;
  const Int32Tree::ConstPtr leaves = detail::withoutTiles(labels);
  const GrainMesh mesh = grainMesh(labels, meshOptions, interrupter);
  std::vector<FloatGrid::Ptr> grids;
  for (size_t grain = 0; grain < mesh.labels.size(); ++grain) {
    grids.push_back(levelSet(mesh, grain, labels, *leaves, options, interrupter));
    grids.back()->setName(grainName(mesh.labels[grain]));
  }
  return grids;
}

FloatGrid::Ptr surfaceLevelSet(const Int32Grid& labels, const LevelSetOptions& options,
                               Interrupter* interrupter) {
  check(labels, options);
  GrainMeshOptions meshOptions;
  meshOptions.smoothing = options.smoothing;
  const Int32Grid::Ptr one = asOneLabel(labels);
  const GrainMesh mesh = grainMesh(*one, meshOptions, interrupter);
  if (mesh.labels.empty()) throw InvalidInput("there is no labeled voxel: no surface to write");
  const FloatGrid::Ptr grid = levelSet(mesh, 0, *one, one->tree(), options, interrupter);
  grid->setName("surface");
  return grid;
}

}  // namespace vdb_madf
