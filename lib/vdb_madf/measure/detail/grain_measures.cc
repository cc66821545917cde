// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/grain_measures.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "vdb_madf/measure/detail/principal_axes.h"

namespace vdb_madf::detail {

namespace {

/// Second moment of a cube of one voxel about its center, along each axis.
constexpr double kVoxelMoment = 1.0 / 12;
/// Voxels, of a cube of three. The area of fewer may come out under that of their ball.
constexpr int64_t kLeastOfSphericity = 27;

/// A solid ellipsoid of half axis a has the moment a^2 / 5 along it.
Principal ellipsoidOf(const GrainSums& grain, const VoxelShape& voxel) {
  std::array<double, 6> moments = covariance(grain.voxels, grain.sum, grain.products);
  for (size_t i = 0; i < 3; ++i) moments[i] += kVoxelMoment;
  inSpace(voxel, moments);
  Principal principal = principalAxes(moments);
  for (double& value : principal.values) value = 2 * std::sqrt(5 * std::max(0.0, value));
  return principal;
}

bool touchesFace(const CoordBBox& box, const CoordBBox& domain) {
  for (int axis = 0; axis < 3; ++axis)
    if (box.min()[axis] <= domain.min()[axis] || box.max()[axis] >= domain.max()[axis]) return true;
  return false;
}

std::vector<GrainCut> cutsOf(const GrainSums& grain, const Coord& origin, const VoxelShape& voxel) {
  std::vector<GrainCut> cuts;
  for (const auto& [side, faces, sum] : grain.cuts) {
    GrainCut& cut = cuts.emplace_back();
    cut.axis = side >> 1;
    cut.isUpper = !(side & 1);
    cut.area = double(faces) * voxel.faceArea(cut.axis);
    for (int i = 0; i < 3; ++i)
      cut.centroid[i] = origin[i] + double(sum[size_t(i)]) / double(2 * faces);
  }
  std::sort(cuts.begin(), cuts.end(), [](const GrainCut& a, const GrainCut& b) {
    return std::pair(a.axis, a.isUpper) < std::pair(b.axis, b.isUpper);
  });
  return cuts;
}

}  // namespace

std::vector<GrainMeasures> grainMeasures(const LabelSums& sums,
                                         const std::vector<BondMeasures>& bonds,
                                         const Domain& domain, const VoxelShape& voxel) {
  std::vector<GrainMeasures> grains;
  std::unordered_map<int32_t, size_t> row;
  for (const GrainSums& from : sums.grains()) {
    GrainMeasures grain;
    grain.id = from.label;
    grain.voxels = from.voxels;
    const auto n = double(from.voxels);
    for (int i = 0; i < 3; ++i)
      grain.centroid[i] = sums.origin()[i] + double(from.sum[size_t(i)]) / n;
    grain.box = from.box;
    grain.atDomainFace = domain.isBox() ? touchesFace(from.box, domain.box()) : from.atRegionWall;
    grain.volume = n * voxel.volume();
    grain.equivalentDiameter = std::cbrt(6 * grain.volume / M_PI);
    grain.freeArea = double(from.freeArea) / kAreaUnit;
    grain.cuts = cutsOf(from, sums.origin(), voxel);
    for (const GrainCut& cut : grain.cuts) grain.cutArea += cut.area;
    grain.ellipsoid = ellipsoidOf(from, voxel);
    row[grain.id] = grains.size();
    grains.push_back(grain);
  }
  for (const BondMeasures& bond : bonds) {
    for (const int32_t id : {bond.first, bond.second}) {
      GrainMeasures& grain = grains[row.at(id)];
      grain.sharedArea += bond.area;
      ++grain.coordination;
    }
  }
  for (GrainMeasures& grain : grains) {
    const double ball = M_PI * grain.equivalentDiameter * grain.equivalentDiameter;
    const double area = grain.totalArea() + grain.cutArea;
    if (grain.voxels >= kLeastOfSphericity && area > 0) grain.sphericity = ball / area;
  }
  return grains;
}

}  // namespace vdb_madf::detail
