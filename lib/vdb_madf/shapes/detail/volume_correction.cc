// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/volume_correction.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

constexpr size_t kSiteGrain = 4096;
constexpr size_t kGrainGrain = 8;
/// Volumes are met to this part of themselves, or after so many corrections.
constexpr double kVolumeTolerance = 1e-3;
constexpr int kMaxCorrections = 60;
/// Jacobi steps on a matrix whose eigenvalues, scaled by its diagonal, lie in [0, 2].
constexpr double kRelaxation = 0.6;

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
        pointsOfGrain_(mesh.pointGrain, mesh.grainCount()),
        pointsOfSite_(mesh.pointSite, mesh.positions.size()),
        gradients_(mesh.pointSite.size()),
        pressures_(mesh.grainCount()) {}

  void run() {
    for (int round = 0; round < kMaxCorrections; ++round) {
      WorkPart part(interrupter_, 100 * round / kMaxCorrections,
                    100 * (round + 1) / kMaxCorrections);
      if (largestError(&part) <= kVolumeTolerance) break;
      correct();
    }
  }

 private:
  Vec3d at(uint32_t point) const { return Vec3d(mesh_.positions[mesh_.pointSite[point]]); }

  /// Measures the volumes and their gradients; the largest error relative to the true volume.
  double largestError(Interrupter* interrupter) {
    std::vector<double> errors(volumes_.size());
    parallelFor(volumes_.size(), kGrainGrain, interrupter, [&](size_t begin, size_t end) {
      for (size_t g = begin; g < end; ++g) errors[g] = measure(g);
    });
    return errors.empty() ? 0 : *std::max_element(errors.begin(), errors.end());
  }

  template <typename F>
  void forEachPoint(size_t grain, const F& f) const {
    for (uint32_t i = pointsOfGrain_.first[grain]; i < pointsOfGrain_.first[grain + 1]; ++i)
      f(pointsOfGrain_.items[i]);
  }

  double measure(size_t grain) {
    forEachPoint(grain, [&](uint32_t point) { gradients_[point] = Vec3d(0); });
    // Near: keeps the sums exact enough.
    const Vec3d reference = at(mesh_.triangles[mesh_.firstTriangle[grain]][0]);
    double volume = 0;
    for (uint32_t t = mesh_.firstTriangle[grain]; t < mesh_.firstTriangle[grain + 1]; ++t) {
      const auto& [a, b, c] = mesh_.triangles[t];
      const Vec3d p = at(a) - reference, q = at(b) - reference, r = at(c) - reference;
      const Vec3d toP = q.cross(r) / 6, toQ = r.cross(p) / 6, toR = p.cross(q) / 6;
      volume += p.dot(toP);
      gradients_[a] += toP;
      gradients_[b] += toQ;
      gradients_[c] += toR;
    }
    double diagonal = 0;
    forEachPoint(grain, [&](uint32_t point) { diagonal += gradients_[point].lengthSqr(); });
    const double missing = double(volumes_[grain]) - volume;
    pressures_[grain] = diagonal > 0 ? missing / diagonal : 0;
    return std::abs(missing) / double(volumes_[grain]);
  }

  /// One step towards displacements along the gradients that give every grain its volume.
  void correct() {
    parallelFor(homes_.size(), kSiteGrain, nullptr, [&](size_t begin, size_t end) {
      for (size_t site = begin; site < end; ++site) {
        Vec3d wanted(mesh_.positions[site]);
        for (uint32_t i = pointsOfSite_.first[site]; i < pointsOfSite_.first[site + 1]; ++i) {
          const uint32_t point = pointsOfSite_.items[i];
          wanted += kRelaxation * pressures_[mesh_.pointGrain[point]] * gradients_[point];
        }
        mesh_.positions[site] = withinReach(homes_[site], wanted, reach_, domain_);
      }
    });
  }

  SharedMesh& mesh_;
  const std::vector<int64_t>& volumes_;
  const std::vector<Vec3f>& homes_;
  const float reach_;
  const DomainFaces& domain_;
  Interrupter* interrupter_;
  const Lists pointsOfGrain_, pointsOfSite_;
  std::vector<Vec3d> gradients_;   // per point
  std::vector<double> pressures_;  // per grain
};

}  // namespace

Vec3f withinReach(const Vec3f& home, const Vec3d& wanted, float reach, const DomainFaces& domain) {
  Vec3f result;
  for (int axis = 0; axis < 3; ++axis) {
    if (domain.isOn(home, axis)) {
      result[axis] = home[axis];
      continue;
    }
    result[axis] = std::clamp(float(wanted[axis]), home[axis] - reach, home[axis] + reach);
    if (domain.areKnown)
      result[axis] = std::clamp(result[axis], domain.low[axis], domain.high[axis]);
  }
  return result;
}

void correctVolumes(SharedMesh& mesh, const std::vector<int64_t>& volumes,
                    const std::vector<Vec3f>& homes, float reach, const DomainFaces& domain,
                    Interrupter* interrupter) {
  VolumeCorrection(mesh, volumes, homes, reach, domain, interrupter).run();
}

}  // namespace vdb_madf::detail
