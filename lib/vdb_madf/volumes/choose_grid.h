// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// What a grid is wanted for. Where none is named, it is the first that is there of the names in
/// parentheses, else the only one of a type that can be used. The region of another grid is taken
/// only by its name.
enum class GridUse {
  object,  ///< a mask, bool, int32, int64, float or double ("object")
  labels,  ///< int32 ("grain", "truth")
  values   ///< the types of `object` ("grain", "truth", "object")
};

/// Thrown where several grids can be used and none was named.
class AmbiguousGrid : public InvalidInput {
 public:
  AmbiguousGrid(const std::string& path, const std::string& grids);
  /// The grids of the file with their types: "a (int32), b (int32)".
  const std::string& grids() const { return grids_; }

 private:
  std::string grids_;
};

/// True if the file is OpenVDB by its first bytes; where they do not tell, by the ending .vdb. So
/// is a folder of slabs (slab_folder.h).
/// A file that is missing is judged by its ending.
bool isVdbFile(const std::string& path);

/// One of the grids of the file at `path`, which the messages name.
/// @param name of the grid; empty: see GridUse
/// @throw InvalidInput if there is no such grid or it cannot be used; AmbiguousGrid.
openvdb::GridBase::Ptr chooseGrid(const std::vector<openvdb::GridBase::Ptr>& grids,
                                  const std::string& path, GridUse use,
                                  const std::string& name = "");

}  // namespace vdb_madf
