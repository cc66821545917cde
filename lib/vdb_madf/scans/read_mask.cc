// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/read_mask.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <new>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/grid_slabs.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/slabs.h"
#include "vdb_madf/scans/detail/image_grid.h"
#include "vdb_madf/scans/detail/mask_packer.h"

namespace vdb_madf {

std::vector<MaskGrid::Ptr> readMasks(ImageReader& image, const std::vector<Selection>& selections,
                                     Interrupter* interrupter, const std::optional<CoordBBox>& box,
                                     const LayerRead& layerRead) {
  const ImageInfo& info = image.info();
  std::vector<MaskGrid::Ptr> grids;
  for (size_t i = 0; i < selections.size(); ++i) grids.push_back(MaskGrid::create());
  const int slices = std::min(detail::kSlab, info.size.z);
  const size_t slabBytes = size_t(detail::sliceBytes(info)) * size_t(slices);
  const std::unique_ptr<char[]> samples(new (std::nothrow) char[slabBytes]);
  if (!samples)
    throw IoError(fmt::format("{}: its slices are too large: {} bytes are needed for eight",
                              image.path(), slabBytes));
  const CoordBBox part = box.value_or(imageBox(info.size));
  detail::forEachSlab(part.min().z(), part.max().z() + 1, interrupter, [&](int z, int count) {
    image.read(z, count, samples.get());
    for (size_t i = 0; i < selections.size(); ++i)
      detail::packMask(samples.get(), info.type, detail::slicesOf(imageBox(info.size), z, count),
                       selections[i], grids[i]->tree());
    if (layerRead) layerRead(grids);
  });
  for (const MaskGrid::Ptr& grid : grids) {
    if (part != imageBox(info.size)) grid->tree().clip(part);
    grid->setName("object");
    detail::describeImageGrid(image, *grid);
  }
  return grids;
}

MaskGrid::Ptr readMask(ImageReader& image, const Selection& selection, Interrupter* interrupter) {
  return readMasks(image, {selection}, interrupter)[0];
}

}  // namespace vdb_madf
