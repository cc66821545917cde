// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/grain_mesh.h"

#include <numeric>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/detail/rimmed_slabs.h"
#include "vdb_madf/labels/select_grains.h"
#include "vdb_madf/shapes/detail/net_builder.h"
#include "vdb_madf/shapes/detail/simplify.h"
#include "vdb_madf/shapes/detail/volume_correction.h"

namespace vdb_madf {

namespace {

using detail::DomainFaces;
using detail::LabelBlocks;
using detail::SharedMesh;
using detail::SurfaceNet;
using openvdb::Vec3d;
using openvdb::Vec3f;

constexpr size_t kBlockGrain = 16;
constexpr int kMaxRounds = 1000;
/// Along an axis, in voxels: so far points of a simplified mesh go to give the grains their
/// volumes.
constexpr float kSimplifiedReach = 1;

GrainMesh assemble(SharedMesh&& shared, const std::vector<int32_t>& labels) {
  GrainMesh mesh;
  mesh.labels = labels;
  mesh.firstPoint = shared.firstPoints();
  mesh.firstTriangle = std::move(shared.firstTriangle);
  mesh.triangles = std::move(shared.triangles);
  mesh.points.reserve(shared.pointSite.size());
  for (const uint32_t site : shared.pointSite) mesh.points.push_back(shared.positions[site]);
  return mesh;
}

/// Empty if it is not known, or labels lie outside.
CoordBBox domainBox(const Int32Grid& labels) {
  const auto domain = storedDomain(labels);
  CoordBBox used;
  if (!domain || !labels.tree().evalActiveVoxelBoundingBox(used)) return {};
  return domain->box().isInside(used) ? domain->box() : CoordBBox();
}

DomainFaces facesOf(const CoordBBox& box) {
  if (box.empty()) return {};
  return {true, box.min().asVec3s() - Vec3f(0.5f), box.max().asVec3s() + Vec3f(0.5f)};
}

void check(const GrainMeshOptions& options) {
  if (options.smoothing < 0 || options.smoothing > kMaxRounds)
    throw InvalidInput("smoothing must lie between 0 and 1000");
  if (!(options.error >= 0)) throw InvalidInput("the error of meshes must be 0 or more");
}

/// Of the blocks whose z is wanted.
template <typename IsWanted>
uint64_t trianglesOf(const Int32Grid& labels, const IsWanted& isWanted, Interrupter* interrupter) {
  const LabelBlocks blocks(labels);
  std::vector<uint64_t> quads(blocks.size());
  detail::parallelFor(blocks.size(), kBlockGrain, interrupter, [&](size_t begin, size_t end) {
    detail::LabelHalo halo;
    for (size_t block = begin; block < end; ++block) {
      if (!isWanted(blocks.origin(block).z())) continue;
      blocks.readHalo(block, halo);
      // The faces below the voxels of a block are its own; each grain at a face has it.
      for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
          for (int z = 0; z < 8; ++z) {
            const int32_t* at = &halo[detail::haloAt(x, y, z)];
            for (const int step : detail::kHaloStride)
              if (at[0] != at[-step]) quads[block] += uint64_t(at[0] > 0) + uint64_t(at[-step] > 0);
          }
    }
  });
  return 2 * std::accumulate(quads.begin(), quads.end(), uint64_t(0));
}

}  // namespace

GrainMesh grainMesh(const Int32Grid& labels, const GrainMeshOptions& options,
                    Interrupter* interrupter) {
  check(options);
  const LabelBlocks blocks(labels);
  const CoordBBox box = domainBox(labels);
  const DomainFaces domain = facesOf(box);
  // Shares of the work, in per cent.
  const int meshed = options.triangles > 0 ? 25 : 100, built = meshed / 3, smoothed = meshed / 2;
  detail::WorkPart building(interrupter, 0, built), smoothing(interrupter, built, smoothed),
      correcting(interrupter, smoothed, meshed), simplifying(interrupter, meshed, 95),
      ending(interrupter, 95, 100);
  SurfaceNet net = detail::buildNet(blocks, box, options.smoothing > 0, &building);
  std::vector<Vec3f> homes = detail::latticePositions(net);
  SharedMesh mesh = detail::cutQuads(
      net,
      options.smoothing > 0 ? detail::relax(net, options.smoothing, domain, &smoothing) : homes);
  net = {};
  if (options.smoothing > 0)
    detail::correctVolumes(mesh, blocks.voxelCounts(), homes, detail::kCornerReach, domain,
                           &correcting);
  if (options.triangles > 0 &&
      detail::simplify(mesh, options.triangles, options.error, &simplifying)) {
    homes = mesh.positions;
    detail::correctVolumes(mesh, blocks.voxelCounts(), homes, kSimplifiedReach, domain, &ending);
  }
  return assemble(std::move(mesh), blocks.labels());
}

GrainMesh meshOfGrains(const Int32Grid& labels, const std::vector<int32_t>& grains,
                       const GrainMeshOptions& options, Interrupter* interrupter) {
  return grainMesh(*selectGrains(labels, grains, interrupter), options, interrupter);
}

uint64_t countTriangles(const Int32Grid& labels, Interrupter* interrupter) {
  return trianglesOf(
      labels, [](int) { return true; }, interrupter);
}

uint64_t countTriangles(const LabelSlabs& labels, Interrupter* interrupter) {
  detail::RimmedSlabs slabs(labels);
  uint64_t triangles = 0;
  for (size_t s = 0; slabs.next(interrupter); ++s) {
    // Blocks above the last slab have faces of its voxels.
    const int below = labels.cuts[s],
              above = labels.cuts[s + 1] + (s + 2 == labels.cuts.size() ? 8 : 0);
    triangles += trianglesOf(
        slabs.labels(), [&](int z) { return z >= below && z < above; }, interrupter);
  }
  return triangles;
}

std::vector<double> meshVolumes(const GrainMesh& mesh) {
  std::vector<double> volumes(mesh.labels.size());
  detail::parallelForEach(volumes.size(), 16, nullptr, [&](size_t g) {
    const Vec3d reference(mesh.points[mesh.firstPoint[g]]);  // near: keeps the sum exact enough
    double sixfold = 0;
    for (uint32_t t = mesh.firstTriangle[g]; t < mesh.firstTriangle[g + 1]; ++t) {
      const auto& triangle = mesh.triangles[t];
      const Vec3d a = Vec3d(mesh.points[triangle[0]]) - reference,
                  b = Vec3d(mesh.points[triangle[1]]) - reference,
                  c = Vec3d(mesh.points[triangle[2]]) - reference;
      sixfold += a.dot(b.cross(c));
    }
    volumes[g] = sixfold / 6;
  });
  return volumes;
}

}  // namespace vdb_madf
