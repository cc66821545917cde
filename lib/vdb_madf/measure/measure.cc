// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/measure.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/labels/detail/label_digest.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/measure/correlation_length.h"
#include "vdb_madf/measure/detail/bond_measures.h"
#include "vdb_madf/measure/detail/grain_measures.h"
#include "vdb_madf/measure/detail/grain_representatives.h"
#include "vdb_madf/measure/detail/grain_shapes.h"
#include "vdb_madf/measure/detail/label_sums.h"
#include "vdb_madf/measure/detail/sample_measures.h"
#include "vdb_madf/measure/detail/voxel_shape.h"
#include "vdb_madf/measure/edge_weights.h"
#include "vdb_madf/measure/euler_characteristic.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/segment.h"

namespace vdb_madf {

namespace {

/// The metric of an object of that extent.
VoxelWeights weightsOf(const detail::VoxelShape& voxel, const Int32Grid& labels,
                       const LeafIndex& index) {
  if (voxel.isCube() || index.voxelCount() == 0) return {};
  return weightsOfEdges(voxelEdges(labels.transform()), index.boundingBox().dim()).weights;
}

void setRepresentatives(const detail::GrainRepresentatives& representatives,
                        const VoxelWeights& weights, Measurements& result) {
  if (representatives.empty()) return;
  const double unit = weights.least();  // the weight of the shortest edge, which is 1
  for (GrainMeasures& grain : result.grains) {
    const detail::GrainRepresentative& deepest = representatives.at(grain.id);
    grain.representative = deepest.voxel;
    grain.inscribedRadius = std::sqrt(double(deepest.squaredRadius) / unit);
  }
  for (BondMeasures& bond : result.bonds) {
    const detail::GrainRepresentative &a = representatives.at(bond.first),
                                      &b = representatives.at(bond.second);
    const int64_t squaredDistance = detail::squaredBetween(a.voxel, b.voxel, weights);
    bond.distance = std::sqrt(double(squaredDistance) / unit);
    bond.cosAlpha = detail::cosAlpha(squaredDistance, a.squaredRadius, b.squaredRadius);
  }
}

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
      --std::lower_bound(result.grains.begin(), result.grains.end(), id,
                         [](const GrainMeasures& grain, int32_t label) { return grain.id < label; })
            ->coordination;
  return small;
}

void checkEdgeWeights(const std::optional<Domain>& domain, bool open) {
  const std::string what = "weights for grains cut by the faces of the scan";
  if (!domain) throw InvalidInput(what + ": its domain is unknown: give it");
  if (!domain->isBox())
    throw InvalidInput(what + " are known for boxes alone, and the domain is a region: crop a box");
  if (!open)
    throw InvalidInput(what + ": none is cut where the boundary is closed; measure with it open");
}

/// \p graph: of the segmentation, if it tells the representatives under its weights; else null.
Measurements measureLabels(const Int32Grid& labels, const MeasureOptions& options,
                           const ManifoldGraph* graph, Interrupter* interrupter) {
  if (options.minFaces < 0)
    throw InvalidInput("the least number of faces of a bond must not be negative");
  const detail::VoxelShape voxel{detail::proportions(labels.transform())};
  const detail::LabelLeaves leaves(labels, interrupter);
  const LeafIndex& index = leaves.index();
  const std::optional<Domain> domain = options.domain ? options.domain : storedDomain(labels);
  const Boundary boundary =
      options.boundary == Boundary::automatic ? storedBoundary(labels) : options.boundary;
  const Obstacles obstacles = resolveBoundary(index, boundary, domain);
  if (options.edgeWeights) checkEdgeWeights(domain, obstacles.open);
  if (options.bootstrap != 0) requireReplicates(options.bootstrap);
  const VoxelWeights weights = weightsOf(voxel, labels, index);
  Measurements result;
  result.voxelSize = storedVoxelSize(labels);
  result.edges = voxel.edges;
  result.minFaces = options.minFaces;
  result.extra.shape = options.shape;
  result.extra.edgeWeights = options.edgeWeights;
  result.replicates = options.bootstrap;
  result.open = obstacles.open;
  result.gridName = labels.getName();
  result.metadata = labels;
  result.labelDigest = detail::labelDigest(leaves);
  const Domain whole = domain.value_or(index.boundingBox());
  {
    const detail::LabelSums sums =
        detail::labelSums(leaves, whole, obstacles.open, voxel, interrupter);
    result.bonds = detail::bondMeasures(sums, voxel, interrupter);
    result.grains = detail::grainMeasures(sums, result.bonds, whole, voxel);
  }
  if (options.edgeWeights) {
    for (GrainMeasures& grain : result.grains)
      grain.edgeWeight = edgeWeight(grain.box, whole.box());
  }
  if (options.shape) detail::measureShapes(leaves, voxel, result.grains, interrupter);
  setRepresentatives(graph && graph->weights == weights
                         ? detail::grainRepresentatives(labels, *graph)
                         : detail::grainRepresentatives(leaves, obstacles, weights, interrupter),
                     weights, result);
  const std::vector<BondMeasures> leftOut = takeSmallBonds(result);
  SampleMeasures& sample = result.sample;
  sample = detail::sampleMeasures(result.grains, result.bonds, whole);
  sample.contactsLeftOut = int64_t(leftOut.size());
  for (const BondMeasures& contact : leftOut) sample.areaLeftOut += contact.area;
  sample.sharedArea += sample.areaLeftOut;
  sample.domainKnown = domain.has_value();
  sample.correlationLengths = correlationLengths(index, whole, interrupter);
  for (int axis = 0; axis < 3; ++axis)
    if (auto& length = sample.correlationLengths[size_t(axis)]) *length *= voxel.edges[axis];
  sample.eulerCharacteristic = eulerCharacteristic(index, interrupter);
  sample.components = detail::ConnectedComponents(index).count();
  if (options.bootstrap != 0)
    result.intervals =
        bootstrapMeans(result.grains, result.bonds, result.extra, options.bootstrap, interrupter);
  return result;
}

}  // namespace

Measurements measure(const Int32Grid& labels, const MeasureOptions& options,
                     Interrupter* interrupter) {
  return measureLabels(labels, options, nullptr, interrupter);
}

Measurements measure(const Segmentation& segmentation, Interrupter* interrupter) {
  // The labels' own: of unfiltered balls, no cavity filled, each voxel where the flow led it.
  const SegmentCounts& counts = segmentation.counts;
  const bool graphTells =
      counts.keptBalls == counts.medialBalls && counts.cavities == 0 && segmentation.tidy == 0;
  return measureLabels(*segmentation.grain, {}, graphTells ? &segmentation.graph : nullptr,
                       interrupter);
}

}  // namespace vdb_madf
