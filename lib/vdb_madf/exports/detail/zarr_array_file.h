// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/files/output_tree.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

enum class ZarrVersion { two = 2, three = 3 };

/// What becomes of the active values above 0 of a tree; all else is 0.
enum class ZarrSamples {
  label,  ///< uint32, as they are
  mask,   ///< uint8, 255
  gray    ///< uint8, as they are
};

/// Voxels along each edge of a chunk, or as many as the array has.
constexpr int kZarrChunk = 64;

/// Writes an array [z, y, x] of a box, at `name` within the folder: its description, and chunks by
/// gzip. Chunks of background alone are left out, but for the first where there would be none: an
/// array without any looks like one whose chunks were lost. Memory: a chunk per thread.
/// @param values without active tiles
/// @throw IoError; Interrupted
void writeZarrArray(const OutputTree& folder, const std::string& name, const Int32Tree& values,
                    const CoordBBox& box, ZarrSamples samples, ZarrVersion version,
                    Interrupter* interrupter);

/// Writes a group's description. @param attributes a JSON object
void writeZarrGroup(const OutputTree& folder, const std::string& name,
                    const std::string& attributes, ZarrVersion version);

}  // namespace vdb_madf::detail
