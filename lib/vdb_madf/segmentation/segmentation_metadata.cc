// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/segmentation_metadata.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <initializer_list>
#include <string>

#include "vdb_madf/base/version.h"

namespace vdb_madf {

namespace {

constexpr char kGrains[] = "madf_grains", kObjectVoxels[] = "madf_object_voxels",
               kLeaves[] = "madf_leaves", kCriticalPoints[] = "madf_critical_points",
               kMinGrain[] = "madf_min_grain";

void setText(openvdb::GridBase& grid, const char* key, const std::string& value) {
  grid.insertMeta(key, openvdb::StringMetadata(value));
}
void setCount(openvdb::GridBase& grid, const char* key, int64_t value) {
  grid.insertMeta(key, openvdb::Int64Metadata(value));
}
std::optional<int64_t> countOf(const openvdb::GridBase& grid, const char* key) {
  const auto count = grid.getMetadata<openvdb::Int64Metadata>(key);
  if (!count) return std::nullopt;
  return count->value();
}

void removeMergeOptions(openvdb::GridBase& grid) {
  for (const char* key :
       {"madf_theta", "madf_adjacency", "madf_delta", "madf_strictness", kMinGrain})
    grid.removeMeta(key);
}

/// Finds the value that is called so.
template <typename Enum>
bool isNamed(const std::string& name, std::initializer_list<Enum> values, Enum& found) {
  for (const Enum value : values) {
    if (name != toString(value)) continue;
    found = value;
    return true;
  }
  return false;
}

}  // namespace

const char* toString(MergeMode mode) {
  constexpr const char* kNames[] = {"both", "angle", "neck", "score"};
  return kNames[size_t(mode)];
}

const char* toString(Adjacency adjacency) {
  return adjacency == Adjacency::manifold ? "manifold" : "cell";
}

void describeSegmentation(openvdb::GridBase& grid, const SegmentOptions& options,
                          const SegmentationRecord& record) {
  const SegmentCounts& counts = record.counts;
  setText(grid, "madf_version", kVersion);
  setCount(grid, "madf_gamma", options.gamma);
  setBoundary(grid, record.open ? Boundary::open : Boundary::closed);
  setCount(grid, "madf_fill_holes", record.fillHoles);
  setWeights(grid, record.weights);
  setCount(grid, kObjectVoxels, counts.objectVoxels);
  setCount(grid, "madf_cavities", counts.cavities);
  setCount(grid, "madf_cavity_voxels", counts.cavityVoxels);
  setCount(grid, "madf_medial_balls", counts.medialBalls);
  setCount(grid, "madf_kept_balls", counts.keptBalls);
  setCount(grid, kCriticalPoints, counts.criticalPoints);
  setCount(grid, "madf_largest_squared_distance", counts.largestSquaredDistance);
  setCount(grid, kLeaves, counts.leaves);
  describeMerging(grid, options.merge, record.tidy, counts.grains);
}

void describeMerging(openvdb::GridBase& grid, const MergeOptions& options, int tidy,
                     int64_t grains) {
  removeMergeOptions(grid);
  setText(grid, "madf_merge", toString(options.mode));
  if (options.mode == MergeMode::score) {
    grid.insertMeta("madf_strictness", openvdb::DoubleMetadata(options.strictness));
  } else {
    grid.insertMeta("madf_theta", openvdb::DoubleMetadata(options.theta));
    setText(grid, "madf_adjacency", toString(options.adjacency));
    setCount(grid, "madf_delta", options.delta);
  }
  if (options.minGrain > 0) setCount(grid, kMinGrain, options.minGrain);
  setCount(grid, "madf_tidy", tidy);
  setCount(grid, kGrains, grains);
}

void describeOwnMerging(openvdb::GridBase& grid, int tidy, int64_t grains) {
  removeMergeOptions(grid);
  setText(grid, "madf_merge", "own");
  setCount(grid, "madf_tidy", tidy);
  setCount(grid, kGrains, grains);
}

std::optional<StoredMerging> storedMerging(const openvdb::MetaMap& metadata) {
  const auto mode = metadata.getMetadata<openvdb::StringMetadata>("madf_merge");
  const auto theta = metadata.getMetadata<openvdb::DoubleMetadata>("madf_theta");
  const auto strictness = metadata.getMetadata<openvdb::DoubleMetadata>("madf_strictness");
  const auto adjacency = metadata.getMetadata<openvdb::StringMetadata>("madf_adjacency");
  const auto delta = metadata.getMetadata<openvdb::Int64Metadata>("madf_delta");
  const auto tidy = metadata.getMetadata<openvdb::Int64Metadata>("madf_tidy");
  const auto minGrain = metadata.getMetadata<openvdb::Int64Metadata>(kMinGrain);
  if (!mode || !tidy) return std::nullopt;
  StoredMerging merging;
  if (minGrain) merging.options.minGrain = minGrain->value();
  merging.tidy = int(std::clamp<int64_t>(tidy->value(), -1, kMaxTidy + 1));
  if (mode->value() == toString(MergeMode::score)) {
    if (!strictness) return std::nullopt;
    merging.options.mode = MergeMode::score;
    merging.options.strictness = strictness->value();
    return merging;
  }
  if (!theta || !adjacency || !delta) return std::nullopt;
  merging.options.theta = theta->value();
  if (!isNamed(mode->value(), {MergeMode::both, MergeMode::angle, MergeMode::neck},
               merging.options.mode) ||
      !isNamed(adjacency->value(), {Adjacency::manifold, Adjacency::cell},
               merging.options.adjacency))
    return std::nullopt;
  // Beyond any option: their checks refuse it.
  merging.options.delta = int(std::clamp<int64_t>(delta->value(), -1, kMaxDelta + 1));
  return merging;
}

void updateCounts(openvdb::GridBase& grid, int64_t grains, bool voxelsWent) {
  if (!grainCount(grid)) return;
  setCount(grid, kGrains, grains);
  if (!voxelsWent) return;
  setCount(grid, kObjectVoxels, int64_t(grid.activeVoxelCount()));
  setCount(grid, kLeaves, int64_t(grid.baseTree().leafCount()));
  for (const char* key : {"madf_cavities", "madf_cavity_voxels", "madf_medial_balls",
                          "madf_kept_balls", kCriticalPoints, "madf_largest_squared_distance"})
    grid.removeMeta(key);
}

bool hasSegmentedVoxels(const openvdb::GridBase& grid) {
  return objectVoxelCount(grid) == int64_t(grid.activeVoxelCount()) && grid[kCriticalPoints];
}

std::optional<int64_t> objectVoxelCount(const openvdb::GridBase& grid) {
  return countOf(grid, kObjectVoxels);
}

std::optional<int64_t> grainCount(const openvdb::GridBase& grid) {
  return countOf(grid, kGrains);
}

}  // namespace vdb_madf
