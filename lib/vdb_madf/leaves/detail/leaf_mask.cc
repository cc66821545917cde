// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/leaf_mask.h"

#include <algorithm>

namespace vdb_madf::detail {

namespace {

/// A word and its neighbors along y and z.
uint64_t dilateWord(uint64_t w) {
  return w | (w & ~kLastZ) << 1 | (w & ~kFirstZ) >> 1 | w << 8 | w >> 8;
}

using Mask = LeafIndex::Mask;

constexpr uint64_t kInner = ~(kFirstY | kLastY | kFirstZ | kLastZ);
constexpr Mask kNotAtFaces{0, kInner, kInner, kInner, kInner, kInner, kInner, 0};

Mask alongZ(Mask mask) {
  for (uint64_t& w : mask) w |= (w & ~kLastZ) << 1 | (w & ~kFirstZ) >> 1;
  return mask;
}
Mask alongY(Mask mask) {
  for (uint64_t& w : mask) w |= w << 8 | w >> 8;
  return mask;
}
/// `some` and the neighbors of a mask along x.
Mask alongX(Mask some, const Mask& mask) {
  for (size_t x = 0; x < 8; ++x) {
    if (x > 0) some[x] |= mask[x - 1];
    if (x < 7) some[x] |= mask[x + 1];
  }
  return some;
}
Mask alongX(const Mask& mask) {
  return alongX(mask, mask);
}

}  // namespace

LeafIndex::Mask flood(LeafIndex::Mask seed, const LeafIndex::Mask& mask) {
  bool grown = true;
  const auto grow = [&](size_t x) {
    uint64_t next = dilateWord(seed[x]);
    if (x > 0) next |= seed[x - 1];
    if (x < 7) next |= seed[x + 1];
    next = dilateWord(next & mask[x]) & mask[x];
    grown = grown || next != seed[x];
    seed[x] = next;
  };
  while (grown && seed != mask) {  // to and fro, so that it grows far in either direction
    grown = false;
    for (size_t x = 0; x < 8; ++x) grow(x);
    for (size_t x = 8; x-- > 0;) grow(x);
  }
  return seed;
}

LeafIndex::Mask dilate(const LeafIndex::Mask& mask) {
  LeafIndex::Mask result;
  for (size_t x = 0; x < 8; ++x) result[x] = dilateWord(mask[x]);
  return alongX(result, mask);
}

LeafIndex::Mask erode(const LeafIndex::Mask& mask, uint64_t beyond) {
  const auto inner = [&](uint64_t row, uint64_t face) { return (row & ~face) | (beyond & face); };
  LeafIndex::Mask planes{};  // along y and z
  for (size_t x = 0; x < 8; ++x) {
    const uint64_t row = mask[x] & inner(mask[x] << 1, kFirstZ) & inner(mask[x] >> 1, kLastZ);
    planes[x] = row & inner(row << 8, kFirstY) & inner(row >> 8, kLastY);
  }
  LeafIndex::Mask deep;
  for (size_t x = 0; x < 8; ++x)
    deep[x] = planes[x] & (x > 0 ? planes[x - 1] : beyond) & (x < 7 ? planes[x + 1] : beyond);
  return deep;
}

int64_t countThin(const LeafIndex::Mask& mask) {
  const Mask outside = without(kFullMask, mask);
  const auto told = [&](const Mask& voxels) {
    return int64_t(countVoxels(both(without(mask, voxels), kNotAtFaces)));
  };
  const int64_t thin = told(dilate(without(kFullMask, dilate(outside))));
  const Mask y = alongY(outside), z = alongZ(outside);
  const Mask with18 = either(alongY(z), either(alongX(z), alongX(y)));
  const Mask deep = without(kFullMask, with18), deepest = erode(mask, ~uint64_t(0));
  const int64_t holed = told(either(dilate(deep), alongX(alongY(alongZ(deepest)))));
  return std::max(thin, holed * 55 / 100) * 512 / 216;
}

int64_t countSpecks(const LeafIndex::Mask& mask) {
  int64_t inside = 0;
  forEachPiece(mask, [&](const Mask& piece) { inside += both(piece, kNotAtFaces) == piece; });
  return inside * 512 / 216;
}

LeafIndex::Mask across(const LeafIndex::Mask& mask, size_t side) {
  LeafIndex::Mask result{};
  if (side == 0) result[7] = mask[0];
  if (side == 1) result[0] = mask[7];
  if (side < 2) return result;
  for (size_t x = 0; x < 8; ++x) {
    if (side == 2) result[x] = mask[x] << 56;
    if (side == 3) result[x] = mask[x] >> 56;
    if (side == 4) result[x] = (mask[x] & kFirstZ) << 7;
    if (side == 5) result[x] = (mask[x] & kLastZ) >> 7;
  }
  return result;
}

LeafIndex::Mask inBox(const Coord& origin, const CoordBBox& box) {
  LeafIndex::Mask result{};
  int first[3], last[3];
  for (int axis = 0; axis < 3; ++axis) {
    first[axis] = int(std::max<int64_t>(0, int64_t(box.min()[axis]) - origin[axis]));
    last[axis] = int(std::min<int64_t>(7, int64_t(box.max()[axis]) - origin[axis]));
    if (first[axis] > last[axis]) return result;
  }
  const uint64_t row = (uint64_t(2) << last[2]) - (uint64_t(1) << first[2]);
  uint64_t slice = 0;
  for (int y = first[1]; y <= last[1]; ++y) slice |= row << 8 * y;
  for (int x = first[0]; x <= last[0]; ++x) result[size_t(x)] = slice;
  return result;
}

LeafIndex::Mask insideMask(const Domain& domain, const Coord& origin) {
  if (domain.isBox()) {
    const CoordBBox& box = domain.box();
    return box.isInside(origin) && box.isInside(origin.offsetBy(7)) ? kFullMask
                                                                    : inBox(origin, box);
  }
  const MaskTree& tree = *domain.region();
  const MaskTree::LeafNodeType* const leaf = tree.probeConstLeaf(origin);
  if (leaf) return maskOf(*leaf);
  return tree.isValueOn(origin) ? kFullMask : LeafIndex::Mask{};
}

LeafIndex::Mask innerMask(const Domain& domain, const Coord& origin) {
  const LeafIndex::Mask inside = insideMask(domain, origin);
  LeafIndex::Mask inner = without(inside, dilate(without(kFullMask, inside)));
  for (size_t side = 0; side < 6; ++side) {
    const LeafIndex::Mask next = insideMask(domain, beside(origin, side));
    inner = without(inner, across(without(kFullMask, next), opposite(side)));
  }
  return inner;
}

}  // namespace vdb_madf::detail
