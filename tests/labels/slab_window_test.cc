// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// A window that moves up through labels in slabs.

#include "vdb_madf/labels/detail/slab_window.h"

#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/label_slabs.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::LeafLayers;
using detail::SlabWindow;

namespace {

LabelMap voxelsOf(const detail::LabelLeaves& leaves) {
  LabelMap result;
  for (size_t leaf = 0; leaf < leaves.index().leafCount(); ++leaf)
    for (int offset = 0; offset < 512; ++offset)
      if (leaves.index().mask(leaf)[size_t(offset) / 64] >> (offset % 64) & 1)
        result[leaves.index().origin(leaf) + Coord(offset >> 6, offset >> 3 & 7, offset & 7)] =
            leaves.label(leaf, offset);
  return result;
}

}  // namespace

TEST_CASE("slab_window: it has the layers that are asked for, and reads slabs when it needs them",
          "[slab_window]") {
  const LabelMap voxels = randomLabels(3, Coord(-7, 3, 0), 40, 6, 60);
  const std::vector<int> cuts{0, 8, 24, 40};
  LabelSlabs slabs = inSlabs(labelGrid(voxels), cuts);
  std::vector<size_t> read;
  slabs.read = [&read, from = slabs.read](size_t slab, Interrupter* interrupter) {
    read.push_back(slab);
    return from(slab, interrupter);
  };
  SlabWindow window(slabs);
  const auto requireLayers = [&](const LeafLayers& layers, const std::vector<size_t>& reads) {
    CAPTURE(layers.begin, layers.end);
    LabelMap expected;
    for (const auto& [p, label] : voxels)
      if (p.z() >= layers.begin && p.z() < layers.end) expected[p] = label;
    REQUIRE(expected.size() > 50);
    read.clear();
    CHECK(voxelsOf(window.leaves(layers, nullptr)) == expected);
    CHECK(read == reads);
  };
  requireLayers({0, 16}, {0, 1});
  requireLayers({8, 24}, {});  // slab 0 is forgotten, the others are there
  requireLayers({16, 32}, {2});
  requireLayers({0, 8}, {0});
  requireLayers({24, 40}, {});  // slabs 0 and 1 are forgotten
  requireLayers({0, 40}, {0, 1});
}

TEST_CASE("slab_window: labels beyond the cuts of their slab are refused", "[slab_window]") {
  LabelMap voxels;
  for (const int z : {2, 11, 20}) voxels[Coord(1, 1, z)] = 1;
  LabelSlabs slabs = inSlabs(labelGrid(voxels), {0, 8, 16, 24});
  for (const size_t wrong : {size_t(0), size_t(2)}) {
    CAPTURE(wrong);
    LabelSlabs others = slabs;
    others.read = [from = slabs.read, wrong](size_t slab, Interrupter* interrupter) {
      return from(slab == 1 ? wrong : slab, interrupter);
    };
    SlabWindow window(others);
    CHECK_THROWS_AS(window.leaves({8, 16}, nullptr), InvalidInput);
  }
}
