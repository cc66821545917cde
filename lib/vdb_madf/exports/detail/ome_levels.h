// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/exports/detail/zarr_array_file.h"
#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf::detail {

// The levels of an OME-Zarr of labels: see writeOmeZarr().

/// Where the label image lies within the group of the object.
constexpr char kLabelGroup[] = "labels/grain";

/// A volume at 1/factor.
struct OmeLevel {
  int factor = 1;
  CoordBBox box;
};
/// The levels of labels over a box, from factor 1 on.
std::vector<OmeLevel> omeLevels(const CoordBBox& box);

/// Writes both arrays, of the object and of labels, of all levels, called 0, 1, 2 ...
/// @param group what stands before their names: "", or "before/" in a scene
/// @throw InvalidInput; IoError; Interrupted
void writeOmeLevels(const OutputTree& folder, const std::string& group, const Int32Grid& labels,
                    const std::vector<OmeLevel>& levels, ZarrVersion version,
                    Interrupter* interrupter);

/// Writes all levels, called 0, 1, 2 ..., of labels in slabs, each of which is read once. Memory: a
/// slab, and of each level what there is of a layer of chunks.
/// @throw as above; what reading throws
void writeOmeLevels(const OutputTree& folder, const std::string& group, const LabelSlabs& labels,
                    const std::vector<OmeLevel>& levels, ZarrVersion version,
                    Interrupter* interrupter);

}  // namespace vdb_madf::detail
