// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/measuring.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/measure/detail/bond_measures.h"
#include "vdb_madf/measure/detail/euler_characteristic.h"
#include "vdb_madf/measure/detail/grain_measures.h"
#include "vdb_madf/measure/detail/sample_measures.h"
#include "vdb_madf/measure/edge_weights.h"
#include "vdb_madf/method/detail/metric.h"

namespace vdb_madf::detail {

namespace {

/// Takes away the bonds of fewer faces, also from the coordination numbers, and returns them.
std::vector<BondMeasures> takeSmallBonds(Measurements& result) {
  std::vector<BondMeasures>& bonds = result.bonds;
  const auto firstSmall = std::stable_partition(
      bonds.begin(), bonds.end(),
      [&](const BondMeasures& bond) { return bond.faces >= result.minFaces; });
  std::vector<BondMeasures> small(firstSmall, bonds.end());
  bonds.erase(firstSmall, bonds.end());
  for (const BondMeasures& bond : small)
    for (const int32_t id : {bond.first, bond.second})
      --result.grains[rowOf(result.grains, id)].coordination;
  return small;
}

/// @param what needs it
void checkOpenBox(const std::string& what, const std::optional<Domain>& domain, bool open) {
  if (!domain) throw InvalidInput(what + ": its domain is unknown: give it");
  if (!domain->isBox())
    throw InvalidInput(what +
                       " are known for boxes alone, and the domain is a region: crop a box out of "
                       "it (vdb_madf convert --labels --crop)");
  if (!open)
    throw InvalidInput(what + ": none is cut where the boundary is closed; measure with it open");
}

}  // namespace

Measuring::Measuring(const Int32Grid& about, const MeasureOptions& options)
    : about_(&about),
      options_(options),
      voxel_{proportions(about.transform())},
      domain_(options.domain ? options.domain : storedDomain(about)),
      shapes_(voxel_) {
  if (options.minFaces < 0)
    throw InvalidInput("the least number of faces of a bond must not be negative");
  if (options.sizeReference) edgeIn(*options.sizeReference, storedVoxelSize(about));
  options_.sizes = options.sizes || options.sizeReference;
  options_.shape = options.shape || options_.sizes;
  if (options_.boundary == Boundary::automatic) options_.boundary = storedBoundary(about);
  obstacles_ = resolveBoundary(LeafIndex(), options_.boundary, domain_);
  if (options.edgeWeights)
    checkOpenBox("weights for grains cut by the faces of the scan", domain_, obstacles_.open);
  if (options.crossings)
    checkOpenBox("what crosses between grains cut by opposite faces", domain_, obstacles_.open);
  if (options.bootstrap != 0) requireReplicates(options.bootstrap);
}

void Measuring::survey(const LabelLeaves& slab) {
  resolveBoundary(slab.index(), options_.boundary, domain_);
  if (slab.index().voxelCount() > 0) object_.expand(slab.index().boundingBox());
  voxels_ += slab.index().voxelCount();
  digest_.add(slab);
  whole_ = domain_.value_or(object_);
}

const VoxelWeights& Measuring::weights() {
  if (!weights_)
    weights_ = voxel_.isCube() || voxels_ == 0
                   ? VoxelWeights()
                   : weightsOfEdges(voxelEdges(about_->transform()), object_.dim()).weights;
  return *weights_;
}

bool Measuring::hasBackground() const {
  return !(obstacles_.open && voxels_ == obstacles_.domain.voxelCount());
}

void Measuring::add(const LabelLeaves& slab, const LabelLeaves& around, const LeafLayers& layers,
                    const IsComplete& isComplete, Interrupter* interrupter) {
  if (!sums_) sums_.emplace(object_.min(), whole(), obstacles_.open, voxel_);
  sums_->add(around, layers, interrupter);
  // Whatever two grains share has a voxel of each.
  const auto bonds = sums_->takeBonds(
      [&](int32_t first, int32_t second) { return isComplete(first) || isComplete(second); },
      interrupter);
  const std::vector<BondMeasures> measured = bondMeasures(bonds, voxel_, interrupter);
  bonds_.insert(bonds_.end(), measured.begin(), measured.end());
  if (options_.shape) shapes_.add(slab, isComplete, interrupter);
  if (options_.cells) {
    if (!cells_) cells_.emplace(whole(), about_->transform());
    cells_->add(slab);
  }
  euler_ += eulerCharacteristic(around.index(), layers, interrupter);
  components_.add(slab.index(), layers, interrupter);
}

void Measuring::setCells(std::vector<GrainMeasures>& grains, Interrupter* interrupter) const {
  if (!cells_) return;
  const auto cells = cells_->cells(interrupter);
  for (GrainMeasures& grain : grains) {
    const VoronoiCells::Cell& cell = cells.at(grain.id);
    grain.cell = {double(cell.voxels) * voxel_.volume(), cell.neighbors, cell.atDomainFace};
  }
}

void Measuring::setRepresentatives(const GrainRepresentatives& representatives,
                                   Measurements& result) {
  if (representatives.empty()) return;
  const double unit = weights().least();  // the weight of the shortest edge, which is 1
  for (GrainMeasures& grain : result.grains) {
    const GrainRepresentative& deepest = representatives.at(grain.id);
    grain.representative = deepest.voxel;
    grain.inscribedRadius = std::sqrt(double(deepest.squaredRadius) / unit);
  }
  for (BondMeasures& bond : result.bonds) {
    const GrainRepresentative &a = representatives.at(bond.first),
                              &b = representatives.at(bond.second);
    const int64_t squaredDistance = squaredBetween(a.voxel, b.voxel, weights());
    bond.distance = std::sqrt(double(squaredDistance) / unit);
    bond.cosAlpha = cosAlpha(squaredDistance, a.squaredRadius, b.squaredRadius);
    if (options_.bondRadii)
      bond.inscribedRadius = std::sqrt(double(bondDepths_.at({bond.first, bond.second})) / unit);
  }
}

Measurements Measuring::finish(const GrainRepresentatives& representatives,
                               const std::array<std::optional<double>, 3>& correlationLengths,
                               Interrupter* interrupter) {
  Measurements result;
  result.voxelSize = storedVoxelSize(*about_);
  result.edges = voxel_.edges;
  result.minFaces = options_.minFaces;
  result.extra.shape = options_.shape;
  result.extra.edgeWeights = options_.edgeWeights;
  result.extra.cells = options_.cells;
  result.extra.sizes = options_.sizes;
  result.extra.bondRadii = options_.bondRadii;
  result.replicates = options_.bootstrap;
  result.open = obstacles_.open;
  result.gridName = about_->getName();
  result.metadata = *about_;
  result.labelDigest = digest_.text();
  result.bonds = std::move(bonds_);
  std::sort(result.bonds.begin(), result.bonds.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
  if (sums_) result.grains = grainMeasures(*sums_, result.bonds, whole(), voxel_);
  for (GrainMeasures& grain : result.grains) {
    if (options_.edgeWeights) grain.edgeWeight = edgeWeight(grain.box, whole().box());
    if (options_.shape) grain.shape = shapes_.shapes().at(grain.id);
  }
  setCells(result.grains, interrupter);
  setRepresentatives(representatives, result);
  const std::vector<BondMeasures> leftOut = takeSmallBonds(result);
  SampleMeasures& sample = result.sample;
  sample = sampleMeasures(result.grains, result.bonds, whole());
  sample.contactsLeftOut = int64_t(leftOut.size());
  for (const BondMeasures& contact : leftOut) sample.areaLeftOut += contact.area;
  sample.sharedArea += sample.areaLeftOut;
  sample.domainKnown = domain_.has_value();
  sample.correlationLengths = correlationLengths;
  for (int axis = 0; axis < 3; ++axis)
    if (auto& length = sample.correlationLengths[size_t(axis)]) *length *= voxel_.edges[axis];
  sample.eulerCharacteristic = euler_;
  sample.components = components_.count();
  if (options_.crossings) measureCrossings(result);
  if (options_.sizeReference)
    result.sizeDeviations = sizeDeviations(result, *options_.sizeReference);
  if (options_.bootstrap != 0)
    result.intervals =
        bootstrapMeans(result.grains, result.bonds, result.extra, options_.bootstrap, interrupter);
  return result;
}

}  // namespace vdb_madf::detail
