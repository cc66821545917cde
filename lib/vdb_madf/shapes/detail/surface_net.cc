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
constexpr size_t kGrainGrain = 8;
/// Of the way to the mean in each round.
constexpr double kStep = 0.5;
/// Farthest from its lattice point that a corner may go along an axis, in voxels: the net cannot
/// fold over, and the boundary between two voxels stays between their centres.
constexpr float kReach = 0.5f;
/// Volumes are met to this part of themselves, or after so many corrections.
constexpr double kVolumeTolerance = 1e-3;
constexpr int kMaxCorrections = 60;
/// Jacobi steps on a matrix whose eigenvalues, scaled by its diagonal, lie in [0, 2].
constexpr double kRelaxation = 0.6;

Vec3f home(const Coord& corner) {
  return {float(corner.x()) - 0.5f, float(corner.y()) - 0.5f, float(corner.z()) - 0.5f};
}

Vec3f withinReach(const Vec3f& home, const Vec3d& wanted) {
  Vec3f result;
  for (int axis = 0; axis < 3; ++axis)
    result[axis] = std::clamp(float(wanted[axis]), home[axis] - kReach, home[axis] + kReach);
  return result;
}

class Relaxation {
 public:
  Relaxation(SurfaceNet& net, const std::vector<int64_t>& volumes, Interrupter* interrupter)
      : net_(net), volumes_(volumes), interrupter_(interrupter), positions_(net.corners.size()) {
    for (size_t i = 0; i < positions_.size(); ++i) positions_[i] = home(net.corners[i]);
  }

  std::vector<Vec3f> run(int rounds) {
    for (int round = 0; round < rounds; ++round) smoothOnce();
    turnQuads();
    gradients_.resize(net_.pointGrain.size());
    pressures_.resize(volumes_.size());
    points_.assign(volumes_.size() + 1, 0);
    listPoints();
    for (int round = 0; round < kMaxCorrections && largestVolumeError() > kVolumeTolerance; ++round)
      correctVolumes();
    return std::move(positions_);
  }

 private:
  void smoothOnce() {
    std::vector<Vec3f> next(positions_.size());
    parallelFor(positions_.size(), kCornerGrain, interrupter_, [&](size_t begin, size_t end) {
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
        next[i] = withinReach(home(net_.corners[i]), here + kStep * (sum / count - here));
      }
    });
    positions_.swap(next);
  }

  /// A quad is cut from its first to its third corner: the shorter way is flatter. The two sides
  /// of an interface see the same lengths, so they are cut alike; of equal ones neither is turned.
  void turnQuads() {
    parallelFor(net_.quads.size(), kCornerGrain, interrupter_, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        auto& quad = net_.quads[i];
        if ((at(quad[1]) - at(quad[3])).lengthSqr() < (at(quad[0]) - at(quad[2])).lengthSqr())
          std::rotate(quad.begin(), quad.begin() + 1, quad.end());
      }
    });
  }

  /// The points of each grain, so that grains can be worked on side by side.
  void listPoints() {
    for (const uint32_t grain : net_.pointGrain) ++points_[grain + 1];
    for (size_t g = 1; g < points_.size(); ++g) points_[g] += points_[g - 1];
    std::vector<uint32_t> next(points_.begin(), points_.end() - 1);
    pointList_.resize(net_.pointGrain.size());
    for (size_t p = 0; p < pointList_.size(); ++p)
      pointList_[next[net_.pointGrain[p]]++] = uint32_t(p);
  }

  Vec3d at(uint32_t point) const { return Vec3d(positions_[net_.pointCorner[point]]); }

  /// Measures the volumes and their gradients; the largest error relative to the true volume.
  double largestVolumeError() {
    std::vector<double> errors(volumes_.size());
    parallelFor(volumes_.size(), kGrainGrain, interrupter_, [&](size_t begin, size_t end) {
      for (size_t g = begin; g < end; ++g) errors[g] = measure(g);
    });
    return errors.empty() ? 0 : *std::max_element(errors.begin(), errors.end());
  }

  double measure(size_t grain) {
    for (uint32_t i = points_[grain]; i < points_[grain + 1]; ++i)
      gradients_[pointList_[i]] = Vec3d(0);
    const Vec3d reference = at(pointList_[points_[grain]]);  // near: keeps the sums exact enough
    double volume = 0;
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
      const Vec3d p = at(a) - reference, q = at(b) - reference, r = at(c) - reference;
      const Vec3d toP = q.cross(r) / 6, toQ = r.cross(p) / 6, toR = p.cross(q) / 6;
      volume += p.dot(toP);
      gradients_[a] += toP;
      gradients_[b] += toQ;
      gradients_[c] += toR;
    };
    for (uint32_t i = net_.firstQuad[grain]; i < net_.firstQuad[grain + 1]; ++i) {
      const auto& quad = net_.quads[i];
      add(quad[0], quad[1], quad[2]);
      add(quad[0], quad[2], quad[3]);
    }
    double diagonal = 0;
    for (uint32_t i = points_[grain]; i < points_[grain + 1]; ++i)
      diagonal += gradients_[pointList_[i]].lengthSqr();
    const double missing = double(volumes_[grain]) - volume;
    pressures_[grain] = diagonal > 0 ? missing / diagonal : 0;
    return std::abs(missing) / double(volumes_[grain]);
  }

  /// One step towards displacements along the gradients that give every grain its volume.
  void correctVolumes() {
    parallelFor(positions_.size(), kCornerGrain, interrupter_, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        Vec3d wanted(positions_[i]);
        for (uint32_t p = net_.firstPoint[i]; p < net_.firstPoint[i + 1]; ++p)
          wanted += kRelaxation * pressures_[net_.pointGrain[p]] * gradients_[p];
        positions_[i] = withinReach(home(net_.corners[i]), wanted);
      }
    });
  }

  SurfaceNet& net_;
  const std::vector<int64_t>& volumes_;
  Interrupter* interrupter_;
  std::vector<Vec3f> positions_;
  std::vector<Vec3d> gradients_;              // per point
  std::vector<double> pressures_;             // per grain
  std::vector<uint32_t> points_, pointList_;  // of each grain
};

}  // namespace

std::vector<Vec3f> relax(SurfaceNet& net, int rounds, const std::vector<int64_t>& volumes,
                         Interrupter* interrupter) {
  return Relaxation(net, volumes, interrupter).run(rounds);
}

}  // namespace vdb_madf::detail
