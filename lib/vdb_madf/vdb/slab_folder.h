// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

// A folder of slabs: a volume that was cut along z into files slab-0000.vdb, slab-0001.vdb ...,
// which have one transform and no leaf node in common. Each opens alone. The file index.json says
// what they are; it is written last, so that a folder without it is none. SlabFolderWriter makes
// such folders.

constexpr char kSlabIndex[] = "index.json";

/// "slab-0012.vdb"
std::string slabFileName(size_t slab);

/// Metadata (int64) of the grids of a slab: which one it is (from 0), of how many.
constexpr char kSlabKey[] = "madf_slab";
constexpr char kSlabsKey[] = "madf_slabs";

/// True if there is an index that says so: the folder is whole.
bool hasSlabIndex(const std::string& path);

/// True if this is a folder of slabs, be it a damaged one.
bool isSlabFolder(const std::string& path);

/// What the index of a folder says.
struct SlabFolder {
  std::vector<std::string> files;  ///< paths of its slabs, from the lowest on
  std::vector<int> cuts;           ///< slab s is cuts[s] <= z < cuts[s + 1]: multiples of 8

  size_t slabCount() const { return files.size(); }
};

/// Reads the index. @throw IoError, one line, if it is missing or damaged, or a slab is missing
SlabFolder openSlabFolder(const std::string& path);

/// Checks the grids of the file of a slab, which are all that it holds, against those of slab 0,
/// whose voxels do not matter, and takes away their marks.
/// @throw IoError, one line, if they are of another slab or of other labels, or reach beyond the
///   cuts
void checkSlab(const std::vector<openvdb::GridBase::Ptr>& grids, const SlabFolder& folder,
               size_t slab, const std::vector<openvdb::GridBase::Ptr>& lowest);

/// Adds to the grids of the slabs below those of the next one, which it empties. Both were checked.
/// @throw IoError, one line, if they are of types that cannot be put together
void addSlab(const std::vector<openvdb::GridBase::Ptr>& grids,
             const std::vector<openvdb::GridBase::Ptr>& next, const std::string& path);

}  // namespace vdb_madf
