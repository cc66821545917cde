// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// The box of a grid's domain; where that is unknown, of the active voxels.
/// @throw InvalidInput for labels and masks that have voxels outside of their domain
CoordBBox writtenBox(const openvdb::GridBase& grid);

/// Writes the grid's values over `box`, slab by slab: of masks, labels and other whole numbers
/// those of active voxels, else 0; of real numbers what is stored, background outside of tiles and
/// leaves. The first voxel lies where the grid's transform has the box's lower corner, see
/// createImage().
/// Bool, Mask, Int32, Int64, Float and Double grids; values must be representable in info.type.
/// @throw InvalidInput if a value does not fit the sample type, naming the value; IoError.
void writeImage(const std::string& path, const openvdb::GridBase& grid, const CoordBBox& box,
                SampleType type, Interrupter* interrupter = nullptr);

/// Writes labels in slabs, each of which is read once, as above.
/// @throw as above; InvalidInput as writtenBox()
void writeImage(const std::string& path, const LabelSlabs& labels, const CoordBBox& box,
                SampleType type, Interrupter* interrupter = nullptr);

// Several processes write an image together: one creates it, and its share() shares it; each writes
// the part of some slabs; and when all are done the first one finishes it.

/// Creates the image. @throw as writeImage()
std::unique_ptr<ImageWriter> createSharedImage(const std::string& path, const LabelSlabs& labels,
                                               const CoordBBox& box, SampleType type);

/// Writes the slabs from `begin` to before `end`: the lowest one of all with what of the box lies
/// below it, the highest one with what lies above. Synced to disk.
/// @throw as writeImage(); IoError if this process does not see the shared file
void writeImagePart(const std::string& path, const SharedImage& shared, const LabelSlabs& labels,
                    size_t begin, size_t end, const CoordBBox& box, SampleType type,
                    Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
