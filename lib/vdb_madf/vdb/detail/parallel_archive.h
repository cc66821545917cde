// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/io/Archive.h>

#include <ostream>
#include <vector>

#include "vdb_madf/base/interrupter.h"

namespace vdb_madf::detail {

/// Writes the bytes that openvdb::io::File writes (but for the random UUID), in less time: OpenVDB
/// (10 to 13) compresses each leaf node twice, to learn sizes on all threads and to write on one;
/// here it is done once, on all threads.
///
/// What is relied on of the format, for Int32 and Float grids with Blosc; others, and half
/// floats, are OpenVDB's to write:
/// - A grid is its descriptor with three positions (of what follows, of the leaf buffers, of the
///   end), compression flags, metadata, transform, topology and leaf buffers, in this order.
/// - The metadata "file_delayed_load" comes before the leaf buffers, and has of each leaf node how
///   its inactive values are stored, and the bytes of its values with the 8 of their number before
///   them.
/// - Leaf nodes lie one after the other, in the order of the tree; each depends on nothing but
///   itself, the background and the flags.
///
/// Memory: the compressed leaf buffers of a grid.
class ParallelArchive : public openvdb::io::Archive {
 public:
  /// Writes a file with offsets, so that other programs need not read all grids to read one. Grids
  /// that share a tree do so in the file. The stream has to be seekable, and to throw if it fails.
  /// @throw Interrupted; what the stream throws.
  void writeAll(std::ostream& stream, const std::vector<openvdb::GridBase::ConstPtr>& grids,
                Interrupter* interrupter) const;

 private:
  void writeOne(openvdb::io::GridDescriptor& descriptor, const openvdb::GridBase::ConstPtr& grid,
                std::ostream& stream, Interrupter* interrupter) const;
  template <typename Grid>
  void writeAs(openvdb::io::GridDescriptor& descriptor, const openvdb::GridBase& grid,
               std::ostream& stream, Interrupter* interrupter) const;
};

}  // namespace vdb_madf::detail
