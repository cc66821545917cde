// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/copy_image.h"

#include <algorithm>
#include <vector>

#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/detail/slabs.h"
#include "vdb_madf/images/open_image.h"

namespace vdb_madf {

void copyImage(const std::string& path, ImageReader& image, SampleType type,
               const std::optional<VoxelSize>& voxelSize, Interrupter* interrupter,
               const std::array<double, 3>& origin) {
  ImageInfo info = image.info();
  const SampleType from = info.type;
  info.type = type;
  if (voxelSize) info.voxelSize = voxelSize;
  const size_t slice = size_t(info.size.x) * info.size.y;
  const int depth = std::min(detail::kSlab, info.size.z);
  std::vector<char> in(slice * depth * sampleSize(from)), out(slice * depth * sampleSize(type));
  const auto writer = createImage(path, info, origin);
  detail::forEachSlab(0, info.size.z, interrupter, [&](int z, int count) {
    image.read(z, count, in.data());
    detail::withSampleType(from, [&](auto value) {
      detail::withSampleType(type, [&](auto sample) {
        detail::convertSamples(image.path(), reinterpret_cast<const decltype(value)*>(in.data()),
                               slice * count, type,
                               reinterpret_cast<decltype(sample)*>(out.data()));
      });
    });
    writer->write(count, out.data());
  });
  writer->finish();
}

}  // namespace vdb_madf
