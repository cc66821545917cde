// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/volume_correction.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/shapes/detail/grain_pressures.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

constexpr size_t kMovedSiteGrain = 4096;
constexpr size_t kMovedGrainGrain = 8;
/// Volumes are met to this part of themselves, or after so many corrections.
constexpr double kVolumeTolerance = 1e-3;
constexpr int kMaxCorrections = 20;
/// What the pressures leave to the next correction, in parts of the tolerance.
constexpr double kSolved = 0.1;
/// The growth of a grain with its pressure is overstated by no more than this part of its squared
/// gradients, or by the area of a cube of its volume (a face of it, voxels squared) if that is
/// more.
constexpr double kHeldBack = 0.1;
/// Voxels: grains whose points would move by less on the average stay as they are.
constexpr double kLeastMove = 1e-4;

/// Newton's method. The unknowns are pressures in the grains: a site moves by the sum over its
/// points of the pressure in the point's grain times the gradient of that grain's volume by the
/// point.
class VolumeCorrection {
 public:
  VolumeCorrection(SharedMesh& mesh, const std::vector<int64_t>& volumes,
                   const std::vector<Vec3f>& homes, float reach, const DomainFaces& domain,
                   Interrupter* interrupter)
      : mesh_(mesh),
        volumes_(volumes),
        homes_(homes),
        reach_(reach),
        domain_(domain),
        interrupter_(interrupter),
        firstPoint_(mesh.firstPoints()),
        gradients_(mesh.pointSite.size()),
        blocked_(mesh.positions.size()),
        squares_(mesh.grainCount()),
        loneSquares_(mesh.grainCount()),
        missing_(mesh.grainCount()),
        tolerances_(mesh.grainCount()),
        pressures_(mesh.grainCount(), 1) {
    for (size_t g = 0; g < volumes.size(); ++g)
      tolerances_[g] = kSolved * kVolumeTolerance * double(volumes[g]);
    blockDomainFaces();
    listSharedSites();
    listNeighbors();
  }

  void run() {
    for (int round = 0; round < kMaxCorrections; ++round) {
      WorkPart part(interrupter_, 100 * round / kMaxCorrections,
                    100 * (round + 1) / kMaxCorrections);
      if (largestError(&part) <= kVolumeTolerance) break;
      findPressures();
      if (!move()) break;
    }
  }

 private:
  void blockDomainFaces() {
    if (!domain_.areKnown) return;
    parallelForEach(homes_.size(), kMovedSiteGrain, nullptr, [&](size_t site) {
      for (int axis = 0; axis < 3; ++axis)
        blocked_[site] = uint8_t(blocked_[site] | int(domain_.isOn(homes_[site], axis)) << axis);
    });
  }

  void listSharedSites() {
    std::vector<uint8_t> uses(mesh_.positions.size());  // 2: or more
    for (const uint32_t site : mesh_.pointSite) uses[site] = uint8_t(std::min(uses[site] + 1, 2));
    std::vector<uint32_t> numbers(mesh_.positions.size());
    for (uint32_t site = 0; site < uses.size(); ++site) {
      if (uses[site] < 2) continue;
      numbers[site] = uint32_t(sharedSites_.size());
      sharedSites_.push_back(site);
    }
    firstShared_.assign(mesh_.grainCount() + 1, 0);
    for (uint32_t point = 0; point < mesh_.pointSite.size(); ++point) {
      const uint32_t site = mesh_.pointSite[point];
      if (uses[site] < 2) continue;
      sharedPoints_.push_back(point);
      sharedNumber_.push_back(numbers[site]);
      firstShared_[mesh_.pointGrain[point] + 1] = uint32_t(sharedPoints_.size());
    }
    for (size_t g = 1; g < firstShared_.size(); ++g)
      firstShared_[g] = std::max(firstShared_[g], firstShared_[g - 1]);
    pointsOfShared_.emplace(sharedNumber_, sharedSites_.size());
  }

  /// f(point, isShared) for the points of a grain.
  template <typename F>
  void forEachPoint(uint32_t grain, const F& f) const {
    uint32_t shared = firstShared_[grain];
    for (uint32_t point = firstPoint_[grain]; point < firstPoint_[grain + 1]; ++point) {
      const bool isShared = shared < firstShared_[grain + 1] && sharedPoints_[shared] == point;
      shared += isShared;
      f(point, isShared);
    }
  }

  /// f(other) for the other points of the site that a shared point, by its number, is at.
  template <typename F>
  void forEachOther(uint32_t shared, const F& f) const {
    const uint32_t site = sharedNumber_[shared];
    for (uint32_t i = pointsOfShared_->first[site]; i < pointsOfShared_->first[site + 1]; ++i)
      if (pointsOfShared_->items[i] != shared) f(sharedPoints_[pointsOfShared_->items[i]]);
  }

  template <typename F>
  void forEachGrain(Interrupter* interrupter, const F& f) const {
    parallelForEach(volumes_.size(), kMovedGrainGrain, interrupter, [&](size_t g) { f(g); });
  }

  void listNeighbors() {
    std::vector<std::vector<uint32_t>> lists(mesh_.grainCount());
    forEachGrain(nullptr, [&](size_t g) {
      std::vector<uint32_t>& list = lists[g];
      for (uint32_t i = firstShared_[g]; i < firstShared_[g + 1]; ++i)
        forEachOther(i, [&](uint32_t other) {
          const uint32_t grain = mesh_.pointGrain[other];
          if (grain != g && (list.empty() || list.back() != grain)) list.push_back(grain);
        });
      sortUnique(list);
    });
    equations_.first.push_back(0);
    for (const auto& list : lists) {
      equations_.neighbors.insert(equations_.neighbors.end(), list.begin(), list.end());
      equations_.first.push_back(uint32_t(equations_.neighbors.size()));
    }
    equations_.own.resize(mesh_.grainCount());
    equations_.byNeighbor.resize(equations_.neighbors.size());
  }

  /// Measures the volumes and their gradients where points have moved; the largest error relative
  /// to the true volume.
  double largestError(Interrupter* interrupter) {
    PerThread<std::vector<Vec3f>> places;
    forEachGrain(interrupter, [&](size_t g) {
      const auto begin = equations_.neighbors.begin() + equations_.first[g],
                 end = equations_.neighbors.begin() + equations_.first[g + 1];
      if (pressures_[g] != 0 ||
          std::any_of(begin, end, [&](uint32_t other) { return pressures_[other] != 0; }))
        measure(uint32_t(g), places.local());
    });
    double largest = 0;
    for (size_t g = 0; g < volumes_.size(); ++g)
      largest = std::max(largest, std::abs(missing_[g]) / double(volumes_[g]));
    return largest;
  }

  /// \p places: scratch space
  void measure(uint32_t grain, std::vector<Vec3f>& places) {
    const uint32_t first = firstPoint_[grain], end = firstPoint_[grain + 1];
    places.clear();
    for (uint32_t point = first; point < end; ++point)
      places.push_back(mesh_.positions[mesh_.pointSite[point]]);
    Vec3f* gradients = &gradients_[first];
    std::fill(gradients, gradients + (end - first), Vec3f(0));
    // The surface is closed: of what the triangles around a point add to its gradient, their
    // normals are left.
    for (size_t t = mesh_.firstTriangle[grain]; t < mesh_.firstTriangle[grain + 1]; ++t) {
      const auto& [a, b, c] = mesh_.triangles[t];
      const Vec3f &p = places[a - first], &q = places[b - first], &r = places[c - first];
      const Vec3f normal = (q - p).cross(r - p);
      for (const uint32_t corner : {a, b, c}) gradients[corner - first] += normal;
    }
    const Vec3f reference = places[0];  // near: keeps the sum exact enough
    double threefold = 0;
    squares_[grain] = loneSquares_[grain] = 0;
    forEachPoint(grain, [&](uint32_t point, bool isShared) {
      gradients_[point] *= 1.0f / 6;
      const Vec3d gradient(gradients_[point]);
      threefold += Vec3d(places[point - first] - reference).dot(gradient);
      squares_[grain] += gradient.lengthSqr();
      if (!isShared) loneSquares_[grain] += freeDot(mesh_.pointSite[point], gradient, gradient);
    });
    missing_[grain] = double(volumes_[grain]) - threefold / 3;
  }

  /// The product of two gradients along the axes that the site can move along.
  double freeDot(uint32_t site, const Vec3d& a, const Vec3d& b) const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis)
      sum += (blocked_[site] >> axis & 1) ? 0 : a[axis] * b[axis];
    return sum;
  }

  void findPressures() {
    forEachGrain(nullptr, [&](size_t g) { setEquation(g); });
    pressures_ = pressuresFor(equations_, missing_, tolerances_);
    for (size_t g = 0; g < pressures_.size(); ++g)
      if (std::abs(pressures_[g]) * meanGradient(g) < kLeastMove) pressures_[g] = 0;
  }

  double meanGradient(size_t grain) const {
    return std::sqrt(squares_[grain] / double(firstPoint_[grain + 1] - firstPoint_[grain]));
  }

  void setEquation(size_t grain) {
    const auto begin = equations_.neighbors.begin() + equations_.first[grain],
               end = equations_.neighbors.begin() + equations_.first[grain + 1];
    double* byNeighbor = equations_.byNeighbor.data() + equations_.first[grain];
    std::fill(byNeighbor, byNeighbor + (end - begin), 0.0);
    double own = loneSquares_[grain];
    auto last = begin;
    for (uint32_t i = firstShared_[grain]; i < firstShared_[grain + 1]; ++i) {
      const uint32_t site = sharedSites_[sharedNumber_[i]];
      const Vec3d gradient(gradients_[sharedPoints_[i]]);
      own += freeDot(site, gradient, gradient);
      forEachOther(i, [&](uint32_t point) {
        const double product = freeDot(site, gradient, Vec3d(gradients_[point]));
        const uint32_t other = mesh_.pointGrain[point];
        if (other == grain) {
          own += product;
          return;
        }
        if (last == end || *last != other) last = std::lower_bound(begin, end, other);
        byNeighbor[last - begin] += product;
      });
    }
    // Held back: what would move points farther than they may go. But only so much of a grain that
    // is more than a crumb, for others would grow at its expense where the volumes cannot all be
    // met.
    const double volume = double(volumes_[grain]),
                 most = std::max(kHeldBack * squares_[grain], std::cbrt(volume * volume));
    equations_.own[grain] =
        own + std::min(std::abs(missing_[grain]) * meanGradient(grain) / reach_, most);
  }

  /// \return false if nothing moved
  bool move() {
    std::atomic<bool> hasMoved = false;
    forEachGrain(nullptr, [&](size_t g) {
      if (pressures_[g] == 0) return;
      const auto pressure = float(pressures_[g]);
      bool isMoved = false;
      forEachPoint(uint32_t(g), [&](uint32_t point, bool isShared) {
        if (!isShared) isMoved |= moveBy(mesh_.pointSite[point], pressure * gradients_[point]);
      });
      if (isMoved) hasMoved = true;
    });
    parallelFor(sharedSites_.size(), kMovedSiteGrain, nullptr, [&](size_t begin, size_t end) {
      bool isMoved = false;
      for (size_t n = begin; n < end; ++n) {
        Vec3f step(0);
        for (uint32_t i = pointsOfShared_->first[n]; i < pointsOfShared_->first[n + 1]; ++i) {
          const uint32_t point = sharedPoints_[pointsOfShared_->items[i]];
          step += float(pressures_[mesh_.pointGrain[point]]) * gradients_[point];
        }
        isMoved |= moveBy(sharedSites_[n], step);
      }
      if (isMoved) hasMoved = true;
    });
    return hasMoved;
  }

  /// \return true if the site is elsewhere now
  bool moveBy(uint32_t site, const Vec3f& step) {
    const Vec3f before = mesh_.positions[site], wanted = before + step;
    const Vec3f place = withinReach(homes_[site], wanted, reach_, domain_);
    int blocked = 0;
    for (int axis = 0; axis < 3; ++axis) blocked |= int(place[axis] != wanted[axis]) << axis;
    blocked_[site] = uint8_t(blocked);
    mesh_.positions[site] = place;
    return place != before;
  }

  SharedMesh& mesh_;
  const std::vector<int64_t>& volumes_;
  const std::vector<Vec3f>& homes_;
  const float reach_;
  const DomainFaces& domain_;
  Interrupter* interrupter_;
  const std::vector<uint32_t> firstPoint_;  // per grain, one more at the end
  std::vector<Vec3f> gradients_;            // per point, of the volume of its grain
  std::vector<uint8_t> blocked_;            // per site: bit a: it cannot move farther along axis a
  std::vector<uint32_t> sharedSites_;       // with more than one point
  std::vector<uint32_t> sharedPoints_, sharedNumber_;  // of these: points, and which of the sites
  std::vector<uint32_t> firstShared_;                  // per grain, one more at the end
  std::optional<Lists> pointsOfShared_;                // per shared site, numbers of shared points
  // Per grain: of its gradients, and of those at sites of one point that can move.
  std::vector<double> squares_, loneSquares_;
  std::vector<double> missing_, tolerances_, pressures_;
  PressureEquations equations_;
};

}  // namespace

void correctVolumes(SharedMesh& mesh, const std::vector<int64_t>& volumes,
                    const std::vector<Vec3f>& homes, float reach, const DomainFaces& domain,
                    Interrupter* interrupter) {
  VolumeCorrection(mesh, volumes, homes, reach, domain, interrupter).run();
}

}  // namespace vdb_madf::detail
