// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/read_mask.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <type_traits>
#include <vector>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/byte_order.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/volumes/detail/image_grid.h"

namespace vdb_madf {

namespace {

using MaskLeaf = MaskTree::LeafNodeType;
constexpr int kLeaf = 8;
/// A chunk of the parallel loop packs at least this many samples.
constexpr size_t kSamplesPerChunk = size_t(1) << 16;

/// A Selection in the samples' own type: object is what lies in [low, high], or what does not.
template <typename T>
struct Interval {
  T low, high;
  bool inside;
};

/// The least T that is >= value; `empty` if there is none.
template <typename T>
T roundedUp(double value, bool& empty) {
  using Limits = std::numeric_limits<T>;
  if constexpr (std::is_integral_v<T>) {
    if (value <= double(Limits::lowest())) return Limits::lowest();
    if (!(value <= double(Limits::max()))) empty = true;
    return empty ? T(0) : T(std::ceil(value));
  } else {
    if (value > double(Limits::max())) return Limits::infinity();
    if (value < double(Limits::lowest()))
      return std::isinf(value) ? -Limits::infinity() : Limits::lowest();
    const T near = T(value);
    return double(near) < value ? std::nextafter(near, Limits::infinity()) : near;
  }
}

/// The largest T that is <= value.
template <typename T>
T roundedDown(double value, bool& empty) {
  using Limits = std::numeric_limits<T>;
  if constexpr (std::is_integral_v<T>) {
    if (value >= double(Limits::max())) return Limits::max();
    if (!(value >= double(Limits::lowest()))) empty = true;
    return empty ? T(0) : T(std::floor(value));
  } else {
    bool ignored = false;
    return -roundedUp<T>(-value, ignored);
  }
}

/// Non-zero is "not in [0, 0]". A comparison with NaN is false either way, as a Selection wants it.
template <typename T>
Interval<T> intervalOf(const Selection& selection) {
  if (selection.kind == Selection::Kind::nonZero) return {T(0), T(0), selection.invert};
  bool empty = !(selection.low <= selection.high);
  const T low = empty ? T(1) : roundedUp<T>(selection.low, empty);
  const T high = empty ? T(0) : roundedDown<T>(selection.high, empty);
  if (empty || low > high) return {T(1), T(0), !selection.invert};
  return {low, high, !selection.invert};
}

/// One byte, 0 or 1, per sample; plain comparisons that compilers turn into vector code.
template <typename T>
void mark(const T* samples, size_t count, const Interval<T>& object, uint8_t* marks) {
  const T low = object.low, high = object.high;
  if (object.inside)
    for (size_t i = 0; i < count; ++i)
      marks[i] = uint8_t((samples[i] >= low) & (samples[i] <= high));
  else
    for (size_t i = 0; i < count; ++i) marks[i] = uint8_t((samples[i] < low) | (samples[i] > high));
}

/// The bits of eight marks, each 0 or 1.
uint8_t packMarks(const uint8_t* marks) {
  uint64_t bytes;
  std::memcpy(&bytes, marks, sizeof bytes);
  return detail::packBits(bytes);
}

/// Transposes an 8 x 8 bit matrix: bit j of byte i becomes bit i of byte j. Swaps 1 x 1, then 2 x
/// 2, then 4 x 4 blocks across the diagonal.
uint64_t transposed(uint64_t m) {
  uint64_t swap = (m ^ m >> 7) & 0x00aa00aa00aa00aau;
  m ^= swap ^ swap << 7;
  swap = (m ^ m >> 14) & 0x0000cccc0000ccccu;
  m ^= swap ^ swap << 14;
  swap = (m ^ m >> 28) & 0x00000000f0f0f0f0u;
  return m ^ swap ^ swap << 28;
}

/// Turns slabs of up to eight slices into leaves.
class SlabPacker {
 public:
  SlabPacker(const Coord& size, SampleType type, const Selection& selection)
      : size_(size), type_(type), selection_(selection), rows_(leaves(size.y())) {}

  /// Packs `count` slices from z on and adds the leaves that hold object to the tree.
  void pack(const void* samples, int z, int count, MaskTree& tree) {
    detail::withSampleType(type_, [&](auto sample) {
      packAs(static_cast<const decltype(sample)*>(samples), z, count, tree);
    });
  }

 private:
  using LeafRow = std::vector<std::unique_ptr<MaskLeaf>>;

  static size_t leaves(int voxels) { return size_t(voxels + kLeaf - 1) / kLeaf; }

  template <typename T>
  void packAs(const T* samples, int z, int count, MaskTree& tree) {
    const Interval<T> object = intervalOf<T>(selection_);
    const size_t samplesPerRow = size_t(size_.x()) * size_t(kLeaf * count);
    detail::parallelFor(rows_.size(), 1 + kSamplesPerChunk / samplesPerRow, nullptr,
                        [&](size_t begin, size_t end) {
                          for (size_t row = begin; row < end; ++row)
                            packRow(samples, object, row, z, count);
                        });
    openvdb::tree::ValueAccessor<MaskTree> accessor(tree);
    for (LeafRow& row : rows_) {
      for (auto& leaf : row) accessor.addLeaf(leaf.release());
      row.clear();
    }
  }

  /// The leaves of eight rows of voxels. Samples come x fastest, bits of a leaf's word z fastest:
  /// so eight samples along x become a byte, eight such bytes along z one block that is transposed.
  template <typename T>
  void packRow(const T* samples, const Interval<T>& object, size_t row, int z, int count) {
    const size_t nx = size_t(size_.x()), columns = leaves(size_.x());
    const int y0 = int(row) * kLeaf, ny = std::min(kLeaf, size_.y() - y0);
    std::vector<uint8_t> marks(columns * kLeaf, 0);         // zero beyond the last sample
    std::vector<uint64_t> blocks(columns * size_t(ny), 0);  // [y][leaf], byte z, bit x
    auto* bytes = reinterpret_cast<uint8_t*>(blocks.data());
    for (int k = 0; k < count; ++k)
      for (int y = 0; y < ny; ++y) {
        mark(samples + (size_t(k) * size_t(size_.y()) + size_t(y0 + y)) * nx, nx, object,
             marks.data());
        for (size_t column = 0; column < columns; ++column)
          bytes[(size_t(y) * columns + column) * 8 + size_t(k)] = packMarks(&marks[column * kLeaf]);
      }
    for (size_t column = 0; column < columns; ++column)
      if (auto leaf = makeLeaf(&blocks[column], columns, ny, Coord(int(column) * kLeaf, y0, z)))
        rows_[row].push_back(std::move(leaf));
  }

  static std::unique_ptr<MaskLeaf> makeLeaf(const uint64_t* blocks, size_t stride, int ny,
                                            const Coord& origin) {
    uint64_t any = 0;
    for (int y = 0; y < ny; ++y) any |= blocks[size_t(y) * stride];
    if (any == 0) return nullptr;
    uint8_t bits[kLeaf][kLeaf] = {};  // [x][y], bit z: the words of the leaf
    for (int y = 0; y < ny; ++y) {
      const uint64_t block = transposed(blocks[size_t(y) * stride]);
      for (int x = 0; x < kLeaf; ++x) bits[x][y] = uint8_t(block >> (8 * x));
    }
    openvdb::util::NodeMask<3> mask;
    for (openvdb::Index x = 0; x < kLeaf; ++x)
      std::memcpy(&mask.getWord<openvdb::Index64>(x), bits[x], sizeof bits[x]);
    auto leaf = std::make_unique<MaskLeaf>(origin, false);
    leaf->setValueMask(mask);
    return leaf;
  }

  Coord size_;
  SampleType type_;
  Selection selection_;
  std::vector<LeafRow> rows_;
};

}  // namespace

MaskGrid::Ptr readMask(ImageReader& image, const Selection& selection, Interrupter* interrupter) {
  const ImageInfo& info = image.info();
  const auto grid = MaskGrid::create();
  const int slices = std::min(kLeaf, info.size.z);
  const size_t slabBytes = size_t(detail::sliceBytes(info)) * size_t(slices);
  const std::unique_ptr<char[]> slab(new (std::nothrow) char[slabBytes]);
  if (!slab)
    throw IoError(image.path() + ": its slices are too large: " + std::to_string(slabBytes) +
                  " bytes are needed for eight");
  SlabPacker packer(toCoord(info.size), info.type, selection);
  for (int z = 0; z < info.size.z; z += kLeaf) {
    if (interrupter && interrupter->wasInterrupted(int(int64_t(z) * 100 / info.size.z)))
      throw Interrupted();
    const int count = std::min(kLeaf, info.size.z - z);
    image.read(z, count, slab.get());
    packer.pack(slab.get(), z, count, grid->tree());
  }
  grid->setName("object");
  detail::describeImageGrid(image, *grid);
  return grid;
}

}  // namespace vdb_madf
