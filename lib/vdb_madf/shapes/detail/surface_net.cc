// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/surface_net.h"

#include <algorithm>
#include <array>

#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

constexpr size_t kCornerGrain = 4096;
constexpr float kStep = 0.5f;  // of the way to the mean in each round

Vec3f home(const Coord& corner) {
  return {float(corner.x()) - 0.5f, float(corner.y()) - 0.5f, float(corner.z()) - 0.5f};
}

/// x, y, z and 0.
using Offset = float __attribute__((vector_size(16)));

/// What a round makes of the offsets of a corner's links: it goes to the sum of their offsets and
/// their directions, times the step over their number.
struct Mean {
  Offset directions{};
  float scale = 0;
};

/// The mean for each set of links; bit d is the link in direction d.
std::array<Mean, 64> means() {
  std::array<Mean, 64> table;
  for (size_t set = 1; set < table.size(); ++set) {
    int count = 0;
    for (size_t d = 0; d < 6; ++d) {
      if (!(set >> d & 1)) continue;
      table[set].directions[d / 2] += d % 2 ? 1.0f : -1.0f;
      ++count;
    }
    table[set].scale = kStep / float(count);
  }
  return table;
}

/// Moves the corners by their offsets from the lattice: at most half a voxel, so that all digits
/// count.
class Relaxation {
 public:
  Relaxation(SurfaceNet& net, const DomainFaces& domain, Interrupter* interrupter)
      : net_(net),
        interrupter_(interrupter),
        reach_(net.corners.size()),
        offsets_(net.corners.size() + 1),
        next_(net.corners.size() + 1) {
    parallelForEach(reach_.size(), kCornerGrain, nullptr,
                    [&](size_t i) { chooseLinks(i, domain); });
  }

  std::vector<Vec3f> run(int rounds) {
    for (int round = 0; round < rounds; ++round) {
      WorkPart part(interrupter_, 100 * round / rounds, 100 * (round + 1) / rounds);
      smoothOnce(&part);
    }
    std::vector<Vec3f> positions(net_.corners.size());
    parallelForEach(positions.size(), kCornerGrain, nullptr, [&](size_t i) {
      const Offset& offset = offsets_[i];
      positions[i] = home(net_.corners[i]) + Vec3f(offset[0], offset[1], offset[2]);
    });
    turnQuads(positions);
    return positions;
  }

 private:
  struct Reach {
    uint8_t links;  ///< bit d: in direction d
    uint8_t faces;  ///< bit a: on a face of the domain across axis a
  };

  /// Links that do not count become those to the corner that never moves.
  void chooseLinks(size_t corner, const DomainFaces& domain) {
    auto& links = net_.links[corner];
    // A point on a line between three labels follows the line; where lines meet, all of them.
    const int junctions = net_.junctions[corner];
    const bool isOnLine = junctions & (junctions - 1);
    Reach& reach = reach_[corner];
    reach = {};
    for (size_t d = 0; d < 6; ++d) {
      const bool isUsed = links[d] != SurfaceNet::kNone && (!isOnLine || (junctions >> d & 1));
      if (!isUsed) links[d] = uint32_t(net_.corners.size());
      reach.links = uint8_t(reach.links | int(isUsed) << d);
    }
    const Vec3f place = home(net_.corners[corner]);
    for (int axis = 0; axis < 3; ++axis)
      reach.faces = uint8_t(reach.faces | int(domain.isOn(place, axis)) << axis);
  }

  void smoothOnce(Interrupter* interrupter) {
    static const std::array<Mean, 64> table = means();
    parallelForEach(reach_.size(), kCornerGrain, interrupter, [&](size_t i) {
      const auto& links = net_.links[i];
      const Mean& mean = table[reach_[i].links];
      const Offset sum =
          ((offsets_[links[0]] + offsets_[links[1]]) + (offsets_[links[2]] + offsets_[links[3]])) +
          ((offsets_[links[4]] + offsets_[links[5]]) + mean.directions);
      const Offset wanted = (1 - kStep) * offsets_[i] + mean.scale * sum;
      const int faces = reach_[i].faces;
      const Offset most{faces & 1 ? 0 : kCornerReach, faces & 2 ? 0 : kCornerReach,
                        faces & 4 ? 0 : kCornerReach, 0};
      const Offset low = wanted < -most ? -most : wanted;
      next_[i] = low > most ? most : low;
    });
    offsets_.swap(next_);
  }

  /// A quad is cut from its first to its third corner: the shorter way is flatter. The two sides
  /// of an interface see the same lengths, so they are cut alike; of equal ones neither is turned.
  void turnQuads(const std::vector<Vec3f>& positions) {
    const auto at = [&](uint32_t point) { return Vec3d(positions[net_.pointCorner[point]]); };
    parallelForEach(net_.quads.size(), kCornerGrain, nullptr, [&](size_t i) {
      auto& quad = net_.quads[i];
      if ((at(quad[1]) - at(quad[3])).lengthSqr() < (at(quad[0]) - at(quad[2])).lengthSqr())
        std::rotate(quad.begin(), quad.begin() + 1, quad.end());
    });
  }

  SurfaceNet& net_;
  Interrupter* interrupter_;
  std::vector<Reach> reach_;            // per corner
  std::vector<Offset> offsets_, next_;  // per corner, and of the one that never moves
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
