// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/volumes/volume.h"

namespace vdb_madf {

/// The labels in a volume, an int32 grid or an image of integers: active where they are not 0.
/// (Of a VDB file: the grid as it is.) With a region as loadObject().
/// @throw as loadObject(); InvalidInput if a value is no integer or beyond int32.
Int32Grid::Ptr loadLabels(const std::string& path, const VolumeOptions& options = {},
                          Interrupter* interrupter = nullptr);

/// The labels in an image that is no file, as loadObject() takes one.
Int32Grid::Ptr loadLabels(const ImageOpener& open, const VolumeOptions& options = {},
                          Interrupter* interrupter = nullptr);

/// The labels in a folder of slabs (slab_folder.h), which are read one by one; without a region.
/// @throw as loadLabels()
LabelSlabs openLabelSlabs(const std::string& path, const VolumeOptions& options = {},
                          Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
