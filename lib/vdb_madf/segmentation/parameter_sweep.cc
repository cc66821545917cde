// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/parameter_sweep.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/hierarchy.h"
#include "vdb_madf/method/join_small.h"
#include "vdb_madf/segmentation/detail/grain_flags.h"
#include "vdb_madf/segmentation/detail/manifold_labels.h"
#include "vdb_madf/segmentation/detail/sweep_rows.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segment.h"

namespace vdb_madf {

namespace {

/// \p sizes ascending.
double median(const std::vector<int64_t>& sizes) {
  if (sizes.empty()) return 0;
  const size_t middle = sizes.size() / 2;
  return sizes.size() % 2 ? double(sizes[middle]) : 0.5 * double(sizes[middle - 1] + sizes[middle]);
}

/// What a row says of the sizes of its grains.
void count(std::vector<int64_t> sizes, int64_t smallVoxels, SweepRow& row) {
  std::sort(sizes.begin(), sizes.end());
  row.grains = int64_t(sizes.size());
  row.medianVoxels = median(sizes);
  row.largestVoxels = sizes.empty() ? 0 : sizes.back();
  for (const int64_t size : sizes) {
    row.objectVoxels += size;
    if (size >= smallVoxels) continue;
    ++row.smallGrains;
    row.smallVoxels += size;
  }
}

/// Of a manifold grid with its graph.
void addRows(const Int32Grid& manifold, const ManifoldGraph& graph,
             const std::optional<Domain>& domain, int64_t gamma, const SweepOptions& options,
             std::vector<SweepRow>& rows, Interrupter* interrupter) {
  const LeafIndex index = detail::topologyOf(manifold);
  std::optional<Hierarchy> hierarchy;  // one for all strictnesses
  const auto mergingOf = [&](const MergeOptions& how) {
    if (how.mode != MergeMode::score) return merge(graph, how);
    const auto& all = options.strictnesses;
    if (!hierarchy) hierarchy = mergeHierarchy(graph, *std::min_element(all.begin(), all.end()));
    Merging merging = cut(*hierarchy, how.strictness);
    if (how.minGrain > 0) merging = joinSmallGrains(graph, merging, how.minGrain);
    return merging;
  };
  const auto merged = [&](const MergeOptions& how) {
    GrainLabels grains = detail::labelGrains(manifold, index, graph, mergingOf(how), interrupter);
    const LabelFlaws flaws =
        detail::tidyAndCountFlaws(index, options.tidy, domain, grains, interrupter);
    return detail::SweptGrains{std::move(grains.voxels), flaws};
  };
  detail::addSweepRows(options, gamma, merged, rows);
}

}  // namespace

void detail::checkSweep(const SweepOptions& options) {
  if (options.gammas.empty() || options.modes.empty() || options.thetas.empty() ||
      options.deltas.empty() || options.strictnesses.empty())
    throw InvalidInput(
        "nothing to sweep: give at least one gamma, merge mode, strictness, theta and delta");
  for (const int64_t gamma : options.gammas)
    if (gamma < 0) throw InvalidInput("gamma is a number of voxels: it must not be negative");
  MergeOptions merge;
  merge.minGrain = options.minGrain;
  for (const double theta : options.thetas) {
    merge.theta = theta;
    checkMergeOptions(merge);
  }
  for (const int delta : options.deltas) {
    merge.delta = delta;
    checkMergeOptions(merge);
  }
  for (const double strictness : options.strictnesses) {
    merge.strictness = strictness;
    checkMergeOptions(merge);
  }
  checkTidy(options.tidy);
}

void detail::addSweepRows(const SweepOptions& options, int64_t gamma,
                          const std::function<SweptGrains(const MergeOptions& merge)>& merged,
                          std::vector<SweepRow>& rows) {
  const auto addRow = [&](SweepRow row) {
    row.gamma = gamma;
    SweptGrains grains = merged(
        {row.mode, row.strictness, row.theta, row.delta, options.adjacency, options.minGrain});
    row.flaws = grains.flaws;
    count(std::move(grains.voxels), options.smallVoxels, row);
    rows.push_back(row);
  };
  for (const MergeMode mode : options.modes) {
    SweepRow row;
    row.mode = mode;
    if (mode == MergeMode::score) {
      for (const double strictness : options.strictnesses) {
        row.strictness = strictness;
        addRow(row);
      }
      continue;
    }
    for (const int delta : options.deltas)
      for (const double theta : options.thetas) {
        if (mode == MergeMode::angle && delta != options.deltas.front()) {  // it has no delta
          rows.push_back(rows[rows.size() - options.thetas.size()]);
          rows.back().delta = delta;
          continue;
        }
        row.theta = theta;
        row.delta = delta;
        addRow(row);
      }
  }
}

std::vector<SweepRow> parameterSweep(const MaskGrid& object, const SweepOptions& options,
                                     Interrupter* interrupter) {
  detail::checkSweep(options);
  std::vector<SweepRow> rows;
  for (const int64_t gamma : options.gammas) {
    SegmentOptions segmentOptions;
    segmentOptions.gamma = gamma;
    segmentOptions.boundary = options.boundary;
    segmentOptions.domain = options.domain;
    segmentOptions.maxMemory = options.maxMemory;
    segmentOptions.fillHoles = options.fillHoles;
    segmentOptions.tidy = 0;
    segmentOptions.keepManifold = true;
    Segmentation segmentation = segment(object, segmentOptions, interrupter);
    segmentation.grain.reset();
    addRows(*segmentation.manifold, segmentation.graph, segmentation.domain, gamma, options, rows,
            interrupter);
  }
  return rows;
}

std::vector<SweepRow> mergingSweep(const Int32Grid& manifold, const SweepOptions& options,
                                   Interrupter* interrupter) {
  detail::checkSweep(options);
  const ManifoldGraph graph = requiredGraph(manifold);
  std::vector<SweepRow> rows;
  addRows(manifold, graph, storedDomain(manifold), options.gammas.front(), options, rows,
          interrupter);
  return rows;
}

}  // namespace vdb_madf
