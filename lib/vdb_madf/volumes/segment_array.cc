// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/segment_array.h"

#include <fmt/core.h>

#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/volumes/dense_volume.h"

namespace vdb_madf {

ArraySegmentation segmentArray(const uint8_t* mask, const std::array<int64_t, 3>& size,
                               const ArrayOptions& options, Interrupter* interrupter) {
  for (const int64_t side : size)
    if (side < 1 || side > kMaxImageSide)
      throw InvalidInput(
          fmt::format("an array of {} x {} x {} voxels: each side has to be from 1 to {}", size[0],
                      size[1], size[2], kMaxImageSide));
  const DenseLayout layout{SampleType::uint8,
                           {Coord(0), Coord(int(size[0]) - 1, int(size[1]) - 1, int(size[2]) - 1)},
                           std::nullopt};
  SegmentOptions all;
  all.gamma = options.gamma;
  all.merge.strictness = options.strictness;
  Segmentation found =
      segment(*maskFromDense(mask, layout, {}, options.voxelSize, interrupter), all, interrupter);
  ArraySegmentation result;
  result.labels.resize(size_t(size[0]) * size_t(size[1]) * size_t(size[2]));
  DenseLayout out = layout;
  out.type = SampleType::int32;
  copyToDense(*found.grain, result.labels.data(), out, interrupter);
  result.grainVoxels = std::move(found.grainVoxels);
  return result;
}

}  // namespace vdb_madf
