// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// How to read a file whose header is unknown or missing.
struct RawLayout {
  ImageSize size;
  SampleType type = SampleType::uint8;
  bool bigEndian = false;
  uint64_t skip = 0;  ///< bytes before the first sample: a header
};

/// Opens TIFF (multi-page, BigTIFF), MHD/MHA, NRRD, npy, ISQ, TXM, NIfTI-1, vol/longvol, PyHST's
/// vol, PNG, BMP, a folder of TIFF, PNG or BMP slices, Zarr, HDF5 (if it was there when this was
/// built), recognized by content, then by ending (the table in open_image.cc, where a new format
/// gets its line); RAW if `raw` is given. Sizes in a header are checked against the file before
/// anything is allocated. The path "-" is standard input (standard_streams.h), of any format but
/// HDF5.
/// @param dataset which array of a Zarr group or an HDF5 file; empty: the first scale of an
///     OME-Zarr, or the only volume
/// @throw IoError, one line that names the file.
std::unique_ptr<ImageReader> openImage(const std::string& path,
                                       const std::optional<RawLayout>& raw = std::nullopt,
                                       const std::string& dataset = "");

/// True for what has several images to choose from by name: a Zarr folder, an HDF5 file. False if
/// it cannot be read, or is standard input.
bool hasDatasets(const std::string& path);

/// True if HDF5 was there when this was built, and is read and written.
bool readsHdf5();

/// True if the path looks like one of the formats of openImage (never true for a .vdb file).
bool looksLikeImage(const std::string& path);

/// The endings of files that createImage() writes, in lower case: ".tif", ".tiff", ".nrrd" ...;
/// HDF5's are among them in any case. Help texts and checks are made of this list.
std::vector<std::string> writtenEndings();

/// Creates an image of the format that the ending says, one of writtenEndings(): a .mhd has a .raw
/// beside it, TIFF of 4 GB or more is BigTIFF, HDF5 is written if it was there when this was built;
/// raw:-, nrrd:- and npy:- go to standard output.
/// @param origin world position of the first voxel's center in mm (in voxels if there is no
///     voxel size), for the formats that can store it: MetaImage (Offset) and NRRD (space
///     origin). The readers ignore it: what they read begins at voxel (0,0,0).
/// @throw IoError, also as checkImagePlace(); InvalidInput for another ending.
std::unique_ptr<ImageWriter> createImage(const std::string& path, const ImageInfo& info,
                                         const std::array<double, 3>& origin = {});
/// Finds out before the work whether an image can be written. @throw IoError if an .mhd would
/// replace a .raw file that is not its own, or for HDF5 that cannot be written.
void checkImagePlace(const std::string& path);
/// True if createImage takes such a path.
bool isImageEnding(const std::string& path);

}  // namespace vdb_madf
