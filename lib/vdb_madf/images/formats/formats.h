// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <memory>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

namespace vdb_madf::detail {

/// DGtal's .vol (uint8) and .longvol (64-bit integers, read as uint32; 32-bit ones of older
/// programs are told by the size of the file), version 2 (plain) and 3 (zlib), little-endian. They
/// know no voxel size; the center is ignored: voxels are numbered from 0. Not read: version 1.
/// Source: VolReader, VolWriter, LongvolReader and LongvolWriter of DGtal.
std::unique_ptr<ImageReader> openDgtal(std::unique_ptr<InputFile> file);
/// True for the first bytes of such a file.
bool isDgtalHeader(const std::string& head);

/// A dataset [z, y, x] of an HDF5 file, maybe behind axes of length 1: the one that is named, else
/// the only one; several links to one dataset count once. Integers, floats, h5py's bool; whatever
/// layout and filters the library knows. It may lie in another file, which an external link leads
/// to, or be virtual, if all the files of its parts are there. The voxel size comes from the
/// attribute element_size_um (z, y, x), which ilastik and the HDF5 plugin of ImageJ write, or from
/// NeXus' x_pixel_size, y_pixel_size (and z_pixel_size) with units, in the group of the dataset.
/// The library runs in a process of its own, as damaged files crash it. Built only where libhdf5 is
/// found.
std::unique_ptr<ImageReader> openHdf5(const std::string& path, const std::string& dataset);
/// A dataset `data` [z, y, x] in chunks, deflated, with `element_size_um` (z, y, x) where the voxel
/// size is known. The same bytes whenever it is written.
std::unique_ptr<ImageWriter> createHdf5(const std::string& path, const ImageInfo& info);

/// Scanco's .isq: int16, little-endian, as stored (not divided by the mu scaling). The voxel size
/// is the field of view over the voxels, which the header has in whole micrometers. Not read:
/// projections (.rad), .aim. Source: layout of the header as in itk::ScancoImageIO (ITKIOScanco)
/// and BoneJ's ISQReader.
std::unique_ptr<ImageReader> openIsq(std::unique_ptr<InputFile> file);
/// True for the first bytes of such a file.
bool isIsqHeader(const std::string& head);

/// MetaImage (.mhd with a data file, .mha with the data in it), raw or zlib. Its spacing has no
/// unit; by ITK's convention it is millimeters. A spacing of exactly 1 is what programs write that
/// know nothing better: it gives no physical size.
/// Not read: text data, several channels, data spread over several files.
std::unique_ptr<ImageReader> openMeta(std::unique_ptr<InputFile> file);
/// Finds out before the work. @throw IoError if the .raw file beside an .mhd would replace one that
/// the .mhd there, if any, does not name.
void checkMetaPlace(const std::string& path);
/// .mha: one file. .mhd: the data in a .raw file beside it, which is put in place first.
/// @throw as checkMetaPlace().
std::unique_ptr<ImageWriter> createMeta(const std::string& path, const ImageInfo& info,
                                        const std::array<double, 3>& origin);
/// True for the first bytes of a MetaImage header.
bool isMetaHeader(const std::string& head);

/// NIfTI-1 in one file, .nii or .nii.gz, either byte order; a slope and intercept other than 1 and
/// 0 are applied and make the samples float32. The voxel size comes from pixdim, if the header says
/// its unit. Voxels stay where they are stored: the orientation in the patient is not applied.
/// Not read: a header apart from its data (.hdr, .img), NIfTI-2, more than three dimensions.
/// Source: nifti1.h, the official definition of the header, R. W. Cox, NIMH.
std::unique_ptr<ImageReader> openNifti(std::unique_ptr<InputFile> file);
/// True if the file, or what is compressed in it, begins like one of NIfTI-1.
bool isNifti(const InputFile& file);

/// NumPy's .npy of an array [z, y, x] in C order, format versions 1 to 3, any integers, bool and
/// floats of 32 or 64 bits, either byte order. It knows no voxel size.
/// Not read: Fortran order (its slices lie scattered over the file), other than three dimensions.
/// Source: numpy.lib.format in NumPy's documentation.
std::unique_ptr<ImageReader> openNpy(std::unique_ptr<InputFile> file);
/// Version 1, C order, little-endian: np.load(path)[z, y, x].
std::unique_ptr<ImageWriter> createNpy(const std::string& path, const ImageInfo& info);
/// True for the first bytes of an .npy file.
bool isNpyHeader(const std::string& head);

/// NRRD with the data in the same file or in one other, encoding raw or gzip. The voxel size comes
/// from `spacings` with `units`, or `space directions` with `space units`; without units there is
/// none. A rotated frame is fine, a sheared one is an error.
/// Not read: text and bzip2 encodings, other than three dimensions, data spread over several files.
/// Source: "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html.
std::unique_ptr<ImageReader> openNrrd(std::unique_ptr<InputFile> file);
/// Writes one file, encoding raw. The spacing is written in millimeters, which is what ITK takes it
/// for.
std::unique_ptr<ImageWriter> createNrrd(const std::string& path, const ImageInfo& info,
                                        const std::array<double, 3>& origin);

/// What PyHST of the ESRF writes: samples in NAME.vol, their size in the text file NAME.vol.info.
/// Either of the two can be given. The type is DATA_TYPE if it is given (other programs do), else
/// told by the size of the file: float32, uint16 or uint8.
///
/// No source says the unit of voxelSize. It is taken for that of IMAGE_PIXEL_SIZE_1, which it is
/// made from: micrometers, by the comment in PyHST's parameter files ("Pixel size horizontally
/// (microns)") and by EDFTomoScan of the ESRF's tomoscan, which multiplies that key with 1e-6 m.
/// Source of the keys: the mock volumes of the ESRF's tomwer (NUM_X, NUM_Y, NUM_Z, voxelSize,
/// BYTEORDER, ValMin ...); HST_info and HST_write of pymicro (DATA_TYPE, names as of NumPy).
std::unique_ptr<ImageReader> openPyhst(std::unique_ptr<InputFile> file);
/// True for the first bytes of an .info file.
bool isPyhstHeader(const std::string& head);

/// Samples without a header, or after one of a known length; nothing follows them.
std::unique_ptr<ImageReader> openRaw(std::unique_ptr<InputFile> file, const RawLayout& layout);
std::unique_ptr<ImageWriter> createRaw(const std::string& path, const ImageInfo& info);

/// .txm, .txrm: scans of Zeiss Xradia and Versa microscopes, compound files with a stream per
/// slice. Integers of 8, 16 and 32 bits, float32 and float64; the voxel size is PixelSize, in
/// micrometers. Rows and slices are taken in the order in which they are stored (Bio-Formats turns
/// rows over). Projections, which a .txrm holds, are read as well, with a note.
/// Zeiss publishes no definition: these are the streams that dxchange, txrm2tiff and Bio-Formats
/// read.
std::unique_ptr<ImageReader> openTxm(std::unique_ptr<InputFile> file);
/// True for any compound file.
bool isCompoundHeader(const std::string& head);

/// A Zarr array [z, y, x] of version 2 or 3, or an array of a group: the one that is named (or of
/// the group that is named), else the first scale of an OME-Zarr image, else the only volume. The
/// voxel size comes from the axes and scales of OME-Zarr 0.4, 0.5 or 0.6, if the axes have units. A
/// layer of chunks is kept decoded if it is not too large. Not read: several channels or times,
/// other codecs than those of zarr_array.h.
/// Source: Zarr storage specification version 2, core specification version 3; OME-NGFF 0.4, 0.5
/// and 0.6 (multiscales).
std::unique_ptr<ImageReader> openZarr(const std::string& path, const std::string& dataset);
/// True for a folder that is a Zarr array or group.
bool isZarrFolder(const std::string& path);

}  // namespace vdb_madf::detail
