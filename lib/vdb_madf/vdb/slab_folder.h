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

bool isSlabFolder(const std::string& path);

/// Its files, from the lowest on. @throw IoError, one line, if one is missing
std::vector<std::string> slabFiles(const std::string& path);

/// Before the work. @throw IoError if something else is at the path of a folder that is to be written
void checkSlabFolder(const std::string& path);

/// Puts the folder `made` in the place of `path`, and of the folder of slabs that is there.
/// @throw IoError
void commitSlabFolder(const std::string& made, const std::string& path);

/// Checks and takes away the marks of slab number `slab` of `count`, whose file is `path`.
/// @throw IoError, one line, if they are others
void unmarkSlab(const std::vector<openvdb::GridBase::Ptr>& grids, size_t slab, size_t count,
                const std::string& path);

/// Adds to the grids of the slabs below, or none, those of the next one, which it empties.
/// @throw IoError, one line, if they do not fit together
void addSlab(std::vector<openvdb::GridBase::Ptr>& grids,
             const std::vector<openvdb::GridBase::Ptr>& next, const std::string& path);

}  // namespace vdb_madf
