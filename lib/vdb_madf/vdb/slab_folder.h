// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

// A folder of slabs: a volume that was cut along z into files slab-0000.vdb, slab-0001.vdb ..., which
// have one transform and no leaf node in common. Each opens alone. The file index.json says what they
// are; it is written last, so that a folder without it is none.

constexpr char kSlabIndex[] = "index.json";

/// "slab-0012.vdb"
std::string slabFileName(size_t slab);

/// Tells a grid which slab it is, of how many: metadata `madf_slab` (from 0) and `madf_slabs` (int64).
void markSlab(openvdb::GridBase& grid, size_t slab, size_t count);

/// Is this a folder of slabs, be it a damaged one?
bool isSlabFolder(const std::string& path);

/// What the index of a folder says.
struct SlabFolder {
  std::vector<std::string> files;  ///< paths of its slabs, from the lowest on
  std::vector<int> cuts;           ///< slab s is cuts[s] <= z < cuts[s + 1]: multiples of 8

  size_t slabCount() const { return files.size(); }
};

/// @throw IoError, one line, if the index is missing or damaged, or a slab is missing
SlabFolder openSlabFolder(const std::string& path);

/// Before the work. A folder that commitSlabFolder() of a killed run has put aside goes back to its path
/// if none is there, else away. @throw IoError if something else is at the path of a folder that is to be
/// written
void checkSlabFolder(const std::string& path);

/// Puts the folder `made` in the place of `path`, and of the folder of slabs that is there.
/// @throw IoError
void commitSlabFolder(const std::string& made, const std::string& path);

/// Checks the grids of the file of a slab, which are all that it holds, against those of slab 0, whose
/// voxels do not matter, and takes away their marks.
/// @throw IoError, one line, if they are of another slab or of other labels, or reach beyond the cuts
void checkSlab(const std::vector<openvdb::GridBase::Ptr>& grids, const SlabFolder& folder,
               size_t slab, const std::vector<openvdb::GridBase::Ptr>& lowest);

/// Adds to the grids of the slabs below those of the next one, which it empties. Both were checked.
/// @throw IoError, one line, if they are of types that cannot be put together
void addSlab(const std::vector<openvdb::GridBase::Ptr>& grids,
             const std::vector<openvdb::GridBase::Ptr>& next, const std::string& path);

}  // namespace vdb_madf
