// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <openvdb/Metadata.h>

#include "vdb_madf/volumes/read_labels.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/volumes/detail/image_grid.h"

namespace vdb_madf {

namespace {

using Leaf = Int32Tree::LeafNodeType;
constexpr int kLeaf = 8;

/// The leaf at `origin` of a slab that begins at its z; null if it holds no label.
std::unique_ptr<Leaf> makeLeaf(const int32_t* slab, const Coord& size, const Coord& origin) {
  const Coord end = Coord::minComponent(size, origin.offsetBy(kLeaf));
  std::unique_ptr<Leaf> leaf;
  for (int z = origin.z(); z < end.z(); ++z) {
    for (int y = origin.y(); y < end.y(); ++y) {
      const int32_t* row = slab + (size_t(z - origin.z()) * size.y() + y) * size.x();
      for (int x = origin.x(); x < end.x(); ++x) {
        if (row[x] == 0) continue;
        if (!leaf) leaf = std::make_unique<Leaf>(origin, 0, false);
        leaf->setValueOn(Leaf::coordToOffset(Coord(x, y, z)), row[x]);
      }
    }
  }
  return leaf;
}

}  // namespace

Int32Grid::Ptr readLabels(ImageReader& image, Interrupter* interrupter) {
  const ImageInfo& info = image.info();
  const size_t slice = size_t(info.size.x) * info.size.y;
  const int depth = std::min(kLeaf, info.size.z);
  std::vector<char> samples(slice * depth * sampleSize(info.type));
  std::vector<int32_t> labels(slice * depth);
  std::vector<std::vector<std::unique_ptr<Leaf>>> rows((size_t(info.size.y) + kLeaf - 1) / kLeaf);

  const auto grid = Int32Grid::create(0);
  openvdb::tree::ValueAccessor<Int32Tree> accessor(grid->tree());
  for (int z = 0; z < info.size.z; z += kLeaf) {
    if (interrupter && interrupter->wasInterrupted(int(int64_t(z) * 100 / info.size.z)))
      throw Interrupted();
    const int count = std::min(kLeaf, info.size.z - z);
    image.read(z, count, samples.data());
    detail::withSampleType(info.type, [&](auto sample) {
      detail::convertSamples(image.path(),
                             reinterpret_cast<const decltype(sample)*>(samples.data()),
                             slice * count, SampleType::int32, labels.data());
    });
    detail::parallelFor(rows.size(), 1, nullptr, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row)
        for (int x = 0; x < info.size.x; x += kLeaf)
          if (auto leaf =
                  makeLeaf(labels.data(), toCoord(info.size), Coord(x, int(row) * kLeaf, z)))
            rows[row].push_back(std::move(leaf));
    });
    for (auto& row : rows) {
      for (auto& leaf : row) accessor.addLeaf(leaf.release());
      row.clear();
    }
  }
  detail::describeImageGrid(image, *grid);
  return grid;
}

}  // namespace vdb_madf
