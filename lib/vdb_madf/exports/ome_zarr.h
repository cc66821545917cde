// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf {

/// Which OME-Zarr: 0.4 lies on Zarr version 2, which more programs read, 0.5 on version 3, 0.6 too,
/// with named coordinate systems.
enum class OmeVersion { v04, v05, v06 };
/// \param text: "0.4", "0.5" or "0.6"
/// @throw InvalidInput
OmeVersion omeVersionOf(const std::string& text);

/// What is written beside the labels.
struct OmeZarrOptions {
  OmeVersion version = OmeVersion::v04;
  MeasureOptions measure;  ///< for the properties of the grains
  /// Adds `neuroglancer/`, for the viewer of this name: a mesh for each grain, the measures that
  /// are known of all, and a state that shows both with the labels. Wants a voxel size.
  bool meshes = false;
  GrainMeshOptions mesh{10};
  int meshReduction = 1;  ///< meshes of labels at 1/n, 1 to kMaxReduction
};

/// Writes labels over `box` as an OME-Zarr folder, whole or not at all; nothing is replaced.
///
/// The folder is an image group, the object (uint8: 255, background 0), and holds the label image
/// `labels/grain` (uint32) with a color for each grain (grainColors()) and the measures of the
/// columns of columns.h, named and in units as in the table of grains; what is not known of a grain
/// is left out. Axes are z, y, x, in micrometers if the voxel size is known.
///
/// Arrays `0`, `1`, `2` ... are the volume at 1/1, 1/2, 1/4 ... until its longest side is that of
/// a chunk, 64 (at most 1/256). Coarse voxel i stands for the voxels factor * i ... of the index
/// space, as in reduced_labels.h: a label is the most frequent one, of equally frequent ones the
/// smallest; background within the box counts; the object's value is 255 times its part of the
/// voxels in the box, rounded half up. The translation of each level says where the center of its
/// first voxel lies, so that a voxel has the place in the world that its grid gives it.
///
/// Chunks are compressed by gzip; those of background alone are left out. The bytes depend on
/// labels and options alone, those of meshes on the name of the folder, too. Memory: that of
/// measure(), or the two grids of a coarse level and a chunk per thread; with meshes those of all
/// grains.
/// @throw InvalidInput if the box is empty, voxels are not along the axes, or as measure(); with
///   meshes also without a voxel size, and as reduceLabels() and grainMesh(); IoError; Interrupted.
void writeOmeZarr(const std::string& path, const Int32Grid& labels, const CoordBBox& box,
                  const OmeZarrOptions& options = {}, Interrupter* interrupter = nullptr);

/// Labels in slabs, which need not fit in memory together, give the same files. Each slab is read
/// four times, or more often as by measure(). Memory: that of measure(), or two slabs and of each
/// level what there is of a layer of chunks.
/// @throw as above; InvalidInput if the domain is a region, or for meshes; what reading throws.
void writeOmeZarr(const std::string& path, const LabelSlabs& labels, const CoordBBox& box,
                  const OmeZarrOptions& options = {}, Interrupter* interrupter = nullptr);

/// Two samples, or one at two times, and where points of the first lie in the second: in voxels, p
/// is at linear * p + shift.
struct OmeScene {
  const Int32Grid& before;
  const Int32Grid& after;
  openvdb::Mat3d linear = openvdb::Mat3d::identity();
  openvdb::Vec3d shift{0, 0, 0};
};

/// Writes a scene of OME-Zarr 0.6: a folder with the images `before` and `after`, each as
/// writeOmeZarr() writes it, and the transformation from the coordinates of the one to those of the
/// other: a translation, a rotation and a translation, or an affine one, whichever says it.
/// @throw as writeOmeZarr(); InvalidInput if the voxel size of one alone is known
void writeOmeScene(const std::string& path, const OmeScene& scene,
                   const MeasureOptions& measure = {}, Interrupter* interrupter = nullptr);

/// True for .zarr, so also for .ome.zarr.
bool isZarrEnding(const std::string& path);

}  // namespace vdb_madf
