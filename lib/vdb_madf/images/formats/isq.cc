// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include <cmath>
#include <cstring>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/stored_samples.h"

namespace vdb_madf::detail {

namespace {

/// The file is made of blocks; the first is the header.
constexpr uint64_t kBlock = 512;
// Byte offsets of the header's 32-bit integers.
constexpr size_t kDataType = 16, kVoxels = 44, kMicrometres = 56, kDataOffset = 508;
constexpr int32_t kProjections = 9;

int32_t integerAt(const std::string& header, size_t offset) {
  int32_t value;
  std::memcpy(&value, &header[offset], sizeof value);
  return value;
}

/// Each side of the field of view is rounded to a micrometer: that alone makes no voxel unequal.
std::optional<VoxelSize> spacing(const std::string& path, const ImageSize& size,
                                 const std::string& header) {
  std::array<double, 3> edges;
  for (size_t axis = 0; axis < 3; ++axis) {
    const double side = integerAt(header, kMicrometres + 4 * axis);
    edges[axis] = side / size[int(axis)];
    if (std::abs(side - edges[0] * size[int(axis)]) <= 1) edges[axis] = edges[0];
  }
  return checkedVoxelSize(path, edges, unitsPerMetre("um"));
}

}  // namespace

bool isIsqHeader(const std::string& head) {
  return head.compare(0, 16, "CTDATA-HEADER_V1") == 0;
}

std::unique_ptr<ImageReader> openIsq(std::unique_ptr<InputFile> file) {
  const std::string path = file->path();
  const std::string header = file->head(kBlock);
  if (!isIsqHeader(header) || header.size() < kBlock)
    throw IoError(path + ": is not a whole ISQ file");
  if (integerAt(header, kDataType) == kProjections)
    throw IoError(path + ": holds projections, not a volume: reconstruct it first");
  ImageInfo info;
  info.format = "isq";
  info.type = SampleType::int16;
  info.size = checkedSize(path, {integerAt(header, kVoxels), integerAt(header, kVoxels + 4),
                                 integerAt(header, kVoxels + 8)});
  info.voxelSize = spacing(path, info.size, header);
  const int32_t blocks = integerAt(header, kDataOffset);
  if (blocks < 0)
    throw IoError(path + ": its samples begin at block " + std::to_string(blocks) +
                  ", which cannot be: the ISQ header is damaged");
  SampleLayout layout;
  layout.offset = (uint64_t(blocks) + 1) * kBlock;
  layout.maxPadding = kBlock - 1;
  return openSamples(path, info, std::move(file), layout);
}

}  // namespace vdb_madf::detail
