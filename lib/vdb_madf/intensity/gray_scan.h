// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <optional>
#include <string>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/measure/measure_sample.h"
#include "vdb_madf/volumes/volume.h"

namespace vdb_madf {

/// The values of a scan, slab by slab.
struct GrayScan {
  std::unique_ptr<ImageReader> image;
  Coord first;  ///< the voxel that the image begins with: 0, but of some grids

  CoordBBox box() const;
};

/// Puts a scan where labels with this domain are: as it is, if it holds all of the domain; an image
/// of just its size, where the domain begins elsewhere, is the scan cropped as the labels were.
/// @throw InvalidInput, one line that begins with the path
void placeScan(GrayScan& scan, const CoordBBox& domain);
/// Likewise; @throw also if the domain of the labels is unknown
void placeScan(GrayScan& scan, const SampleMeasures& sample);

/// What a user should know of a scan beside labels, as one sentence, or nothing. That it goes on
/// beyond labels which begin where it does: nothing but their size tells whether they were cropped
/// or are of another scan. That both say how large their voxels are, and these differ by more than
/// 0.1 % (kMaxEdgeRatio).
/// @param box, voxels of the scan
/// @param about a grid with the domain and the voxel size of the labels
/// @throw InvalidInput, one line that begins with the path, if the scan goes on beyond labels that
///   do not say where in it they lie: those of an image, of an array or of another program, and
///   reduced and resampled ones, of which it is not known that the scan has the same voxels
std::string noteOnScan(const std::string& path, const CoordBBox& box,
                       const std::optional<VoxelSize>& voxels, const openvdb::GridBase& about);
std::string noteOnScan(const GrayScan& scan, const openvdb::GridBase& about);

/// Any readable file: an image, as openVolumeImage(), or a grid of numbers of a VDB file (the one
/// that the options name, or GridUse::object), with its background outside of its voxels; its box
/// is its domain, or the box of its active voxels. Of the options `grid`, `dataset`, `raw`,
/// `outputs` and `note` count.
/// @throw InvalidInput, one line that names the file; IoError; Interrupted.
GrayScan openGrayScan(const std::string& path, const VolumeOptions& options = {},
                      Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
