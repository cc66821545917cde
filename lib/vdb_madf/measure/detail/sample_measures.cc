// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/sample_measures.h"

#include <algorithm>
#include <map>

#include "vdb_madf/measure/detail/principal_axes.h"

namespace vdb_madf::detail {

namespace {

/// Weighted mean of n n^T.
class Fabric {
 public:
  void add(const openvdb::Vec3d& n, double weight) {
    const double products[6] = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                                n[0] * n[1], n[0] * n[2], n[1] * n[2]};
    for (size_t i = 0; i < 6; ++i) sum_[i] += weight * products[i];
    weights_ += weight;
  }
  FabricTensor mean() const {
    FabricTensor tensor;
    if (weights_ > 0)
      for (size_t i = 0; i < 6; ++i) tensor.components[i] = sum_[i] / weights_;
    tensor.principal = principalAxes(tensor.components);
    return tensor;
  }

 private:
  std::array<double, 6> sum_{};
  double weights_ = 0;
};

}  // namespace

SampleMeasures sampleMeasures(const std::vector<GrainMeasures>& grains,
                              const std::vector<BondMeasures>& bonds, const Domain& domain) {
  SampleMeasures sample;
  sample.box = domain.box();
  if (!domain.isBox()) sample.regionVoxels = int64_t(domain.voxelCount());
  Fabric grainFabric, bondFabric;
  std::map<int32_t, double> diameters;
  for (const GrainMeasures& grain : grains) {
    sample.objectVoxels += grain.voxels;
    sample.objectVolume += grain.volume;
    sample.freeArea += grain.freeArea;
    diameters[grain.id] = grain.equivalentDiameter;
    grainFabric.add(grain.ellipsoid.axes[0], double(grain.voxels));
    const auto bins = size_t(grain.coordination) + 1;
    if (sample.coordinations.size() < bins) sample.coordinations.resize(bins, 0);
    ++sample.coordinations[size_t(grain.coordination)];
  }
  double ratios = 0;
  for (const BondMeasures& bond : bonds) {
    sample.sharedArea += bond.area;
    sample.bondsWithoutCurvature += bond.curvature ? 0 : 1;
    bondFabric.add(bond.normal, bond.area);
    ratios += 2 * bond.equivalentRadius / std::min(diameters[bond.first], diameters[bond.second]);
  }
  if (!bonds.empty()) sample.bondToGrainRatio = ratios / double(bonds.size());
  if (!grains.empty()) sample.meanCoordination = 2.0 * double(bonds.size()) / double(grains.size());
  if (sample.objectVoxels > 0) {
    sample.objectFraction = double(sample.objectVoxels) / double(domain.voxelCount());
    sample.specificSurface = sample.freeArea / sample.objectVolume;
  }
  sample.grainFabric = grainFabric.mean();
  sample.bondFabric = bondFabric.mean();
  return sample;
}

}  // namespace vdb_madf::detail
