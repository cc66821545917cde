// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/label_masks.h"

#include <random>

#include "support/catch.h"
#include "support/random_case.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::LabelMasks;

namespace {

/// All entries against the labels of voxels, which lie in an array.
void requireSameMasks(const LabelMasks& masks, const LeafIndex& index,
                      const VoxelArray<uint32_t>& labels) {
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    uint32_t before = 0;
    for (auto entry = masks.begin(leaf); entry != masks.end(leaf); ++entry) {
      REQUIRE(entry->label > before);
      before = entry->label;
    }
    for (uint32_t offset = 0; offset < 512; ++offset) {
      const VoxelId id = VoxelId(leaf) * 512 + offset;
      const bool isObject = detail::holds(index.mask(leaf), offset);
      const uint32_t label = isObject ? labels[index.rank(id)] : 0;
      uint32_t found = 0;
      for (auto entry = masks.begin(leaf); entry != masks.end(leaf); ++entry)
        if (detail::holds(entry->mask, offset)) {
          REQUIRE(found == 0);
          found = entry->label;
        }
      REQUIRE(found == label);
    }
  }
}

}  // namespace

TEST_CASE("label_masks: each voxel under its label, also after changes", "[label_masks]") {
  size_t changes = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    const RandomCase c = randomCase(seed, Coord(17, 20, 18));
    INFO(describe(c));
    const LeafIndex index(*toMask(c.object, c.tiles));
    std::mt19937_64 random{seed};
    const uint32_t count = seed % 3 == 0 ? 600 : 1 + uint32_t(seed) % 4;  // 0: none
    VoxelArray<uint32_t> labels(size_t(index.voxelCount()));
    for (size_t i = 0; i < labels.size(); ++i)
      labels[i] = seed % 5 == 0 ? 7 : uint32_t(random() % (count + 1));
    LabelMasks masks(index, labels);
    requireSameMasks(masks, index, labels);

    for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
      for (int i = 0; i < 10; ++i) {
        const uint32_t label = uint32_t(1 + random() % (count + 10));
        LeafIndex::Mask voxels;
        for (size_t x = 0; x < 8; ++x) voxels[x] = index.mask(leaf)[x] & random() & random();
        masks.give(leaf, label, voxels);
        for (uint32_t offset = 0; offset < 512; ++offset)
          if (detail::holds(voxels, offset)) {
            labels[index.rank(VoxelId(leaf) * 512 + offset)] = label;
            ++changes;
          }
      }
    requireSameMasks(masks, index, labels);
  }
  CHECK(changes > 1000);
}
