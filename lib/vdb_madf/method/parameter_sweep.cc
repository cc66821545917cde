// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/parameter_sweep.h"

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/segment.h"

namespace vdb_madf {

namespace {

void check(const SweepOptions& options) {
  if (options.gammas.empty() || options.modes.empty() || options.thetas.empty())
    throw InvalidInput("nothing to sweep: give at least one gamma, one merge mode and one theta");
  for (const int64_t gamma : options.gammas)
    if (gamma < 0) throw InvalidInput("gamma is a number of voxels: it must not be negative");
  for (const double theta : options.thetas) checkMergeOptions({theta});
}

/// \p sizes ascending.
double median(const std::vector<int64_t>& sizes) {
  if (sizes.empty()) return 0;
  const size_t middle = sizes.size() / 2;
  return sizes.size() % 2 ? double(sizes[middle]) : 0.5 * double(sizes[middle - 1] + sizes[middle]);
}

void count(const ManifoldGraph& graph, const SweepOptions& options, SweepRow& row) {
  std::vector<int64_t> sizes =
      grainVoxels(graph, merge(graph, {row.theta, row.mode, options.adjacency}));
  std::sort(sizes.begin(), sizes.end());
  row.grains = int64_t(sizes.size());
  row.medianVoxels = median(sizes);
  row.largestVoxels = sizes.empty() ? 0 : sizes.back();
  for (const int64_t size : sizes) {
    row.objectVoxels += size;
    if (size >= options.smallVoxels) continue;
    ++row.smallGrains;
    row.smallVoxels += size;
  }
}

}  // namespace

std::vector<SweepRow> parameterSweep(const MaskGrid& object, const SweepOptions& options,
                                     Interrupter* interrupter) {
  check(options);
  std::vector<SweepRow> rows;
  for (const int64_t gamma : options.gammas) {
    SegmentOptions segmentOptions;
    segmentOptions.gamma = gamma;
    segmentOptions.boundary = options.boundary;
    segmentOptions.domain = options.domain;
    segmentOptions.maxMemory = options.maxMemory;
    const ManifoldGraph graph = segment(object, segmentOptions, interrupter).graph;

    const size_t first = rows.size();
    for (const MergeMode mode : options.modes)
      for (const double theta : options.thetas) {
        rows.emplace_back();
        rows.back().gamma = gamma;
        rows.back().mode = mode;
        rows.back().theta = theta;
      }
    detail::parallelFor(rows.size() - first, 1, interrupter, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) count(graph, options, rows[first + i]);
    });
  }
  return rows;
}

}  // namespace vdb_madf
