// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/surface_net.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

constexpr size_t kCornerGrain = 4096;
/// Of the way to the mean in each round.
constexpr double kStep = 0.5;

Vec3f home(const Coord& corner) {
  return {float(corner.x()) - 0.5f, float(corner.y()) - 0.5f, float(corner.z()) - 0.5f};
}

class Relaxation {
 public:
  Relaxation(SurfaceNet& net, const DomainFaces& domain, Interrupter* interrupter)
      : net_(net), domain_(domain), interrupter_(interrupter), positions_(latticePositions(net)) {
    positions_.resize(net.corners.size());
  }

  std::vector<Vec3f> run(int rounds) {
    for (int round = 0; round < rounds; ++round) {
      WorkPart part(interrupter_, 100 * round / rounds, 100 * (round + 1) / rounds);
      smoothOnce(&part);
    }
    turnQuads();
    return std::move(positions_);
  }

 private:
  void smoothOnce(Interrupter* interrupter) {
    next_.resize(positions_.size());
    parallelFor(positions_.size(), kCornerGrain, interrupter, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const auto& links = net_.links[i];
        // A point on a line between three labels follows the line; where lines meet, all of them.
        const int junctions = net_.junctions[i];
        const bool onLine = junctions & (junctions - 1);
        Vec3d sum(0);
        int count = 0;
        for (int d = 0; d < 6; ++d) {
          if (links[size_t(d)] == SurfaceNet::kNone || (onLine && !(junctions >> d & 1))) continue;
          sum += Vec3d(positions_[links[size_t(d)]]);
          ++count;
        }
        const Vec3d here(positions_[i]);
        next_[i] = withinReach(home(net_.corners[i]), here + kStep * (sum / count - here),
                               kCornerReach, domain_);
      }
    });
    positions_.swap(next_);
  }

  /// A quad is cut from its first to its third corner: the shorter way is flatter. The two sides
  /// of an interface see the same lengths, so they are cut alike; of equal ones neither is turned.
  void turnQuads() {
    parallelFor(net_.quads.size(), kCornerGrain, nullptr, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        auto& quad = net_.quads[i];
        if ((at(quad[1]) - at(quad[3])).lengthSqr() < (at(quad[0]) - at(quad[2])).lengthSqr())
          std::rotate(quad.begin(), quad.begin() + 1, quad.end());
      }
    });
  }

  Vec3d at(uint32_t point) const { return Vec3d(positions_[net_.pointCorner[point]]); }

  SurfaceNet& net_;
  const DomainFaces& domain_;
  Interrupter* interrupter_;
  std::vector<Vec3f> positions_, next_;
};

}  // namespace

std::vector<Vec3f> latticePositions(const SurfaceNet& net) {
  std::vector<Vec3f> positions;
  positions.reserve(net.corners.size() + net.pinches.size());
  for (const Coord& corner : net.corners) positions.push_back(home(corner));
  for (const auto& [low, high] : net.pinches)
    positions.push_back(0.5f * (positions[low] + positions[high]));
  return positions;
}

std::vector<Vec3f> relax(SurfaceNet& net, int rounds, const DomainFaces& domain,
                         Interrupter* interrupter) {
  return Relaxation(net, domain, interrupter).run(rounds);
}

}  // namespace vdb_madf::detail
