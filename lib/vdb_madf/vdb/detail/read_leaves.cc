// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/detail/read_leaves.h"

#include <openvdb/io/io.h>

#include <algorithm>
#include <stdexcept>
#include <streambuf>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

namespace {

namespace io = openvdb::io;

/// Blocks (of TreeExtent::kLeavesAtOnce leaf nodes) that are in memory together.
constexpr size_t kBlocksAtOnce = 64;

[[noreturn]] void wrongSize() {
  throw std::runtime_error("its voxels have the wrong size");
}

/// Bytes to read from.
class MemoryBuffer : public std::streambuf {
 public:
  MemoryBuffer(char* begin, char* end) { setg(begin, begin, end); }
  bool isAtEnd() const { return gptr() == egptr(); }
};

template <typename Grid>
void readLeavesOf(InputBuffer& file, std::istream& stream, const TreeExtent& extent, Grid& grid) {
  const auto leaves = leavesOf(grid.tree());
  const auto background = grid.tree().background();
  std::vector<int64_t> starts = extent.blocks;
  starts.push_back(extent.end);
  std::vector<char> bytes;
  for (size_t first = 0; first + 1 < starts.size(); first += kBlocksAtOnce) {
    const size_t last = std::min(first + kBlocksAtOnce, starts.size() - 1);
    bytes.resize(size_t(starts[last] - starts[first]));
    file.read(bytes.data(), int64_t(bytes.size()));
    parallelFor(last - first, 1, nullptr, [&](size_t begin, size_t end) {
      for (size_t block = first + begin; block < first + end; ++block) {
        MemoryBuffer buffer(bytes.data() + (starts[block] - starts[first]),
                            bytes.data() + (starts[block + 1] - starts[first]));
        std::istream values(&buffer);
        values.exceptions(std::ios_base::badbit | std::ios_base::failbit | std::ios_base::eofbit);
        io::setVersion(values, io::getLibraryVersion(stream), io::getFormatVersion(stream));
        io::setDataCompression(values, io::getDataCompression(stream));
        io::setGridBackgroundValuePtr(values, &background);
        const size_t next = std::min(leaves.size(), (block + 1) * TreeExtent::kLeavesAtOnce);
        for (size_t leaf = block * TreeExtent::kLeavesAtOnce; leaf < next; ++leaf)
          leaves[leaf]->readBuffers(values, grid.saveFloatAsHalf());
        if (!buffer.isAtEnd()) wrongSize();
      }
    });
  }
}

}  // namespace

void readLeaves(InputBuffer& file, std::istream& stream, const TreeExtent& extent,
                openvdb::GridBase& grid) {
  if (grid.isType<Int32Grid>())
    readLeavesOf(file, stream, extent, static_cast<Int32Grid&>(grid));
  else if (grid.isType<FloatGrid>())
    readLeavesOf(file, stream, extent, static_cast<FloatGrid&>(grid));
  else
    grid.readBuffers(stream);
  if (file.position() != extent.end) wrongSize();
}

}  // namespace vdb_madf::detail
