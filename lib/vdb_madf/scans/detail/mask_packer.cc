// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/detail/mask_packer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

using MaskLeaf = MaskTree::LeafNodeType;
/// A chunk of the parallel loop packs at least this many samples.
constexpr size_t kSamplesPerChunk = size_t(1) << 16;

/// Part of a Selection in the samples' own type: what lies in [low, high], or what does not.
template <typename T>
struct Interval {
  T low, high;
  bool inside;
};

/// Object is what lies in one of the intervals, or what lies in none; all are of one kind.
template <typename T>
using Intervals = std::vector<Interval<T>>;

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

template <typename T>
Intervals<T> intervalsOf(const Selection& selection) {
  Intervals<T> intervals{intervalOf<T>(selection)};
  for (const double value : selection.more)
    intervals.push_back(intervalOf<T>({selection.kind, value, value, selection.invert}));
  return intervals;
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

/// `scratch`: of the same length as the marks, where there are several intervals.
template <typename T>
void mark(const T* samples, size_t count, const Intervals<T>& object, uint8_t* scratch,
          uint8_t* marks) {
  mark(samples, count, object[0], marks);
  for (size_t i = 1; i < object.size(); ++i) {
    mark(samples, count, object[i], scratch);
    if (object[i].inside)
      for (size_t j = 0; j < count; ++j) marks[j] |= scratch[j];
    else
      for (size_t j = 0; j < count; ++j) marks[j] &= scratch[j];
  }
}

/// The bits of eight marks, each 0 or 1.
uint8_t packMarks(const uint8_t* marks) {
  uint64_t bytes;
  std::memcpy(&bytes, marks, sizeof bytes);
  return packBits(bytes);
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

std::unique_ptr<MaskLeaf> makeLeaf(const uint64_t* blocks, size_t stride, const Coord& origin) {
  uint64_t any = 0;
  for (int y = 0; y < kLeafSide; ++y) any |= blocks[size_t(y) * stride];
  if (any == 0) return nullptr;
  uint8_t bits[kLeafSide][kLeafSide];  // [x][y], bit z: the words of the leaf
  for (int y = 0; y < kLeafSide; ++y) {
    const uint64_t block = transposed(blocks[size_t(y) * stride]);
    for (int x = 0; x < kLeafSide; ++x) bits[x][y] = uint8_t(block >> (8 * x));
  }
  openvdb::util::NodeMask<3> mask;
  for (openvdb::Index x = 0; x < kLeafSide; ++x)
    std::memcpy(&mask.getWord<openvdb::Index64>(x), bits[x], sizeof bits[x]);
  auto leaf = std::make_unique<MaskLeaf>(origin, false);
  leaf->setValueMask(mask);
  return leaf;
}

using LeafRow = std::vector<std::unique_ptr<MaskLeaf>>;

size_t leavesAlong(const CoordBBox& slab, int axis) {
  return size_t((slab.max()[axis] >> 3) - (slab.min()[axis] >> 3)) + 1;
}

/// The leaves of eight rows of voxels, from y0 on. Samples come x fastest, bits of a leaf's word z
/// fastest: so eight samples along x become a byte, eight such bytes along z one block that is
/// transposed.
template <typename T>
LeafRow packRow(const T* samples, const CoordBBox& slab, const Intervals<T>& object, int y0) {
  const Coord size = slab.dim(), first = slab.min() & ~(kLeafSide - 1);
  const size_t nx = size_t(size.x()), columns = leavesAlong(slab, 0);
  std::vector<uint8_t> marks(columns * kLeafSide, 0);            // zero beyond the samples
  std::vector<uint64_t> blocks(columns * size_t(kLeafSide), 0);  // [y][leaf], byte z, bit x
  std::vector<uint8_t> scratch(object.size() > 1 ? nx : 0);
  auto* bytes = reinterpret_cast<uint8_t*>(blocks.data());
  const int yBegin = std::max(y0, slab.min().y()),
            yEnd = std::min(y0 + kLeafSide - 1, slab.max().y());
  for (int z = slab.min().z(); z <= slab.max().z(); ++z)
    for (int y = yBegin; y <= yEnd; ++y) {
      const size_t row = size_t(z - slab.min().z()) * size_t(size.y()) + size_t(y - slab.min().y());
      mark(samples + row * nx, nx, object, scratch.data(),
           &marks[size_t(slab.min().x() - first.x())]);
      for (size_t column = 0; column < columns; ++column)
        bytes[(size_t(y - y0) * columns + column) * 8 + size_t(z - first.z())] =
            packMarks(&marks[column * kLeafSide]);
    }
  LeafRow leaves;
  for (size_t column = 0; column < columns; ++column)
    if (auto leaf = makeLeaf(&blocks[column], columns,
                             Coord(first.x() + int(column) * kLeafSide, y0, first.z())))
      leaves.push_back(std::move(leaf));
  return leaves;
}

template <typename T>
void packAs(const T* samples, const CoordBBox& slab, const Selection& selection, MaskTree& tree) {
  const Intervals<T> object =
      intervalsOf<T>(std::is_same_v<T, float> ? selection.ofFloats() : selection);
  const size_t samplesPerRow = size_t(slab.dim().x()) * size_t(kLeafSide * slab.dim().z());
  std::vector<LeafRow> rows(leavesAlong(slab, 1));
  parallelForEach(rows.size(), 1 + kSamplesPerChunk / samplesPerRow, nullptr, [&](size_t row) {
    rows[row] =
        packRow(samples, slab, object, (slab.min().y() & ~(kLeafSide - 1)) + int(row) * kLeafSide);
  });
  openvdb::tree::ValueAccessor<MaskTree> accessor(tree);
  for (LeafRow& row : rows)
    for (auto& leaf : row) accessor.addLeaf(leaf.release());
}

}  // namespace

void packMask(const void* samples, SampleType type, const CoordBBox& slab,
              const Selection& selection, MaskTree& tree) {
  withSampleType(type, [&](auto sample) {
    packAs(static_cast<const decltype(sample)*>(samples), slab, selection, tree);
  });
}

}  // namespace vdb_madf::detail
