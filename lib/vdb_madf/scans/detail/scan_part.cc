// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/detail/scan_part.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/grids/detail/cut_to_domain.h"
#include "vdb_madf/grids/detail/mask_sets.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/slabs.h"
#include "vdb_madf/scans/image_box.h"

namespace vdb_madf::detail {

namespace {

Domain domainOf(const ScanPart& part, const ImageSize& size) {
  return part.domain.within(boxOf(part, size));
}

}  // namespace

CoordBBox boxOf(const ScanPart& part, const ImageSize& size) {
  return Domain(imageBox(size)).within(part.box).box();
}

namespace {

template <typename Grid>
int64_t cut(const ScanPart& part, Grid& grid) {
  auto& tree = grid.tree();
  if (part.box != CoordBBox::inf()) tree.clip(part.box);
  const auto before = tree.activeVoxelCount();
  cutToDomain(part.domain, grid);
  return int64_t(before - tree.activeVoxelCount());
}

}  // namespace

int64_t cutTo(const ScanPart& part, MaskGrid& mask) {
  const int64_t leftOut = cut(part, mask);
  detail::clearTilesOff(mask.tree());
  return leftOut;
}

int64_t cutTo(const ScanPart& part, Int32Grid& labels) {
  const int64_t leftOut = cut(part, labels);
  for (auto value = labels.beginValueOff(); value; ++value) value.setValue(0);
  return leftOut;
}

RowParts rowsOf(const ScanPart& part, const ImageSize& size) {
  using Parts = std::vector<std::pair<int, int>>;
  const Domain domain = domainOf(part, size);
  const CoordBBox box = domain.box();
  if (domain.isBox())
    return [box](int y, int z) {
      return box.isInside(Coord(box.min().x(), y, z)) ? Parts{{box.min().x(), box.max().x() + 1}}
                                                      : Parts{};
    };
  return [box, region = domain.region()](int y, int z) {
    Parts parts;
    if (!box.isInside(Coord(box.min().x(), y, z))) return parts;
    const openvdb::tree::ValueAccessor<const MaskTree, false> accessor(*region);
    for (Coord p(box.min().x() & ~7, y, z); p.x() <= box.max().x(); p.x() += 8) {
      const auto* const leaf = accessor.probeConstLeaf(p);
      const bool tile = !leaf && accessor.isValueOn(p);
      for (int x = p.x(); x < p.x() + 8; ++x) {
        if (!(leaf ? leaf->isValueOn(Coord(x, y, z)) : tile)) continue;
        if (parts.empty() || parts.back().second != x) parts.emplace_back(x, x);
        ++parts.back().second;
      }
    }
    return parts;
  };
}

Histogram histogramIn(const ScanPart& part, ImageReader& image, const PaddedImage& padding,
                      Interrupter* interrupter) {
  const ImageInfo& info = image.info();
  const CoordBBox box = domainOf(part, info.size).box();
  std::vector<char> samples(size_t(sliceBytes(info)) * size_t(std::min(kSlab, info.size.z)));
  CountedImage counted(image, rowsOf(part, info.size), &padding);
  forEachSlab(box.min().z(), box.max().z() + 1, interrupter,
              [&](int z, int count) { counted.read(z, count, samples.data()); });
  return counted.histogram();
}

}  // namespace vdb_madf::detail
