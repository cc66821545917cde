// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/segment_slabs.h"

#include <string>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/detail/segment_options.h"
#include "vdb_madf/slabs/detail/slab_flow.h"
#include "vdb_madf/slabs/detail/slab_labels.h"

namespace vdb_madf {

namespace {

void checkSlabOptions(const SlabObject& object, const SegmentOptions& options) {
  detail::checkSegmentOptions(options);
  if (options.gamma > 1)
    throw InvalidInput("the filter by cells (gamma) does not work in slabs yet: leave it out");
  if (options.keepDistance || options.keepPower || options.keepManifold || options.keepBalls)
    throw InvalidInput("slabs give labels alone: keep no other grids");
  const std::vector<int>& cuts = object.cuts;
  for (size_t i = 0; i < cuts.size(); ++i)
    if ((cuts[i] & 7) != 0 || (i > 0 && cuts[i] <= cuts[i - 1]))
      throw InvalidInput("slabs are cut at ascending multiples of 8 along z");
  for (size_t s = 1; s + 1 < object.slabCount(); ++s)
    if (cuts[s + 1] - cuts[s] < options.tidy)
      throw InvalidInput("interfaces are smoothed in " + std::to_string(options.tidy) +
                         " rounds: take slabs at least as many voxels high");
}

}  // namespace

SlabSegmentation segmentSlabs(const SlabObject& object, const SegmentOptions& options,
                              Scratch& scratch, const PutSlabLabels& put,
                              Interrupter* interrupter) {
  checkSlabOptions(object, options);
  SlabSegmentation result;
  result.domain = options.domain ? options.domain : storedDomain(*object.about);
  if (result.domain && !result.domain->isBox())
    throw InvalidInput("a region cannot be cut into slabs yet: take a box as domain");
  detail::SlabWork work{object, result.domain, options, scratch, interrupter};
  detail::SlabGraph graph = detail::flowInSlabs(work, result);
  SegmentCounts& counts = result.counts;
  counts.keptBalls = counts.medialBalls;
  counts.criticalPoints = graph.criticalPoints();
  const detail::SlabGrains grains(work, std::move(graph), result.weights);
  counts.grains = int64_t(grains.representatives().size());
  result.grainVoxels.assign(size_t(counts.grains), 0);
  detail::labelSlabs(work, grains, result, put);
  return result;
}

bool isSlabPut(const Scratch& scratch, size_t slab) {
  return scratch.has(detail::SlabWork::name("counts", slab));
}

}  // namespace vdb_madf
