// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <istream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "vdb_madf/files/detail/file_buffer.h"

namespace vdb_madf::detail {

/// How a tree of the standard 5-4-3 shape stores its values.
struct TreeLayout {
  enum class Leaf { values, flags, mask };
  int64_t valueBytes = 0;
  int64_t halfBytes = 0;  ///< saved as half float; = valueBytes where that does not apply
  Leaf leaf = Leaf::values;
};

/// Absent: not a tree of fixed-size values (points), or unknown.
std::optional<TreeLayout> treeLayout(const std::string& gridType);

struct TreeSettings {
  TreeLayout layout;
  bool half = false;
  uint32_t compression = 0;  ///< openvdb::io::COMPRESS_*
  int64_t maxVoxels = 0;
  int64_t maxCoordinate = 0;
};

/// The places at which the parts of a stored tree end, and what it will take to load it.
struct TreeExtent {
  static constexpr size_t kLeavesAtOnce = 256;
  int64_t topologyEnd = 0, end = 0;  ///< positions in the file
  std::vector<int64_t> blocks;  ///< likewise, of the buffers of leaf nodes 0, kLeavesAtOnce, ...
  int64_t memoryBytes = 0;
};

/// The tree is larger than its reader wants it.
class BeyondLimits : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Walks over a tree in a file without building it: everything that OpenVDB's reader takes on
/// trust. `stream` reads from `file`, whose position is the start of the tree.
/// @throw std::runtime_error that says what is wrong; EarlyEnd; BeyondLimits.
TreeExtent checkTree(InputBuffer& file, std::istream& stream, const TreeSettings& settings);

}  // namespace vdb_madf::detail
