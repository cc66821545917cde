// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/grid_metadata.h"
#include "vdb_madf/grid_types.h"
#include "vdb_madf/selection.h"

namespace vdb_madf {

enum class SampleType { uint8, int8, uint16, int16, uint32, int32, float32, float64 };
size_t sampleSize(SampleType type);
std::string sampleTypeName(SampleType type);  ///< "uint8" ...
std::optional<SampleType> sampleTypeFromName(const std::string& name);

/// A 3-D image: its domain is [0, size - 1].
struct ImageInfo {
  Coord size;  ///< x, y, z; each 1 .. 2^20
  SampleType type = SampleType::uint8;
  std::optional<VoxelSize> voxelSize;
  std::string format;  ///< "tiff", "raw", "mhd", "nrrd", "npy", "isq", "nifti" ...
};

/// Reads a volume as slabs of z-slices; never holds more than it is asked for.
class ImageReader {
 public:
  virtual ~ImageReader() = default;
  const ImageInfo& info() const { return info_; }
  const std::string& path() const { return path_; }
  /// All files that are read: the path, or what a folder or a detached header names.
  const std::vector<std::string>& files() const { return files_; }
  /// Slices [first, first + count), x fastest, native byte order, into count*ny*nx samples.
  /// Slices are read in ascending order (compressed formats cannot go back).
  /// @throw IoError
  virtual void read(int first, int count, void* samples) = 0;

 protected:
  ImageInfo info_;
  std::string path_;
  std::vector<std::string> files_;
};

/// How to read a headerless file.
struct RawLayout {
  Coord size;
  SampleType type = SampleType::uint8;
  bool bigEndian = false;
};

/// Opens TIFF (multi-page, BigTIFF), MHD/MHA, NRRD, npy, ISQ, NIfTI-1, vol/longvol, PyHST's vol,
/// PNG, BMP, a folder of TIFF, PNG or BMP slices, Zarr, HDF5 (if it was there when this was built),
/// recognised by content, then by ending; RAW if `raw` is given. Sizes in a header are checked
/// against the file before anything is allocated.
/// @param dataset which array of a Zarr group or an HDF5 file; empty: the first scale of an
/// OME-Zarr,
///     or the only volume
/// @throw IoError, one line that names the file.
std::unique_ptr<ImageReader> openImage(const std::string& path,
                                       const std::optional<RawLayout>& raw = std::nullopt,
                                       const std::string& dataset = "");

/// True if the path looks like one of the formats of openImage (never true for a .vdb file).
bool looksLikeImage(const std::string& path);

/// Reads the image slab by slab and keeps one bit per voxel of the leaves that hold object. The
/// mask carries domain and source metadata, voxel size and transform. Peak memory: the mask and one
/// slab of eight slices.
MaskGrid::Ptr readMask(ImageReader& image, const Selection& selection = {},
                       Interrupter* interrupter = nullptr);

/// Labels of an integer image, slab by slab: active where the value is not 0. Domain, voxel size
/// and source as readMask.
/// @throw InvalidInput if a value is no integer or beyond int32; IoError; Interrupted.
Int32Grid::Ptr readLabels(ImageReader& image, Interrupter* interrupter = nullptr);

/// Writes slices in ascending order; whole or not at all (finish() renames the temporary file).
class ImageWriter {
 public:
  virtual ~ImageWriter() = default;
  virtual void write(int count, const void* samples) = 0;  ///< the next count slices, x fastest
  virtual void finish() = 0;
};

/// By ending: .raw, .mhd (with .raw beside it), .mha, .nrrd, .npy, .tif/.tiff (BigTIFF when 4 GB or
/// more).
/// @param origin world position of the first voxel's centre in mm (in voxels, where there is no
///     voxel size), for the formats that have a place for it: MetaImage (Offset) and NRRD (space
///     origin). The readers take nothing over: what they read begins at voxel (0,0,0).
/// @throw IoError; InvalidInput for another ending.
std::unique_ptr<ImageWriter> createImage(const std::string& path, const ImageInfo& info,
                                         const openvdb::Vec3d& origin = openvdb::Vec3d(0));
/// True if createImage knows the ending.
bool isImageEnding(const std::string& path);

/// Writes the grid's values over `box` (background outside its tiles and leaves), slab by slab; the
/// first voxel lies where the grid's transform has the box's lower corner, see createImage().
/// Bool, Mask, Int32, Int64, Float and Double grids; values must be representable in info.type.
/// @throw InvalidInput if a value does not fit the sample type, naming the value; IoError.
void writeImage(const std::string& path, const openvdb::GridBase& grid, const CoordBBox& box,
                SampleType type, Interrupter* interrupter = nullptr);

/// The sample type in which programs expect labels: uint16 if all values of the grid fit, else
/// uint32; int32 if there are negative ones.
SampleType labelType(const Int32Grid& grid);

/// Copies an image slab by slab into another format and sample type; \p voxelSize replaces its own.
/// @throw InvalidInput if a value does not fit the sample type, naming the value; IoError;
/// Interrupted.
void copyImage(const std::string& path, ImageReader& image, SampleType type,
               const std::optional<VoxelSize>& voxelSize = std::nullopt,
               Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
