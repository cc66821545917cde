// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/volume_correction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/simd.h"

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

/// Triangles at a time.
constexpr size_t kBatch = 32;
using Lanes = std::array<double, kBatch>;
using Places = std::array<Lanes, 3>;  // x, y, z

/// (a x b) / 6, as Vec3d has it.
VDB_MADF_KERNEL void crossSixth(const Places& a, const Places& b, Places& result) {
  for (size_t axis = 0; axis < 3; ++axis) {
    const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (size_t i = 0; i < kBatch; ++i)
      result[axis][i] = (a[u][i] * b[v][i] - a[v][i] * b[u][i]) / 6;
  }
}

/// The corners p, q, r of triangles, from a point near them, the volumes of the tetrahedra that they
/// make with it, and the gradients of these by the corners.
struct Tetrahedra {
  std::array<Places, 3> corners, gradients;
  Lanes volumes;
};

VDB_MADF_KERNEL void measureTetrahedra(Tetrahedra& t) {
  for (size_t n = 0; n < 3; ++n)
    crossSixth(t.corners[(n + 1) % 3], t.corners[(n + 2) % 3], t.gradients[n]);
  const Places &p = t.corners[0], &toP = t.gradients[0];
  for (size_t i = 0; i < kBatch; ++i)
    t.volumes[i] = p[0][i] * toP[0][i] + p[1][i] * toP[1][i] + p[2][i] * toP[2][i];
}

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
        pointsOfSite_(mesh.pointSite, mesh.positions.size()),
        gradients_(mesh.pointSite.size()),
        pressures_(mesh.grainCount()),
        errors_(mesh.grainCount()),
        isMeasured_(mesh.grainCount()),
        hasMoved_(mesh.positions.size(), true) {}

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

  /// Measures the volumes and their gradients where points have moved; the largest error relative to
  /// the true volume.
  double largestError(Interrupter* interrupter) {
    parallelFor(volumes_.size(), kGrainGrain, interrupter, [&](size_t begin, size_t end) {
      std::vector<Vec3d> places;
      for (size_t g = begin; g < end; ++g) {
        isMeasured_[g] = std::any_of(mesh_.pointSite.begin() + firstPoint_[g],
                                     mesh_.pointSite.begin() + firstPoint_[g + 1],
                                     [&](uint32_t site) { return hasMoved_[site]; });
        if (isMeasured_[g]) measure(g, places);
      }
    });
    return errors_.empty() ? 0 : *std::max_element(errors_.begin(), errors_.end());
  }

  /// \p places: scratch space
  void measure(size_t grain, std::vector<Vec3d>& places) {
    const uint32_t first = firstPoint_[grain], end = firstPoint_[grain + 1];
    std::fill(gradients_.begin() + first, gradients_.begin() + end, Vec3d(0));
    // Near: keeps the sums exact enough.
    const Vec3d reference = at(mesh_.triangles[mesh_.firstTriangle[grain]][0]);
    places.clear();
    for (uint32_t point = first; point < end; ++point) places.push_back(at(point) - reference);
    double volume = 0;
    Tetrahedra batch{};
    for (size_t t = mesh_.firstTriangle[grain]; t < mesh_.firstTriangle[grain + 1]; t += kBatch) {
      const size_t count = std::min(kBatch, mesh_.firstTriangle[grain + 1] - t);
      for (size_t i = 0; i < count; ++i)
        for (size_t n = 0; n < 3; ++n)
          for (int axis = 0; axis < 3; ++axis)
            batch.corners[n][size_t(axis)][i] = places[mesh_.triangles[t + i][n] - first][axis];
      atBestLevel([&]() VDB_MADF_INLINE { measureTetrahedra(batch); });
      for (size_t i = 0; i < count; ++i) {
        volume += batch.volumes[i];
        for (size_t n = 0; n < 3; ++n)
          for (int axis = 0; axis < 3; ++axis)
            gradients_[mesh_.triangles[t + i][n]][axis] += batch.gradients[n][size_t(axis)][i];
      }
    }
    double diagonal = 0;
    for (uint32_t point = first; point < end; ++point) diagonal += gradients_[point].lengthSqr();
    const double missing = double(volumes_[grain]) - volume;
    pressures_[grain] = diagonal > 0 ? missing / diagonal : 0;
    errors_[grain] = std::abs(missing) / double(volumes_[grain]);
  }

  /// One step towards displacements along the gradients that give every grain its volume. Points whose
  /// grains were not measured anew stay: what left them where they were has not changed.
  void correct() {
    parallelFor(homes_.size(), kSiteGrain, nullptr, [&](size_t first, size_t last) {
      for (size_t site = first; site < last; ++site) {
        const auto begin = pointsOfSite_.items.begin() + pointsOfSite_.first[site],
                   end = pointsOfSite_.items.begin() + pointsOfSite_.first[site + 1];
        hasMoved_[site] = false;
        if (std::none_of(begin, end, [&](uint32_t p) { return isMeasured_[mesh_.pointGrain[p]]; }))
          continue;
        const Vec3f before = mesh_.positions[site];
        Vec3d wanted(before);
        for (auto p = begin; p != end; ++p)
          wanted += kRelaxation * pressures_[mesh_.pointGrain[*p]] * gradients_[*p];
        mesh_.positions[site] = withinReach(homes_[site], wanted, reach_, domain_);
        hasMoved_[site] = mesh_.positions[site] != before;
      }
    });
  }

  SharedMesh& mesh_;
  const std::vector<int64_t>& volumes_;
  const std::vector<Vec3f>& homes_;
  const float reach_;
  const DomainFaces& domain_;
  Interrupter* interrupter_;
  const std::vector<uint32_t> firstPoint_;  // per grain, one more at the end
  const Lists pointsOfSite_;
  std::vector<Vec3d> gradients_;            // per point
  std::vector<double> pressures_, errors_;  // per grain
  std::vector<uint8_t> isMeasured_;         // per grain: in this round
  std::vector<uint8_t> hasMoved_;           // per site: in the last round
};

}  // namespace

void correctVolumes(SharedMesh& mesh, const std::vector<int64_t>& volumes,
                    const std::vector<Vec3f>& homes, float reach, const DomainFaces& domain,
                    Interrupter* interrupter) {
  VolumeCorrection(mesh, volumes, homes, reach, domain, interrupter).run();
}

}  // namespace vdb_madf::detail
