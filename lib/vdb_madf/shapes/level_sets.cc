// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/level_sets.h"

#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/SignedFloodFill.h>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/grain_name.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf {

namespace {

using openvdb::Vec3s;

constexpr float kMaxHalfWidth = 16;
constexpr size_t kLeafGrain = 256;

void check(const Int32Grid& labels, const LevelSetOptions& options) {
  if (!(options.halfWidth >= 1) || options.halfWidth > kMaxHalfWidth)
    throw InvalidInput("the half width of the narrow band must lie between 1 and 16 voxels");
  requireCubicVoxels(labels, "a level set");  // OpenVDB measures distances in voxels
}

/// Makes the distances of the voxels of a label negative. \p labels: without tiles.
void negateInside(FloatGrid& grid, const Int32Tree& labels, int32_t label) {
  std::vector<FloatGrid::TreeType::LeafNodeType*> leaves;
  grid.tree().getNodes(leaves);
  detail::parallelFor(leaves.size(), kLeafGrain, nullptr, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      const auto* inside = labels.probeConstLeaf(leaves[n]->origin());
      if (!inside) continue;
      const int32_t* values = inside->buffer().data();
      float* distances = leaves[n]->buffer().data();
      for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel)
        if (detail::labelAt(*inside, values, voxel.pos()) == label)
          distances[voxel.pos()] = -distances[voxel.pos()];
    }
  });
}

/// \p leaves: the tree of the labels without tiles.
FloatGrid::Ptr levelSet(const GrainMesh& mesh, size_t grain, const Int32Grid& labels,
                        const Int32Tree& leaves, const LevelSetOptions& options,
                        Interrupter* interrupter) {
  const int32_t label = mesh.labels[grain];
  const uint32_t first = mesh.firstPoint[grain];
  const std::vector<Vec3s> points(mesh.points.begin() + first,
                                  mesh.points.begin() + mesh.firstPoint[grain + 1]);
  std::vector<openvdb::Vec3I> triangles;
  for (uint32_t i = mesh.firstTriangle[grain]; i < mesh.firstTriangle[grain + 1]; ++i) {
    const auto& t = mesh.triangles[i];
    triangles.emplace_back(t[0] - first, t[1] - first, t[2] - first);
  }
  const openvdb::tools::QuadAndTriangleDataAdapter<Vec3s, openvdb::Vec3I> surface(points,
                                                                                  triangles);
  Interrupter none;
  // The signs are known: OpenVDB's search for them does not enter gaps of one voxel.
  const auto grid = openvdb::tools::meshToVolume<FloatGrid>(
      interrupter ? *interrupter : none, surface, labels.transform(), options.halfWidth,
      options.halfWidth, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  if (interrupter && interrupter->wasInterrupted()) throw Interrupted();
  negateInside(*grid, leaves, label);
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
  std::vector<Int32Tree::LeafNodeType*> leaves;
  one->tree().getNodes(leaves);
  detail::parallelFor(leaves.size(), kLeafGrain, nullptr, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      int32_t* values = leaves[n]->buffer().data();
      for (openvdb::Index i = 0; i < Int32Tree::LeafNodeType::SIZE; ++i)
        values[i] = detail::labelAt(*leaves[n], values, i) ? 1 : 0;
    }
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
  if (mesh.labels.empty()) throw InvalidInput("there is no labelled voxel: no surface to write");
  const FloatGrid::Ptr grid = levelSet(mesh, 0, *one, one->tree(), options, interrupter);
  grid->setName("surface");
  return grid;
}

}  // namespace vdb_madf
