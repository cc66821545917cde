// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/write_image.h"

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>
#include <type_traits>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/number_grids.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/volumes/image_box.h"

namespace vdb_madf {

namespace {

constexpr int kLeaf = 8;
constexpr size_t kPiecesPerChunk = 64;

/// One voxel per sample, x fastest: the values of a tree over `box`, eight slices at a time.
template <typename Tree>
class SlabReader {
 public:
  using Leaf = typename Tree::LeafNodeType;
  /// Bits are handed over as bytes.
  using Value = std::conditional_t<std::is_same_v<typename Tree::ValueType, bool>, uint8_t,
                                   typename Tree::ValueType>;

  SlabReader(const Tree& tree, const CoordBBox& box)
      : tree_(tree), box_(box), slabs_(size_t((box.max().z() >> 3) - (box.min().z() >> 3)) + 1) {
    std::vector<const Leaf*> leaves;
    leaves.reserve(tree.leafCount());
    tree.getNodes(leaves);
    for (const Leaf* leaf : leaves)
      if (leaf->getNodeBoundingBox().hasOverlap(box))
        slab(leaf->origin().z()).leaves.push_back(leaf);
    auto tile = tree.cbeginValueAll();
    tile.setMaxDepth(tile.getLeafDepth() - 1);
    for (; tile; ++tile) addTile(tile.getBoundingBox(), Value(*tile));
  }

  int slabCount() const { return int(slabs_.size()); }
  CoordBBox slabBox(int number) const {
    const int first = (box_.min().z() & ~7) + kLeaf * number;
    CoordBBox box = box_;
    box.min().z() = std::max(first, box_.min().z());
    box.max().z() = std::min(first + kLeaf - 1, box_.max().z());
    return box;
  }

  void read(int number, Value* samples) const {
    const CoordBBox box = slabBox(number);
    const Slab& content = slabs_[size_t(number)];
    std::fill(samples, samples + box.volume(), Value(tree_.background()));
    detail::parallelFor(content.tiles.size(), kPiecesPerChunk, nullptr,
                        [&](size_t begin, size_t end) {
                          for (size_t i = begin; i < end; ++i)
                            fillTile(content.tiles[i], box, samples);
                        });
    detail::parallelFor(content.leaves.size(), kPiecesPerChunk, nullptr,
                        [&](size_t begin, size_t end) {
                          for (size_t i = begin; i < end; ++i)
                            copyLeaf(*content.leaves[i], box, samples);
                        });
  }

 private:
  struct Tile {
    CoordBBox box;
    Value value;
  };
  struct Slab {
    std::vector<const Leaf*> leaves;
    std::vector<Tile> tiles;
  };

  Slab& slab(int z) { return slabs_[size_t((z >> 3) - (box_.min().z() >> 3))]; }

  void addTile(CoordBBox box, Value value) {
    box.intersect(box_);
    if (box.empty() || value == Value(tree_.background())) return;
    for (int z = box.min().z() & ~7; z <= box.max().z(); z += kLeaf)
      slab(z).tiles.push_back({box, value});
  }

  static size_t place(const CoordBBox& box, int x, int y, int z) {
    const Coord size = box.dim(), p = Coord(x, y, z) - box.min();
    return (size_t(p.z()) * size_t(size.y()) + size_t(p.y())) * size_t(size.x()) + size_t(p.x());
  }

  static void fillTile(const Tile& tile, const CoordBBox& box, Value* samples) {
    CoordBBox part = tile.box;
    part.intersect(box);
    for (int z = part.min().z(); z <= part.max().z(); ++z)
      for (int y = part.min().y(); y <= part.max().y(); ++y)
        std::fill_n(samples + place(box, part.min().x(), y, z), part.dim().x(), tile.value);
  }

  static void copyLeaf(const Leaf& leaf, const CoordBBox& box, Value* samples) {
    CoordBBox part = leaf.getNodeBoundingBox();
    part.intersect(box);
    for (int z = part.min().z(); z <= part.max().z(); ++z)
      for (int y = part.min().y(); y <= part.max().y(); ++y) {
        Value* to = samples + place(box, part.min().x(), y, z);
        openvdb::Index offset = Leaf::coordToOffset(Coord(part.min().x(), y, z));
        for (int x = part.min().x(); x <= part.max().x(); ++x, offset += kLeaf * kLeaf)
          *to++ = Value(leaf.getValue(offset));
      }
  }

  const Tree& tree_;
  CoordBBox box_;
  std::vector<Slab> slabs_;
};

struct Destination {
  std::string path;
  CoordBBox box;
  ImageInfo info;
  std::array<double, 3> origin;  ///< as createImage() takes it
};

template <typename Sample, typename Tree>
void writeAs(const Destination& to, const Tree& tree, Interrupter* interrupter) {
  const auto& [path, box, info, origin] = to;
  const SlabReader<Tree> reader(tree, box);
  using Value = typename SlabReader<Tree>::Value;
  const size_t slice = size_t(info.size.x) * size_t(info.size.y);
  std::vector<Value> values(slice * size_t(std::min(kLeaf, info.size.z)));
  std::vector<Sample> samples;
  const auto writer = createImage(path, info, origin);
  for (int number = 0; number < reader.slabCount(); ++number) {
    if (interrupter && interrupter->wasInterrupted(int(int64_t(number) * 100 / reader.slabCount())))
      throw Interrupted();
    reader.read(number, values.data());
    const int count = reader.slabBox(number).dim().z();
    if constexpr (std::is_same_v<Sample, Value>) {
      writer->write(count, values.data());
    } else {
      samples.resize(values.size());
      detail::convertSamples(path, values.data(), slice * size_t(count), info.type, samples.data());
      writer->write(count, samples.data());
    }
  }
  writer->finish();
}

template <typename Tree>
void writeTree(const Destination& to, const Tree& tree, Interrupter* interrupter) {
  detail::withSampleType(to.info.type,
                         [&](auto sample) { writeAs<decltype(sample)>(to, tree, interrupter); });
}

/// In mm; in voxels, where there is no voxel size.
std::array<double, 3> originOf(const openvdb::GridBase& grid, const Coord& first) {
  const auto size = storedVoxelSize(grid);
  const openvdb::Vec3d place =
      size ? (size->unit() == "um" ? 1e-3 : 1.0) * grid.indexToWorld(first) : first.asVec3d();
  return {place.x(), place.y(), place.z()};
}

}  // namespace

void writeImage(const std::string& path, const openvdb::GridBase& grid, const CoordBBox& box,
                SampleType type, Interrupter* interrupter) {
  if (box.empty()) throw InvalidInput(path + ": there is no box to write");
  ImageInfo info;
  info.size = toImageSize(box.dim());
  info.type = type;
  info.voxelSize = storedVoxelSize(grid);
  const Destination to{path, box, info, originOf(grid, box.min())};
  if (!grid.apply<detail::NumberGrids>(
          [&](const auto& numbers) { writeTree(to, numbers.tree(), interrupter); }))
    throw InvalidInput(path + ": grid '" + grid.getName() + "' of type " + grid.valueType() +
                       " cannot be an image: only " + detail::kNumberGrids + " can");
}

}  // namespace vdb_madf
