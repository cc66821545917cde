// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/grain_mesh.h"

#include <numeric>
#include <string>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/labels/select_grains.h"
#include "vdb_madf/shapes/detail/net_builder.h"

namespace vdb_madf {

namespace {

using detail::LabelBlocks;
using detail::SurfaceNet;
using openvdb::Vec3d;

constexpr size_t kBlockGrain = 16;
constexpr size_t kItemGrain = 1 << 16;
constexpr int kMaxRounds = 1000;

/// Points by grain, quads as triangles.
GrainMesh assemble(const SurfaceNet& net, const std::vector<openvdb::Vec3f>& positions,
                   const std::vector<int32_t>& labels) {
  GrainMesh mesh;
  mesh.labels = labels;
  mesh.firstPoint.assign(labels.size() + 1, 0);
  for (const uint32_t grain : net.pointGrain) ++mesh.firstPoint[grain + 1];
  for (size_t g = 1; g <= labels.size(); ++g) mesh.firstPoint[g] += mesh.firstPoint[g - 1];
  std::vector<uint32_t> next(mesh.firstPoint.begin(), mesh.firstPoint.end() - 1);
  std::vector<uint32_t> place(net.pointGrain.size());
  mesh.points.resize(place.size());
  for (size_t p = 0; p < place.size(); ++p) {
    place[p] = next[net.pointGrain[p]]++;
    mesh.points[place[p]] = positions[net.pointCorner[p]];
  }
  mesh.firstTriangle.clear();
  for (const uint32_t first : net.firstQuad) mesh.firstTriangle.push_back(2 * first);
  mesh.triangles.resize(2 * net.quads.size());
  detail::parallelFor(net.quads.size(), kItemGrain, nullptr, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto& quad = net.quads[i];
      mesh.triangles[2 * i] = {place[quad[0]], place[quad[1]], place[quad[2]]};
      mesh.triangles[2 * i + 1] = {place[quad[0]], place[quad[2]], place[quad[3]]};
    }
  });
  return mesh;
}

std::vector<openvdb::Vec3f> latticePositions(const SurfaceNet& net) {
  std::vector<openvdb::Vec3f> positions(net.corners.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    const Coord& c = net.corners[i];
    positions[i] = {float(c.x()) - 0.5f, float(c.y()) - 0.5f, float(c.z()) - 0.5f};
  }
  return positions;
}

}  // namespace

GrainMesh grainMesh(const Int32Grid& labels, const GrainMeshOptions& options,
                    Interrupter* interrupter) {
  if (options.smoothing < 0 || options.smoothing > kMaxRounds)
    throw InvalidInput("smoothing must lie between 0 and 1000");
  const LabelBlocks blocks(labels);
  SurfaceNet net = detail::buildNet(blocks, options.smoothing > 0, interrupter);
  const auto positions = options.smoothing > 0 ? detail::relax(net, options.smoothing,
                                                               blocks.voxelCounts(), interrupter)
                                               : latticePositions(net);
  return assemble(net, positions, blocks.labels());
}

GrainMesh meshOfGrains(const Int32Grid& labels, const std::vector<int32_t>& grains,
                       const GrainMeshOptions& options, Interrupter* interrupter) {
  return grainMesh(*selectGrains(labels, grains, interrupter), options, interrupter);
}

uint64_t countTriangles(const Int32Grid& labels, Interrupter* interrupter) {
  const LabelBlocks blocks(labels);
  std::vector<uint64_t> quads(blocks.size());
  detail::parallelFor(blocks.size(), kBlockGrain, interrupter, [&](size_t begin, size_t end) {
    detail::LabelHalo halo;
    for (size_t block = begin; block < end; ++block) {
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

int reductionForTriangles(const Int32Grid& labels, uint64_t maxTriangles, int first,
                          Interrupter* interrupter) {
  for (int factor = first; factor <= kMaxReduction; ++factor) {
    const uint64_t triangles =
        factor == 1 ? countTriangles(labels, interrupter)
                    : countTriangles(*reduceLabels(labels, factor, interrupter), interrupter);
    if (triangles == 0 && !labels.empty()) break;
    if (triangles <= maxTriangles) return factor;
  }
  throw InvalidInput("no reduction of the labels has a mesh of " + std::to_string(maxTriangles) +
                     " triangles or fewer: allow more");
}

std::vector<double> meshVolumes(const GrainMesh& mesh) {
  std::vector<double> volumes(mesh.labels.size());
  detail::parallelFor(volumes.size(), 16, nullptr, [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g) {
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
    }
  });
  return volumes;
}

}  // namespace vdb_madf
