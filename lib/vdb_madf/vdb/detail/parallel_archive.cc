// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/detail/parallel_archive.h"

#include <openvdb/io/Compression.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/GridDescriptor.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <streambuf>
#include <string>
#include <type_traits>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_values.h"

namespace vdb_madf::detail {

namespace {

namespace io = openvdb::io;
using openvdb::GridBase;

constexpr size_t kLeavesAtOnce = 256;

/// A string to write into.
class TextBuffer : public std::streambuf {
 public:
  std::string bytes;

 protected:
  std::streamsize xsputn(const char* from, std::streamsize count) override {
    bytes.append(from, size_t(count));
    return count;
  }
  int_type overflow(int_type character) override {
    if (!traits_type::eq_int_type(character, traits_type::eof()))
      bytes.push_back(traits_type::to_char_type(character));
    return traits_type::not_eof(character);
  }
};

/// The leaf buffers of a tree as a file has them.
struct LeafBuffers {
  std::vector<std::string> bytes;  ///< of kLeavesAtOnce leaf nodes each
  io::DelayedLoadMetadata sizes;
};

/// Bytes of a leaf node before the number and the bytes of its values, if its inactive values are
/// stored in this way.
template <typename Leaf>
size_t bytesBeforeValues(int8_t inactive) {
  constexpr size_t kMask = Leaf::SIZE / 8, kValue = sizeof(typename Leaf::ValueType);
  size_t bytes = kMask + 1;
  if (inactive == io::NO_MASK_AND_ONE_INACTIVE_VAL || inactive == io::MASK_AND_ONE_INACTIVE_VAL)
    bytes += kValue;
  if (inactive == io::MASK_AND_TWO_INACTIVE_VALS) bytes += 2 * kValue;
  if (inactive == io::MASK_AND_NO_INACTIVE_VALS || inactive == io::MASK_AND_ONE_INACTIVE_VAL ||
      inactive == io::MASK_AND_TWO_INACTIVE_VALS)
    bytes += kMask;
  return bytes;
}

/// What Leaf::writeBuffers() writes of labels, faster: false, and nothing, unless all inactive
/// values are the background.
bool writeLabels(const Int32Tree::LeafNodeType& leaf, int32_t background, std::ostream& stream) {
  LeafIndex::Mask active, inactive;
  for (openvdb::Index x = 0; x < 8; ++x) {
    active[x] = leaf.getValueMask().getWord<uint64_t>(x);
    inactive[x] = ~active[x];
  }
  const int32_t* dense = leaf.buffer().data();
  std::array<int32_t, Int32Tree::LeafNodeType::SIZE> values;
  const uint32_t count = countVoxels(active);
  packLeaf(inactive, dense, values.data());
  for (size_t i = 0; i < values.size() - count; ++i)
    if (values[i] != background) return false;
  packLeaf(active, dense, values.data());
  stream.write(reinterpret_cast<const char*>(active.data()), sizeof active);
  stream.put(char(io::NO_MASK_OR_INACTIVE_VALS));
  io::bloscToStream(stream, reinterpret_cast<const char*>(values.data()), sizeof(int32_t), count);
  return true;
}

template <typename Grid>
LeafBuffers leafBuffers(const Grid& grid, uint32_t compression, Interrupter* interrupter) {
  using Leaf = typename Grid::TreeType::LeafNodeType;
  const auto leaves = leavesOf(grid.tree());
  LeafBuffers buffers;
  buffers.bytes.resize((leaves.size() + kLeavesAtOnce - 1) / kLeavesAtOnce);
  buffers.sizes.resizeMask(leaves.size());
  buffers.sizes.resizeCompressedSize(leaves.size());
  const auto background = grid.tree().background();
  parallelForEach(buffers.bytes.size(), 1, interrupter, [&](size_t block) {
    TextBuffer buffer;
    std::ostream stream(&buffer);
    // Or a stream would keep to itself that there is no memory, and the file be short.
    stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
    io::setDataCompression(stream, compression);
    io::setGridBackgroundValuePtr(stream, &background);
    for (size_t i = block * kLeavesAtOnce; i < std::min(leaves.size(), (block + 1) * kLeavesAtOnce);
         ++i) {
      const size_t start = buffer.bytes.size();
      bool isWritten = false;
      if constexpr (std::is_same_v<Grid, Int32Grid>)
        isWritten = writeLabels(*leaves[i], background, stream);
      if (!isWritten) leaves[i]->writeBuffers(stream, grid.saveFloatAsHalf());
      const auto inactive = int8_t(buffer.bytes[start + Leaf::SIZE / 8]);
      buffers.sizes.setMask(i, inactive);
      buffers.sizes.setCompressedSize(
          i, int64_t(buffer.bytes.size() - start - bytesBeforeValues<Leaf>(inactive)));
    }
    buffers.bytes[block] = std::move(buffer.bytes);
  });
  return buffers;
}

}  // namespace

void ParallelArchive::writeAll(std::ostream& stream, const std::vector<GridBase::ConstPtr>& grids,
                               Interrupter* interrupter) const {
  io::setDataCompression(stream, compression());
  io::setWriteGridStatsMetadata(stream, isGridStatsMetadataEnabled());
  writeHeader(stream, /*seekable=*/true);
  openvdb::MetaMap().writeMeta(stream);
  const auto count = int32_t(grids.size());
  stream.write(reinterpret_cast<const char*>(&count), sizeof(count));

  std::map<std::string, int> sameName;
  for (const auto& grid : grids) ++sameName[grid->getName()];
  std::set<std::string> names;
  std::map<const openvdb::TreeBase*, io::GridDescriptor> written;  // of each tree the last
  for (size_t g = 0; g < grids.size(); ++g) {
    const GridBase& grid = *grids[g];
    // A grid without a name of its own gets a number.
    std::string name = grid.getName();
    if (name.empty() || sameName[name] > 1) name = io::GridDescriptor::addSuffix(name, 0);
    for (int n = 1; !names.insert(name).second; ++n)
      name = io::GridDescriptor::addSuffix(grid.getName(), n);
    io::GridDescriptor descriptor(name, grid.type(), grid.saveFloatAsHalf());
    const auto same = written.find(&grid.baseTree());
    if (same != written.end() && same->second.saveFloatAsHalf() == grid.saveFloatAsHalf()) {
      descriptor.setInstanceParentName(same->second.uniqueName());
      writeGridInstance(descriptor, grids[g], stream, /*seekable=*/true);
    } else {
      WorkPart part(interrupter, int(100 * g / grids.size()), int(100 * (g + 1) / grids.size()));
      writeOne(descriptor, grids[g], stream, &part);
      written[&grid.baseTree()] = descriptor;
    }
    io::setDataCompression(stream, compression());
  }
}

void ParallelArchive::writeOne(io::GridDescriptor& descriptor, const GridBase::ConstPtr& grid,
                               std::ostream& stream, Interrupter* interrupter) const {
  const bool isKnown = OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER <= 13 && hasBloscCompression();
  if (isKnown && grid->isType<Int32Grid>())
    writeAs<Int32Grid>(descriptor, *grid, stream, interrupter);
  else if (isKnown && grid->isType<FloatGrid>() && !grid->saveFloatAsHalf())
    writeAs<FloatGrid>(descriptor, *grid, stream, interrupter);
  else
    writeGrid(descriptor, grid, stream, /*seekable=*/true);
}

template <typename Grid>
void ParallelArchive::writeAs(io::GridDescriptor& descriptor, const GridBase& grid,
                              std::ostream& stream, Interrupter* interrupter) const {
  const LeafBuffers buffers =
      leafBuffers(static_cast<const Grid&>(grid), compression(), interrupter);
  descriptor.writeHeader(stream);
  const auto positions = stream.tellp();
  descriptor.writeStreamPos(stream);
  descriptor.setGridPos(stream.tellp());
  setGridCompression(stream, grid);
  const GridBase::Ptr described = openvdb::ConstPtrCast<GridBase>(grid.copyGrid());
  described->addStatsMetadata();
  described->insertMeta(GridBase::META_FILE_COMPRESSION,
                        openvdb::StringMetadata(io::compressionToString(compression())));
  described->insertMeta(GridBase::META_FILE_DELAYED_LOAD, buffers.sizes);
  described->writeMeta(stream);
  grid.writeTransform(stream);
  grid.writeTopology(stream);
  descriptor.setBlockPos(stream.tellp());
  for (const std::string& bytes : buffers.bytes)
    stream.write(bytes.data(), std::streamsize(bytes.size()));
  descriptor.setEndPos(stream.tellp());
  stream.seekp(positions);
  descriptor.writeStreamPos(stream);
  descriptor.seekToEnd(stream);
}

}  // namespace vdb_madf::detail
