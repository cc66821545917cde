// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/vdb/slab_folder.h"

namespace vdb_madf {

/// Which grids of a file are read, and which are refused.
struct VdbReadOptions {
  /// Largest number of voxels that active tiles and leaves of one grid may hold, and the largest
  /// |coordinate|: a file beyond them is refused before its tiles are touched. (Voxels of a region
  /// do not count: its tiles stay tiles.)
  int64_t maxVoxels = int64_t(1) << 32;
  int maxCoordinate = kMaxImageSide;
  /// Says which grids to read. It is asked with each, which has its name, type, metadata and
  /// transform but an empty tree. Absent: all. The trees of the others are passed over unread, and
  /// what is wrong within them is not seen; a tree that a wanted grid shares with another is read,
  /// and so is the region that is its domain.
  std::function<bool(const openvdb::GridBase&)> wanted;
  /// Reads grids whatever the shape of their voxels. Otherwise a wanted grid is refused whose
  /// voxels are turned or sheared; their edges may differ from axis to axis.
  bool anyVoxelShape = false;
};

/// The volumes of a .vdb file in its order, read eagerly (no delayed loading) from a file that may
/// be damaged; point grids are left out. Formats 222 to 224. A grid whose domain is a region, which
/// the file holds in a Bool grid, has it again: storedDomain(). The structure of each grid is
/// checked before OpenVDB reads it; linked against OpenVDB before 11, a program also needs the
/// checked decompression of tools/ for files that may change while they are read.
/// A file of ours is verified (files/verified_files.h): its UUID is the digest of all its other
/// bytes. A file that another program has written again has another UUID, and is not.
/// A folder of slabs (slab_folder.h) is one such volume; its grids have to fit in memory together.
/// @throw IoError, one line that names the file, if it is missing, truncated, corrupt or not VDB,
///   has voxels that are turned or sheared, names a region that it does not hold, or is not what
///   its digest says; Interrupted.
std::vector<openvdb::GridBase::Ptr> readVdb(const std::string& path,
                                            const VdbReadOptions& options = {},
                                            Interrupter* interrupter = nullptr);

/// The volumes of one slab of a folder (slab_folder.h).
/// @throw as readVdb; IoError if the slab is not of this folder.
std::vector<openvdb::GridBase::Ptr> readVdbSlab(const SlabFolder& folder, size_t slab,
                                                const VdbReadOptions& options = {},
                                                Interrupter* interrupter = nullptr);

/// The volumes of a .vdb file, in its order, with empty trees: names, types, metadata, transforms
/// (no regions).
/// Trees are passed over as with VdbReadOptions::wanted, so that a large file is listed at once
/// (a file without offsets, such as a stream has, is walked through). Voxels may have any shape.
/// @param verified for those who do not read the voxels later: the whole file is verified
/// @throw as readVdb.
std::vector<openvdb::GridBase::Ptr> readVdbHeaders(const std::string& path,
                                                   Interrupter* interrupter = nullptr,
                                                   bool verified = false);

}  // namespace vdb_madf
