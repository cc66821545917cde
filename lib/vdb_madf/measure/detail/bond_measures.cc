// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/bond_measures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/measure/detail/fit_curvature.h"
#include "vdb_madf/measure/detail/principal_axes.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kBondGrain = 4;

/// Exact sums over the faces' centers, doubled and relative to `origin`.
struct FaceSums {
  std::array<int64_t, 3> sum{};
  std::array<int64_t, 6> products{};
  std::array<int64_t, 3> normal{};
};

FaceSums faceSums(const std::vector<InterfaceFace>& faces, const Coord& origin) {
  FaceSums sums;
  for (const InterfaceFace& face : faces) {
    int64_t c[3];
    for (int i = 0; i < 3; ++i)
      c[i] = 2 * (int64_t(face.lower[i]) - origin[i]) + (i == face.axis ? 1 : 0);
    for (size_t i = 0; i < 3; ++i) {
      sums.sum[i] += c[i];
      sums.products[i] += c[i] * c[i];
    }
    sums.products[3] += c[0] * c[1];
    sums.products[4] += c[0] * c[2];
    sums.products[5] += c[1] * c[2];
    sums.normal[size_t(face.axis)] += face.sign;
  }
  return sums;
}

int countPatches(const std::vector<InterfaceFace>& faces, const Coord& origin) {
  // Corners from the origin, 21 bits each: an object is shorter (kMaxExtent).
  constexpr int kBits = 21;
  std::vector<std::pair<uint64_t, uint32_t>> corners;
  corners.reserve(4 * faces.size());
  for (size_t i = 0; i < faces.size(); ++i) {
    const int axis = faces[i].axis, a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (int k = 0; k < 4; ++k) {
      Coord corner = faces[i].lower - origin;
      corner[axis] += 1;
      corner[a] += k & 1;
      corner[b] += k >> 1;
      uint64_t key = 0;
      for (int j = 0; j < 3; ++j) key = key << kBits | uint64_t(corner[j] + (1 << (kBits - 1)));
      corners.emplace_back(key, uint32_t(i));
    }
  }
  std::sort(corners.begin(), corners.end());
  DisjointSets sets(faces.size());
  for (size_t i = 1; i < corners.size(); ++i)
    if (corners[i].first == corners[i - 1].first)
      sets.unite(corners[i].second, corners[i - 1].second);
  int patches = 0;
  for (uint32_t i = 0; i < faces.size(); ++i) patches += sets.find(i) == i;
  return patches;
}

BondMeasures measureBond(const BondSums& from, const VoxelShape& voxel) {
  BondMeasures bond;
  bond.first = from.first;
  bond.second = from.second;
  bond.faces = int64_t(from.faces.size());
  bond.area = bondArea(from.areas, voxel);
  for (const InterfaceFace& face : from.faces) bond.faceArea += voxel.faceArea(face.axis);
  bond.equivalentRadius = std::sqrt(bond.area / M_PI);

  const Coord origin = from.faces.front().lower;
  const FaceSums sums = faceSums(from.faces, origin);
  const auto n = double(bond.faces);
  for (int i = 0; i < 3; ++i) bond.centroid[i] = origin[i] + double(sums.sum[size_t(i)]) / (2 * n);
  std::array<double, 6> spread = covariance(bond.faces, sums.sum, sums.products);
  for (double& value : spread) value /= 4;  // coordinates were doubled
  inSpace(voxel, spread);
  const Principal principal = principalAxes(spread);
  bond.flatness = std::max(0.0, principal.values[2]);
  for (int i = 0; i < 3; ++i) bond.normal[i] = double(sums.normal[size_t(i)]) * voxel.faceArea(i);
  if (!bond.normal.normalize(0)) bond.normal = principal.axes[2];
  bond.patches = countPatches(from.faces, origin);
  bond.curvature = fitCurvature(from.faces, voxel);
  return bond;
}

}  // namespace

std::vector<BondMeasures> bondMeasures(const std::vector<BondSums>& sums, const VoxelShape& voxel,
                                       Interrupter* interrupter) {
  std::vector<BondMeasures> bonds(sums.size());
  parallelForEach(bonds.size(), kBondGrain, interrupter,
                  [&](size_t i) { bonds[i] = measureBond(sums[i], voxel); });
  return bonds;
}

}  // namespace vdb_madf::detail
