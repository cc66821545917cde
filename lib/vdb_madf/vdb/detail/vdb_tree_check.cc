// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/detail/vdb_tree_check.h"

#include <openvdb/io/Compression.h>

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>
#include <vector>

#include "vdb_madf/base/detail/bits.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Coord;

constexpr int kRootLog2 = 12, kUpperLog2 = 5, kLowerLog2 = 4, kLeafLog2 = 3;
constexpr int64_t kLeafValues = 512;

[[noreturn]] void damaged(const std::string& what) {
  throw std::runtime_error(what);
}

/// Words of a node's mask; bit i is value i.
using Mask = std::vector<uint64_t>;

class TreeCheck {
 public:
  TreeCheck(InputBuffer& file, std::istream& stream, const TreeSettings& settings)
      : file_(file), stream_(stream), settings_(settings) {}

  TreeExtent check() {
    checkTopology();
    extent_.topologyEnd = file_.position();
    checkBuffers();
    extent_.end = file_.position();
    return extent_;
  }

 private:
  bool boolean() const { return settings_.layout.leaf != TreeLayout::Leaf::values; }

  // --- topology: the root's table, then the nodes depth first

  void checkTopology() {
    if (file_.read<int32_t>() != 1) damaged("a tree has more than one buffer");
    checkValue();
    const auto tiles = file_.read<uint32_t>(), children = file_.read<uint32_t>();
    std::set<Coord> origins;
    for (uint32_t i = 0; i < tiles; ++i) {
      const Coord origin = readRootOrigin();
      checkValue();
      const auto active = file_.read<uint8_t>();
      if (active > 1) damaged("a tile is neither active nor inactive");
      if (active) addTile(origin, kRootLog2);
      if (!origins.insert(origin).second) damaged("a tile occurs twice");
    }
    Coord last = Coord::min();
    for (uint32_t i = 0; i < children; ++i) {
      const Coord origin = readRootOrigin();
      // OpenVDB reads the voxels in this order, whatever the order here.
      if (i > 0 && !(last < origin)) damaged("its nodes are out of order");
      if (!origins.insert(origin).second) damaged("a node occurs twice");
      checkInternal(origin, kUpperLog2, kRootLog2 - kUpperLog2);
      last = origin;
    }
  }

  Coord readRootOrigin() {
    Coord origin;
    for (int axis = 0; axis < 3; ++axis) origin[axis] = file_.read<int32_t>();
    constexpr int kWithin = (1 << kRootLog2) - 1;
    if (((origin[0] | origin[1] | origin[2]) & kWithin) != 0) damaged("a node is out of place");
    for (int axis = 0; axis < 3; ++axis) {
      if (origin[axis] > settings_.maxCoordinate ||
          int64_t(origin[axis]) + kWithin < -settings_.maxCoordinate)
        tooFar();
    }
    return origin;
  }

  /// An internal node of (2^log2)^3 entries of (2^entryLog2)^3 voxels each, and what is below it.
  void checkInternal(const Coord& origin, int log2, int entryLog2) {
    const int64_t count = int64_t(1) << 3 * log2;
    const Mask children = readMask(count), active = readMask(count);
    for (size_t i = 0; i < children.size(); ++i)
      if (children[i] & active[i]) damaged("an entry is both a node and an active tile");
    // Read for trial, since OpenVDB would lose the node when it finds the values damaged.
    checkValues(active, count, /*read=*/true);
    extent_.memoryBytes += count * (settings_.layout.valueBytes <= 8 ? 8 : 48);

    for (int64_t i = 0; i < count; ++i) {
      const uint64_t bit = uint64_t(1) << (i & 63);
      if (!((children[size_t(i >> 6)] | active[size_t(i >> 6)]) & bit)) continue;
      const int within = (1 << log2) - 1;
      const Coord entry =
          origin + Coord(int(i >> 2 * log2) << entryLog2, (int(i >> log2) & within) << entryLog2,
                         (int(i) & within) << entryLog2);
      if (active[size_t(i >> 6)] & bit) {
        addTile(entry, entryLog2);
      } else if (log2 == kUpperLog2) {
        checkInternal(entry, kLowerLog2, kLeafLog2);
      } else {
        checkLeaf(entry);
      }
    }
  }

  void checkLeaf(const Coord& origin) {
    std::array<uint64_t, 8> mask{};
    file_.read(mask.data(), sizeof(mask));
    addVoxels(kLeafValues);
    if (!inside(origin, kLeafLog2)) {
      for (int i = 0; i < kLeafValues; ++i) {
        const Coord voxel = origin + Coord(i >> 6, i >> 3 & 7, i & 7);
        if ((mask[size_t(i >> 6)] >> (i & 63) & 1) && !inside(voxel, 0)) tooFar();
      }
    }
    ++leaves_;
    if (boolean()) leafOrigins_.push_back(origin);
    // Node, its values, and what the allocator adds.
    extent_.memoryBytes += boolean() ? 160 : 128 + kLeafValues * settings_.layout.valueBytes;
  }

  // --- buffers: the voxels of the leaves, in the same order

  void checkBuffers() {
    Mask mask;
    for (int64_t leaf = 0; leaf < leaves_; ++leaf) {
      if (size_t(leaf) % TreeExtent::kLeavesAtOnce == 0) extent_.blocks.push_back(file_.position());
      if (!boolean()) {
        readMask(kLeafValues, mask);
        checkValues(mask, kLeafValues, /*read=*/false);
        continue;
      }
      file_.skip(kLeafValues / 8);
      Coord origin;
      for (int axis = 0; axis < 3; ++axis) origin[axis] = file_.read<int32_t>();
      if (origin != leafOrigins_[size_t(leaf)]) damaged("a leaf is out of place");
      if (settings_.layout.leaf == TreeLayout::Leaf::flags) file_.skip(kLeafValues / 8);
    }
  }

  // --- values

  Mask readMask(int64_t count) {
    Mask mask;
    readMask(count, mask);
    return mask;
  }
  void readMask(int64_t count, Mask& mask) {
    mask.resize(size_t(count / 64));
    file_.read(mask.data(), count / 8);
  }

  /// A single value, never compressed.
  void checkValue() {
    if (!boolean()) return file_.skip(settings_.layout.valueBytes);
    if (file_.read<uint8_t>() > 1) damaged("a value is neither true nor false");
  }

  /// A node's values: `count` of them, or only the active ones and how to restore the others.
  void checkValues(const Mask& active, int64_t count, bool read) {
    using namespace openvdb::io;
    const auto kind = file_.read<int8_t>();
    if (kind < NO_MASK_OR_INACTIVE_VALS || kind > NO_MASK_AND_ALL_VALS)
      damaged("a node is stored in an unknown way");
    if (kind == NO_MASK_AND_ONE_INACTIVE_VAL || kind == MASK_AND_ONE_INACTIVE_VAL ||
        kind == MASK_AND_TWO_INACTIVE_VALS)
      checkValue();
    if (kind == MASK_AND_TWO_INACTIVE_VALS) checkValue();
    if (kind == MASK_AND_NO_INACTIVE_VALS || kind == MASK_AND_ONE_INACTIVE_VAL ||
        kind == MASK_AND_TWO_INACTIVE_VALS)
      file_.skip(count / 8);

    const bool activeOnly =
        (settings_.compression & COMPRESS_ACTIVE_MASK) && kind != NO_MASK_AND_ALL_VALS;
    const int64_t stored = activeOnly ? countBitsIn(active) : count;
    const TreeLayout& layout = settings_.layout;
    const bool half = settings_.half && layout.halfBytes != layout.valueBytes;
    if (half && stored == 0) return;  // then not even an empty block is stored
    checkBlock(stored * (half ? layout.halfBytes : layout.valueBytes), read);
  }

  /// A block of values, perhaps compressed: behind its size, which is negative if compression did
  /// not pay.
  void checkBlock(int64_t bytes, bool read) {
    using namespace openvdb::io;
    const bool blosc = settings_.compression & COMPRESS_BLOSC;
    const bool zip = !blosc && (settings_.compression & COMPRESS_ZIP);
    const int64_t start = file_.position();
    if (blosc || zip) {
      const auto size = file_.read<int64_t>();
      if (size <= 0 ? size != -bytes : (blosc && !isBloscBlock(size, bytes)))
        damaged("a compressed block has the wrong size");
      file_.skip(size <= 0 ? bytes : size);
    } else {
      file_.skip(bytes);
    }
    if (!read) return;

    const int64_t end = file_.position();
    file_.moveTo(start);
    // Never empty: without a buffer these functions skip instead of reading.
    values_.resize(size_t(std::max<int64_t>(bytes, 1)));
    if (blosc) {
      bloscFromStream(stream_, values_.data(), size_t(bytes));
    } else if (zip) {
      unzipFromStream(stream_, values_.data(), size_t(bytes));
    } else {
      file_.read(values_.data(), bytes);
    }
    if (file_.position() != end) damaged("a compressed block has the wrong size");
    if (boolean() && std::any_of(values_.begin(), values_.begin() + bytes,
                                 [](char value) { return (value & ~1) != 0; }))
      damaged("a value is neither true nor false");
  }

  /// True if the header of the block agrees with its size in the file and with what is expected.
  bool isBloscBlock(int64_t size, int64_t bytes) {
    constexpr int64_t kHeader = 16;
    if (size < kHeader) return false;
    file_.require(size);
    const int64_t start = file_.position();
    file_.skip(4);  // versions, flags, size of a value
    const int64_t unpacked = file_.read<uint32_t>();
    file_.skip(4);  // size of a sub-block
    const int64_t packed = file_.read<uint32_t>();
    file_.moveTo(start);
    return unpacked == bytes && packed == size;
  }

  // --- limits

  bool inside(const Coord& origin, int log2) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (origin[axis] < -settings_.maxCoordinate ||
          int64_t(origin[axis]) + (1 << log2) - 1 > settings_.maxCoordinate)
        return false;
    }
    return true;
  }

  void addTile(const Coord& origin, int log2) {
    if (!inside(origin, log2)) tooFar();
    addVoxels(int64_t(1) << 3 * log2);
  }

  void addVoxels(int64_t count) {
    if (count > settings_.maxVoxels - voxels_)
      throw BeyondLimits("a grid has more than " + std::to_string(settings_.maxVoxels) + " voxels");
    voxels_ += count;
  }

  [[noreturn]] void tooFar() const {
    throw BeyondLimits("a grid reaches beyond coordinate " +
                       std::to_string(settings_.maxCoordinate));
  }

  InputBuffer& file_;
  std::istream& stream_;
  const TreeSettings& settings_;
  TreeExtent extent_;
  int64_t voxels_ = 0;
  int64_t leaves_ = 0;
  std::vector<Coord> leafOrigins_;  ///< where the file repeats them
  std::vector<char> values_;
};

}  // namespace

std::optional<TreeLayout> treeLayout(const std::string& gridType) {
  using Leaf = TreeLayout::Leaf;
  struct Known {
    const char* type;
    TreeLayout layout;
  };
  static const Known known[] = {
      {"Tree_bool_5_4_3", {1, 1, Leaf::flags}},     {"Tree_mask_5_4_3", {1, 1, Leaf::mask}},
      {"Tree_int32_5_4_3", {4, 4, Leaf::values}},   {"Tree_int64_5_4_3", {8, 8, Leaf::values}},
      {"Tree_float_5_4_3", {4, 2, Leaf::values}},   {"Tree_double_5_4_3", {8, 2, Leaf::values}},
      {"Tree_vec3s_5_4_3", {12, 6, Leaf::values}},  {"Tree_vec3d_5_4_3", {24, 6, Leaf::values}},
      {"Tree_vec3i_5_4_3", {12, 12, Leaf::values}},
  };
  for (const Known& candidate : known)
    if (gridType == candidate.type) return candidate.layout;
  return std::nullopt;
}

TreeExtent checkTree(InputBuffer& file, std::istream& stream, const TreeSettings& settings) {
  return TreeCheck(file, stream, settings).check();
}

}  // namespace vdb_madf::detail
