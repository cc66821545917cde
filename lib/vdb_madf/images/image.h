// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/voxel_size.h"

namespace vdb_madf {

enum class SampleType { uint8, int8, uint16, int16, uint32, int32, float32, float64 };
size_t sampleSize(SampleType type);
std::string sampleTypeName(SampleType type);  ///< "uint8" ...
std::optional<SampleType> sampleTypeFromName(const std::string& name);
std::vector<std::string> sampleTypeNames();  ///< in the order of SampleType

/// Voxels along each axis.
struct ImageSize {
  int x = 0, y = 0, z = 0;

  int& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  int operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  bool operator==(const ImageSize& o) const { return x == o.x && y == o.y && z == o.z; }
};

/// A 3-D image: its domain is [0, size - 1].
struct ImageInfo {
  ImageSize size;  ///< each 1 .. kMaxImageSide
  SampleType type = SampleType::uint8;
  std::optional<VoxelSize> voxelSize;
  /// Edges along x, y and z of voxels that are no cubes, in a unit that the file does not say; then
  /// there is no voxelSize.
  std::optional<std::array<double, 3>> proportions;
  bool isPlaced = false;  ///< in the file's world, voxel 0,0,0 is a voxel or more from the origin
  std::string format;     ///< "tiff", "raw", "mhd", "nrrd", "npy", "isq", "nifti" ...
};

/// Reads a volume as slabs of z-slices; never holds more than it is asked for.
class ImageReader {
 public:
  virtual ~ImageReader() = default;
  const ImageInfo& info() const { return info_; }
  const std::string& path() const { return path_; }
  /// All files that are read: the path, or what a folder or a detached header names.
  const std::vector<std::string>& files() const { return files_; }
  /// What a user should know of these files though it is no error: one line each, that names them.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Slices [first, first + count), x fastest, native byte order, into count*ny*nx samples.
  /// Slices are read in ascending order (compressed formats cannot go back).
  /// @throw IoError
  virtual void read(int first, int count, void* samples) = 0;

 protected:
  ImageInfo info_;
  std::string path_;
  std::vector<std::string> files_, notes_;
};

/// The temporary file of an image that several processes write.
struct SharedImage {
  std::string temporary;
  uint64_t offset = 0;  ///< of the first sample
};

/// Writes slices in ascending order; whole or not at all (finish() renames the temporary file).
class ImageWriter {
 public:
  virtual ~ImageWriter() = default;
  virtual void write(int count, const void* samples) = 0;  ///< the next count slices, x fastest
  virtual void finish() = 0;

  /// Lets several processes write the samples at the same time (shared_image.h). The header is
  /// written and the file has its full length then; write() is not called, and finish() waits until
  /// they are done. None if slices of this format come in order.
  virtual std::optional<SharedImage> share() { return std::nullopt; }
};

}  // namespace vdb_madf
