// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/exports/detail/grain_table.h"
#include "vdb_madf/exports/detail/ome_attributes.h"
#include "vdb_madf/exports/ome_zarr.h"
#include "vdb_madf/files/output_tree.h"
#include "vdb_madf/labels/grain_colors.h"

namespace vdb_madf::detail {

/// @throw InvalidInput for meshes that are asked for and cannot be
void checkNeuroglancer(const Int32Grid& labels, const OmeZarrOptions& options);

/// Writes `neuroglancer/` beside the labels of an OME-Zarr folder: `mesh`, a mesh for each grain in
/// nanometers (legacy single-resolution meshes), `properties`, the measures that are known of every
/// grain, and `state.json`, which shows both with the labels.
/// @param name what the folder will be called
/// @param box of the labels; place: where its voxels lie
/// Source: neuroglancer's precomputed meshes and segment properties.
/// @throw InvalidInput as grainMesh() and reduceLabels(); IoError; Interrupted
void writeNeuroglancer(const OutputTree& folder, const std::string& name, const Int32Grid& labels,
                       const CoordBBox& box, const OmePlace& place, const GrainTable& table,
                       const GrainColors& colors, const OmeZarrOptions& options,
                       Interrupter* interrupter);

}  // namespace vdb_madf::detail
