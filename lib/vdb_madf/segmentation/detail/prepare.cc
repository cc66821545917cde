// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/detail/prepare.h"

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/cavities.h"

namespace vdb_madf::detail {

void checkSegmentOptions(const SegmentOptions& options) {
  if (options.gamma < 0) throw InvalidInput("gamma is a number of voxels: it must not be negative");
  if (options.fillHoles.value_or(0) < 0)
    throw InvalidInput("cavities are filled below a number of voxels: it must not be negative");
  checkTidy(options.tidy);
  checkMergeOptions(options.merge);
  if (options.autoStrictness && options.merge.mode != MergeMode::score)
    throw InvalidInput("autoStrictness belongs to MergeMode::score");
}

Obstacles prepare(const MaskGrid& about, const SegmentOptions& options,
                  SegmentationRecord& record) {
  checkSegmentOptions(options);
  if (!options.weights) voxelEdges(about.transform());  // it throws
  record.domain = options.domain ? options.domain : storedDomain(about);
  record.fillHoles = options.fillHoles.value_or(defaultFillHoles(record.domain));
  record.tidy = options.tidy;
  const Obstacles obstacles = resolveBoundary(LeafIndex(), options.boundary, record.domain);
  record.open = obstacles.open;
  return obstacles;
}

void chooseWeights(const MaskGrid& about, const SegmentOptions& options, const Obstacles& obstacles,
                   const CoordBBox& body, SegmentationRecord& record) {
  // Across a region the nearest background may lie anywhere.
  const Coord extent = (obstacles.inRegion() ? obstacles.domain.box() : body).dim();
  WeightsOfEdges chosen;
  if (options.weights) {
    checkWeights(*options.weights, extent);
    chosen.weights = *options.weights;
  } else {
    chosen = weightsOfEdges(voxelEdges(about.transform()), extent);
  }
  record.weights = chosen.weights;
  record.weightsError = chosen.error;
}

}  // namespace vdb_madf::detail
