// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/open_image.h"

#include <filesystem>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/images/formats/dgtal_vol.h"
#include "vdb_madf/images/formats/hdf5.h"
#include "vdb_madf/images/formats/isq.h"
#include "vdb_madf/images/formats/meta_image.h"
#include "vdb_madf/images/formats/nifti.h"
#include "vdb_madf/images/formats/npy.h"
#include "vdb_madf/images/formats/nrrd.h"
#include "vdb_madf/images/formats/picture_slice.h"
#include "vdb_madf/images/formats/pyhst_vol.h"
#include "vdb_madf/images/formats/raw.h"
#include "vdb_madf/images/formats/slice_folder.h"
#include "vdb_madf/images/formats/tiff.h"
#include "vdb_madf/images/formats/zarr.h"

namespace vdb_madf {

namespace {

enum class Format {
  unknown,
  tiff,
  tiffFolder,
  picture,
  pictureFolder,
  meta,
  nrrd,
  npy,
  isq,
  nifti,
  dgtal,
  pyhst,
  zarr,
  hdf5,
  raw,
  vdb
};

Format formatOfEnding(const std::string& path) {
  const std::string end = fileEnding(path);
  if (end == ".tif" || end == ".tiff") return Format::tiff;
  if (end == ".mhd" || end == ".mha") return Format::meta;
  if (end == ".nrrd" || end == ".nhdr") return Format::nrrd;
  if (end == ".png" || end == ".bmp") return Format::picture;
  if (end == ".npy") return Format::npy;
  if (end == ".isq") return Format::isq;
  if (end == ".nii") return Format::nifti;
  if (end == ".gz") {  // .nii.gz
    const std::filesystem::path inner = std::filesystem::path(path).stem();
    return fileEnding(inner.string()) == ".nii" ? Format::nifti : Format::unknown;
  }
  if (end == ".longvol") return Format::dgtal;
  if (end == ".vol" || end == ".info") return Format::pyhst;
  if (end == ".h5" || end == ".hdf5") return Format::hdf5;
  if (end == ".raw") return Format::raw;
  if (end == ".vdb") return Format::vdb;
  return Format::unknown;
}

Format formatOfContent(const std::string& head) {
  const auto begins = [&](const char* text, size_t length) {
    return head.compare(0, length, text, length) == 0;
  };
  for (const char* magic : {"II*\0", "MM\0*", "II+\0", "MM\0+"})
    if (begins(magic, 4)) return Format::tiff;
  if (detail::isPngHeader(head) || detail::isBmpHeader(head)) return Format::picture;
  if (begins("NRRD0", 5)) return Format::nrrd;
  if (detail::isNpyHeader(head)) return Format::npy;
  if (begins("\x89HDF\r\n\x1a\n", 8)) return Format::hdf5;
  if (begins(" BDV\0\0\0\0", 8)) return Format::vdb;
  if (detail::isIsqHeader(head)) return Format::isq;
  if (detail::isMetaHeader(head)) return Format::meta;
  if (detail::isDgtalHeader(head)) return Format::dgtal;
  if (detail::isPyhstHeader(head)) return Format::pyhst;
  return Format::unknown;
}

/// Enough for every magic number, and for the comments that may precede the keys of a MetaImage.
constexpr size_t kHeadBytes = 1024;

/// Pictures in a folder of TIFF slices are previews.
Format formatOfFolder(const std::string& path) {
  if (detail::isZarrFolder(path)) return Format::zarr;
  return detail::tiffFilesIn(path).empty() ? Format::pictureFolder : Format::tiffFolder;
}

/// By content, then by ending.
Format formatOf(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return formatOfFolder(path);
  const detail::InputFile file(path);
  const Format format =
      detail::isNifti(file) ? Format::nifti : formatOfContent(file.head(kHeadBytes));
  return format == Format::unknown ? formatOfEnding(path) : format;
}

bool hasDatasets(Format format) {
  return format == Format::zarr || format == Format::hdf5;
}

}  // namespace

std::unique_ptr<ImageReader> openImage(const std::string& path, const std::optional<RawLayout>& raw,
                                       const std::string& dataset) {
  const Format format = raw ? Format::raw : formatOf(path);
  if (!dataset.empty() && !hasDatasets(format))
    throw IoError(path + ": has no datasets to choose from; leave out the choice (--dataset)");
  if (raw) return detail::openRaw(path, *raw);
  switch (format) {
    case Format::tiff:
      return detail::openTiff(path);
    case Format::tiffFolder:
      return detail::openTiffFolder(path);
    case Format::picture:
      return detail::openPicture(path);
    case Format::pictureFolder:
      return detail::openPictureFolder(path);
    case Format::meta:
      return detail::openMeta(path);
    case Format::nrrd:
      return detail::openNrrd(path);
    case Format::npy:
      return detail::openNpy(path);
    case Format::isq:
      return detail::openIsq(path);
    case Format::nifti:
      return detail::openNifti(path);
    case Format::dgtal:
      return detail::openDgtal(path);
    case Format::pyhst:
      return detail::openPyhst(path);
    case Format::zarr:
      return detail::openZarr(path, dataset);
    case Format::hdf5:
#ifdef VDB_MADF_HDF5
      return detail::openHdf5(path, dataset);
#else
      throw IoError(path + ": HDF5 cannot be read by this program: build it with libhdf5-dev");
#endif
    case Format::raw:
      throw IoError(path + ": a raw file needs its size and sample type (--dims, --type)");
    case Format::vdb:
      throw IoError(path + ": is a VDB file, not an image");
    case Format::unknown:
      break;
  }
  throw IoError(
      path +
      ": is no image of a known format; if it is raw, give its size and type (--dims, --type)");
}

bool looksLikeImage(const std::string& path) {
  try {
    const Format format = formatOf(path);
    if (format == Format::pictureFolder) return !detail::picturesIn(path).empty();
    return format != Format::unknown && format != Format::vdb;
  } catch (const IoError&) {  // nothing there to look at
    const Format format = formatOfEnding(path);
    return format != Format::unknown && format != Format::vdb;
  }
}

std::unique_ptr<ImageWriter> createImage(const std::string& path, const ImageInfo& info,
                                         const std::array<double, 3>& origin) {
  switch (formatOfEnding(path)) {
    case Format::raw:
      return detail::createRaw(path, info);
    case Format::meta:
      return detail::createMeta(path, info, origin);
    case Format::tiff:
      return detail::createTiff(path, info);
    case Format::npy:
      return detail::createNpy(path, info);
    case Format::nrrd:
      if (fileEnding(path) == ".nrrd") return detail::createNrrd(path, info, origin);
      break;
    default:
      break;
  }
  throw InvalidInput(path + ": images are written as .tif, .tiff, .raw, .mhd, .mha, .nrrd or .npy");
}

bool isImageEnding(const std::string& path) {
  const std::string end = fileEnding(path);
  return end == ".tif" || end == ".tiff" || end == ".raw" || end == ".mhd" || end == ".mha" ||
         end == ".nrrd" || end == ".npy";
}

}  // namespace vdb_madf
