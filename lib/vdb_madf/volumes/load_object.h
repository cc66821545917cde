// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/scans/image_object.h"
#include "vdb_madf/volumes/volume.h"

namespace vdb_madf {

/// The object in a volume, as a grid "object" with domain and voxel size, as far as the file or the
/// options tell them: of a grid as objectMask(), of an image as imageObject(). With a region the
/// domain is what of it lies in the region, object outside is left out, and a note says how much,
/// and what was fitted. (An inverted selection is one of that domain.)
/// Peak memory: see readVdb() and imageObject().
/// @throw InvalidInput, one line that names the file, for a volume that does not fit the options
///   (also AmbiguousGrid); IoError; Interrupted.
MaskGrid::Ptr loadObject(const std::string& path, const VolumeOptions& options = {},
                         Interrupter* interrupter = nullptr);

/// The object of an image that is no file, such as an array that is read slab by slab. Its path is
/// what messages and the metadata `madf_source` name. Of the options, what concerns files has no
/// meaning: grid, dataset, raw and outputs. @throw as loadObject()
MaskGrid::Ptr loadObject(const ImageOpener& open, const VolumeOptions& options = {},
                         Interrupter* interrupter = nullptr);

/// One of so many parts of an object, in layers of leaf nodes.
struct ObjectShare {
  int part = 0, parts = 1;
};

/// Hands the voxels of loadObject() over, layer by layer, so that the object need not fit in
/// memory: that of an image without hysteresis and despeckling, or of a folder of slabs without
/// these, a region of its voxels and an inverted selection. Others are loaded as a whole first.
/// @param share which layers are handed over. Of an image it is an equal part of the slices, which
///   alone are read; it has to be read by value then, with no more than filters, and what a region
///   leaves out is not counted. The slabs of a folder are dealt. A .vdb is read by all.
/// @return the object without its voxels. @throw as loadObject(); what `take` throws
MaskGrid::Ptr streamObject(const std::string& path, const VolumeOptions& options,
                           const TakeLayer& take, const ObjectShare& share = {},
                           Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
