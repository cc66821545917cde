// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/hexahedra.h"

#include <algorithm>
#include <string>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

using Mask = LeafIndex::Mask;

/// The corners of an element in the order of its nodes. Bits: 4: +x, 2: +y, 1: +z.
constexpr unsigned kCorners[8] = {0, 4, 6, 2, 1, 5, 7, 3};

/// Adds to a mask itself, moved by a voxel up an axis. Returns what falls into the next leaf.
Mask spread(Mask& mask, int axis) {
  Mask next{};
  for (size_t x = 8; x-- > 0;) {
    const uint64_t word = mask[x];
    if (axis == 0) {
      (x == 7 ? next[0] : mask[x + 1]) |= word;
    } else if (axis == 1) {
      next[x] = word >> 56;
      mask[x] |= word << 8;
    } else {
      next[x] = word >> 7 & detail::kFirstZ;
      mask[x] |= word << 1 & ~detail::kFirstZ;
    }
  }
  return next;
}

/// The corners of voxels: corner p is the point p - 1/2, shared by the voxels p - 1 to p.
LeafIndex cornersOf(const LeafIndex& voxels) {
  MaskGrid corners;
  auto accessor = corners.getAccessor();
  for (size_t leaf = 0; leaf < voxels.leafCount(); ++leaf) {
    std::array<Mask, 8> parts;  // of the leaf and those next to it, as in kCorners
    parts[0] = voxels.mask(leaf);
    parts[4] = spread(parts[0], 0);
    for (const size_t i : {0u, 4u}) parts[i + 2] = spread(parts[i], 1);
    for (const size_t i : {0u, 2u, 4u, 6u}) parts[i + 1] = spread(parts[i], 2);
    for (int i = 0; i < 8; ++i) {
      const Mask& part = parts[size_t(i)];
      if (std::all_of(part.begin(), part.end(), [](uint64_t word) { return word == 0; })) continue;
      const Coord step(i & 4 ? 8 : 0, i & 2 ? 8 : 0, i & 1 ? 8 : 0);
      auto& mask = accessor.touchLeaf(voxels.origin(leaf) + step)->getValueMask();
      for (openvdb::Index x = 0; x < 8; ++x) mask.getWord<openvdb::Index64>(x) |= part[x];
    }
  }
  return LeafIndex(corners);
}

void addElements(const detail::LabelLeaves& leaves, size_t leaf, std::vector<uint64_t>& elements) {
  for (const detail::LabelPart& part : leaves.parts(leaf))
    for (size_t x = 0; x < 8; ++x)
      detail::forEachBit(part.mask[x], [&](int bit) {
        elements.push_back(uint64_t(part.label) << 32 | voxelId(leaf, x, size_t(bit)));
      });
}

}  // namespace

Hexahedra::Hexahedra(const Int32Grid& labels, Interrupter* interrupter) {
  const detail::WorldTransform world = detail::worldTransform(labels.transform());
  origin_ = world.origin;
  edges_ = world.edges;
  const detail::LabelLeaves leaves(labels, interrupter);
  const LeafIndex& voxels = leaves.index();
  const auto count = size_t(voxels.voxelCount());
  if (count > kMaxHexahedra)
    throw InvalidInput("one element for each of " + std::to_string(count) +
                           " voxels is too much (at most " + std::to_string(kMaxHexahedra) +
                           "): make the labels smaller first",
                       Hint::smallerLabels);
  corners_ = cornersOf(voxels);
  around_.resize(voxels.leafCount());
  size_t corner = 0;
  for (size_t leaf = 0; leaf < around_.size(); ++leaf) {
    while (corners_.origin(corner) != voxels.origin(leaf)) ++corner;  // both sorted
    around_[leaf] = leavesFrom(uint32_t(corner));
    addElements(leaves, leaf, elements_);
  }
  detail::parallelSort(elements_.begin(), elements_.end());
  for (size_t i = 0; i < elements_.size(); ++i) counts_.grains += isFirst(i);
  counts_.elements = elements_.size();
  counts_.nodes = size_t(corners_.voxelCount());
}

std::array<uint32_t, 8> Hexahedra::nodes(size_t element) const {
  const auto id = VoxelId(elements_[element] & 0xffffffffu);
  std::array<uint32_t, 8> result;
  for (size_t i = 0; i < 8; ++i) {
    const Coord p(int(wordOf(id) + (kCorners[i] >> 2)),
                  int((bitOf(id) >> 3) + (kCorners[i] >> 1 & 1)),
                  int((bitOf(id) & 7) + (kCorners[i] & 1)));
    const uint32_t leaf =
        around_[leafOf(id)][size_t((p.x() >> 3) * 4 + (p.y() >> 3) * 2 + (p.z() >> 3))];
    result[i] = uint32_t(corners_.rank(voxelId(leaf, offsetOf(p))));
  }
  return result;
}

void Hexahedra::forEachNode(const std::function<void(const openvdb::Vec3d&)>& f) const {
  for (size_t leaf = 0; leaf < corners_.leafCount(); ++leaf)
    for (unsigned offset = 0; offset < 512; ++offset)
      if (corners_.mask(leaf)[offset >> 6] >> (offset & 63) & 1)
        f(origin_ +
          edges_ * (corners_.coord(voxelId(leaf, offset)).asVec3d() - openvdb::Vec3d(0.5)));
}

/// The leaf of corners and those above it, as in kCorners.
std::array<uint32_t, 8> Hexahedra::leavesFrom(uint32_t leaf) const {
  std::array<uint32_t, 8> result;
  for (unsigned i = 0; i < 8; ++i) {
    result[i] = leaf;
    for (unsigned axis = 0; axis < 3; ++axis)
      if (result[i] != LeafIndex::kNone && i >> (2 - axis) & 1)
        result[i] = corners_.neighbors(result[i])[2 * axis + 1];
  }
  return result;
}

}  // namespace vdb_madf
