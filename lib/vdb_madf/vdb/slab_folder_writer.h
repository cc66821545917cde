// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// Writes a folder of slabs (slab_folder.h), which appears whole or not at all. The work is done in
/// `path`.part; without commit() that folder is removed with all that is in it.
class SlabFolderWriter {
 public:
  /// @param cuts slab s is cuts[s] <= z < cuts[s + 1]: multiples of 8, ascending
  /// @throw InvalidInput for other cuts; IoError if `path`.part is there or cannot be made, or if
  ///   something else than a folder of slabs is at `path`
  SlabFolderWriter(const std::string& path, std::vector<int> cuts);
  ~SlabFolderWriter();
  SlabFolderWriter(const SlabFolderWriter&) = delete;
  SlabFolderWriter& operator=(const SlabFolderWriter&) = delete;

  size_t slabCount() const { return cuts_.size() - 1; }
  /// The path of a file of the folder, as long as it is not committed.
  std::string file(const std::string& name) const;
  /// Writes a slab, of any order. The grids are the same ones in each: Bool, Mask or Int32, of one
  /// name, transform and metadata `madf_*`, with no active voxel beyond the cuts. @throw as
  /// writeVdb()
  void write(size_t slab, const std::vector<openvdb::GridBase::ConstPtr>& grids,
             Interrupter* interrupter = nullptr) const;
  /// Writes the index, and puts the folder in the place of `path`, once all slabs are written.
  /// @param about see writeSlabIndex()
  void commit(const std::string& about = "{}") const;

 private:
  std::string path_, part_;
  std::vector<int> cuts_;
};

// The steps of SlabFolderWriter, for those who make the folder themselves, such as several
// processes.

/// Writes the file of a slab, one of `count`, whose grids say which one it is.
void writeSlab(const std::string& folder, size_t slab, size_t count,
               const std::vector<openvdb::GridBase::ConstPtr>& grids,
               Interrupter* interrupter = nullptr);

/// Writes the index of a folder.
/// @param about a JSON object whose members follow what the index says of the slabs; members of the
///   names that this has (format, format_version, version, slabs, digest) are left out
/// @throw InvalidInput if `about` is no JSON object; IoError
void writeSlabIndex(const std::string& folder, const std::vector<int>& cuts,
                    const std::string& about = "{}");

/// Finds out before the work whether a folder of slabs can be written. A folder that
/// commitSlabFolder() of a killed run has put aside goes back to its path if none is there, else
/// away.
/// @throw IoError if something else is at the path, or a link, or if the folder holds other files
void checkSlabFolder(const std::string& path);

/// Puts the folder `made` in the place of `path`, and of the folder of slabs that is there.
/// @throw IoError
void commitSlabFolder(const std::string& made, const std::string& path);

}  // namespace vdb_madf
