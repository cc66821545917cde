// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/verify/verify.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include "vdb_madf/base/counted.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/verify/detail/replayed_merge.h"

namespace vdb_madf {

namespace {

using namespace detail;

CoordBBox boxToJudge(const Definition& definition, const MaskGrid& object) {
  if (definition.domain) return definition.domain->box();
  CoordBBox box = object.evalActiveVoxelBoundingBox();
  box.expand(1);
  return box;
}

void checkBox(const CoordBBox& box, const Definition& definition, int64_t maxMemory) {
  constexpr double kBytesPerVoxel = 32;
  const Coord n = box.dim();
  const double voxels = double(n.x()) * n.y() * n.z(), bytes = kBytesPerVoxel * voxels;
  std::ostringstream size;
  size << n.x() << " x " << n.y() << " x " << n.z() << " voxels";
  if (voxels >= double(INT32_MAX))
    throw InvalidInput("the box to verify has " + size.str() +
                       ": only boxes of fewer than 2^31 voxels can be verified");
  for (int axis = 0; axis < 3; ++axis)
    if (double(definition.weights[size_t(axis)]) * n[axis] * n[axis] > 1e18)
      throw InvalidInput("metadata madf_weights: too large for a box of " + size.str());
  if (maxMemory > 0 && bytes > double(maxMemory))
    throw InvalidInput("verifying a box of " + size.str() + " needs about " +
                           readableBytes(int64_t(bytes)) + " of memory, and " +
                           readableBytes(maxMemory) + " may be taken",
                       Hint::memoryLimit);
}

/// Object, background and what is unknown; returns how many voxels of the object leave the domain.
int64_t fillVoxels(const DenseBox& space, const Definition& definition, const MaskGrid& object,
                   Voxels& voxels) {
  const bool isRegion = definition.domain && !definition.domain->isBox();
  voxels.assign(size_t(space.count()), isRegion ? Voxel::unknown : Voxel::background);
  if (isRegion)
    forActive(*definition.domain->region(), [&](const CoordBBox& bounds, bool) {
      forVoxels(space, bounds, [&](int64_t i) { voxels[size_t(i)] = Voxel::background; });
    });
  int64_t outside = 0;
  forActive(object.tree(), [&](const CoordBBox& bounds, bool) {
    const int64_t beyond = forVoxels(space, bounds, [&](int64_t i) {
      outside += voxels[size_t(i)] == Voxel::unknown;
      voxels[size_t(i)] = Voxel::object;
    });
    outside += beyond;
  });
  return outside;
}

/// The labels that there should be.
std::vector<int32_t> rightLabels(const DenseBox& space, const Definition& definition, Voxels voxels,
                                 std::vector<std::pair<const char*, int64_t>>& counts,
                                 Verification& found, Interrupter* interrupter) {
  const int64_t cavities = fillCavities(space, definition, voxels);
  found.voxels = std::count(voxels.begin(), voxels.end(), Voxel::object);
  found.cavityVoxels = std::count(voxels.begin(), voxels.end(), Voxel::cavity);
  std::vector<int32_t> distance = squaredDistance(space, definition, voxels, interrupter);
  int64_t largest = 0;
  for (size_t i = 0; i < voxels.size(); ++i)
    if (isBody(voxels[i])) largest = std::max<int64_t>(largest, distance[i]);
  if (largest == kFar) {
    found.fault =
        "there is no background, or it is farther than squared distances of 32 bits reach";
    return {};
  }
  Flow flow = flowOf(space, definition, voxels, distance, interrupter);
  const Manifolds manifolds = manifoldsOf(space, definition, voxels, distance, flow);
  flow.site = {};
  distance = {};
  const Grains grains = grainsOf(space, definition, manifolds);
  std::vector<int32_t> label = std::move(flow.critical);
  for (size_t i = 0; i < label.size(); ++i)
    label[i] = voxels[i] == Voxel::object ? grains.ofNode[size_t(label[i])] : 0;
  tidyUp(space, definition, manifolds, grains, label, interrupter);
  found.medialBalls = flow.medialBalls;
  found.criticalPoints = int64_t(manifolds.nodes.size());
  found.grains = int64_t(grains.representative.size());
  counts = {
      {"madf_object_voxels", found.voxels},       {"madf_cavities", cavities},
      {"madf_cavity_voxels", found.cavityVoxels}, {"madf_medial_balls", found.medialBalls},
      {"madf_kept_balls", flow.keptBalls},        {"madf_critical_points", found.criticalPoints},
      {"madf_largest_squared_distance", largest}, {"madf_grains", found.grains}};
  return label;
}

std::string labelText(int32_t label) {
  return label == 0 ? "no grain" : "grain " + std::to_string(label);
}

/// Compares voxel by voxel.
void compareLabels(const DenseBox& space, const LabelSlabs& labels,
                   const std::vector<int32_t>& right, Verification& found,
                   Interrupter* interrupter) {
  std::vector<int32_t> there(right.size(), 0);
  int64_t outside = 0, noLabels = 0;
  for (size_t slab = 0; slab < labels.slabCount(); ++slab)
    forActive(labels.read(slab, interrupter)->tree(), [&](const CoordBBox& bounds, int32_t value) {
      if (value <= 0) noLabels += int64_t(bounds.volume());
      outside += forVoxels(space, bounds, [&](int64_t i) { there[size_t(i)] = value; });
    });
  int64_t first = -1;
  for (size_t i = 0; i < right.size(); ++i) {
    if (there[i] == right[i]) continue;
    if (found.differing++ == 0) first = int64_t(i);
  }
  std::ostringstream text;
  if (found.differing > 0) {
    text << counted(found.differing, "voxel") << (found.differing == 1 ? " differs" : " differ")
         << ": the first, " << space.coord(first) << ", has " << labelText(there[size_t(first)])
         << " and should have " << labelText(right[size_t(first)]);
  } else if (outside > 0) {
    text << counted(outside, "labeled voxel") << " lie outside of the domain";
  } else if (noLabels > 0) {
    text << counted(noLabels, "active voxel") << " without a positive label";
  }
  found.differing += outside;
  found.fault = text.str();
}

void compareCounts(const openvdb::MetaMap& labels,
                   const std::vector<std::pair<const char*, int64_t>>& counts,
                   Verification& found) {
  for (const auto& [key, right] : counts) {
    const auto stored = labels.getMetadata<openvdb::Int64Metadata>(key);
    if (stored && stored->value() == right) continue;
    found.fault = std::string("metadata ") + key + " says " +
                  (stored ? std::to_string(stored->value()) : "nothing") + " and should say " +
                  std::to_string(right);
    return;
  }
}

int64_t voxelsOf(const LabelSlabs& labels, Interrupter* interrupter) {
  int64_t voxels = 0;
  for (size_t slab = 0; slab < labels.slabCount(); ++slab)
    voxels += int64_t(labels.read(slab, interrupter)->activeVoxelCount());
  return voxels;
}

}  // namespace

Verification verify(const LabelSlabs& labels, const MaskGrid& object, int64_t maxMemory,
                    Interrupter* interrupter) {
  const Definition definition(*labels.about);
  Verification found;
  const auto domain = storedDomain(object);
  if (domain && (!definition.domain || *domain != *definition.domain)) {
    found.fault = "their domain is not that of the object (which has to be cropped as they were)";
    return found;
  }
  std::vector<std::pair<const char*, int64_t>> counts;
  if (object.activeVoxelCount() == 0) {
    found.differing = voxelsOf(labels, interrupter);
    if (found.differing > 0)
      found.fault = counted(found.differing, "voxel") + " of an object that has none";
    return found;
  }
  const CoordBBox box = boxToJudge(definition, object);
  checkBox(box, definition, maxMemory);
  const DenseBox space(box);
  Voxels voxels;
  if (const int64_t outside = fillVoxels(space, definition, object, voxels)) {
    found.fault = counted(outside, "voxel") + " of the object outside of their domain";
    return found;
  }
  const std::vector<int32_t> right =
      rightLabels(space, definition, std::move(voxels), counts, found, interrupter);
  if (found.fault.empty()) compareLabels(space, labels, right, found, interrupter);
  if (found.fault.empty()) compareCounts(*labels.about, counts, found);
  return found;
}

}  // namespace vdb_madf
