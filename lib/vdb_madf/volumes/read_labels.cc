// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/read_labels.h"

#include <algorithm>
#include <vector>

#include "vdb_madf/grids/detail/grid_slabs.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/slabs.h"
#include "vdb_madf/scans/detail/image_grid.h"
#include "vdb_madf/volumes/detail/label_packer.h"

namespace vdb_madf {

Int32Grid::Ptr readLabels(ImageReader& image, Interrupter* interrupter,
                          const std::optional<CoordBBox>& box) {
  const ImageInfo& info = image.info();
  std::vector<char> samples(size_t(detail::sliceBytes(info)) *
                            size_t(std::min(detail::kSlab, info.size.z)));
  const auto grid = Int32Grid::create(0);
  const CoordBBox part = box.value_or(imageBox(info.size));
  detail::forEachSlab(part.min().z(), part.max().z() + 1, interrupter, [&](int z, int count) {
    image.read(z, count, samples.data());
    detail::packLabels(image.path(), samples.data(), info.type,
                       detail::slicesOf(imageBox(info.size), z, count), grid->tree());
  });
  detail::describeImageGrid(image, *grid);
  return grid;
}

}  // namespace vdb_madf
