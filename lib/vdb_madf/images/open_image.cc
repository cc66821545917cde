// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/open_image.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/word_list.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/standard_streams.h"
#include "vdb_madf/images/formats/formats.h"
#include "vdb_madf/images/formats/picture_slice.h"
#include "vdb_madf/images/formats/slice_folder.h"
#include "vdb_madf/images/formats/tiff.h"

namespace vdb_madf {

namespace {

/// One format of files, from its first bytes to its reader and writer.
struct FileFormat {
  /// True if the file's content is of this format; null: told by its ending alone.
  bool (*recognize)(const detail::InputFile& file, const std::string& head);
  /// In lower case; those that are written come first.
  std::vector<std::string> endings;
  /// Null: not an image.
  std::unique_ptr<ImageReader> (*open)(std::unique_ptr<detail::InputFile> file,
                                       const std::string& dataset);
  /// Null: the format is not written.
  std::unique_ptr<ImageWriter> (*create)(const std::string& path, const ImageInfo& info,
                                         const std::array<double, 3>& origin) = nullptr;
  size_t writtenEndings = 0;
  bool isStreamed = false;  ///< written from the beginning to the end, be it to standard output
};

void refuseDataset(const std::string& path, const std::string& dataset) {
  if (!dataset.empty())
    throw IoError(path + ": has no datasets to choose from; leave out the choice", Hint::dataset);
}

bool begins(const std::string& head, const std::string& magic) {
  return head.compare(0, magic.size(), magic) == 0;
}

bool isTiffHeader(const std::string& head) {
  using namespace std::string_literals;
  return begins(head, "II*\0"s) || begins(head, "MM\0*"s) || begins(head, "II+\0"s) ||
         begins(head, "MM\0+"s);
}

template <bool isHeader(const std::string&)>
bool hasHeader(const detail::InputFile&, const std::string& head) {
  return isHeader(head);
}

template <std::unique_ptr<ImageReader> openFile(std::unique_ptr<detail::InputFile>)>
std::unique_ptr<ImageReader> openOnly(std::unique_ptr<detail::InputFile> file,
                                      const std::string& dataset) {
  refuseDataset(file->path(), dataset);
  return openFile(std::move(file));
}

template <std::unique_ptr<ImageWriter> createFile(const std::string&, const ImageInfo&)>
std::unique_ptr<ImageWriter> createPlaceless(const std::string& path, const ImageInfo& info,
                                             const std::array<double, 3>&) {
  return createFile(path, info);
}

bool isPicture(const std::string& head) {
  return detail::isPngHeader(head) || detail::isBmpHeader(head);
}
bool isNrrd(const std::string& head) {
  return begins(head, "NRRD0");
}
bool isHdf5(const std::string& head) {
  return begins(head, "\x89HDF\r\n\x1a\n");
}
bool isVdb(const std::string& head) {
  return begins(head, std::string(" BDV\0\0\0\0", 8));
}

#ifndef VDB_MADF_HDF5
const std::string kGetHdf5 = "install libhdf5-dev, then configure and build it again";
#endif

std::unique_ptr<ImageReader> openHdf5File(std::unique_ptr<detail::InputFile> file,
                                          [[maybe_unused]] const std::string& dataset) {
#ifdef VDB_MADF_HDF5
  if (isStandardInput(file->path()))
    throw IoError("-: HDF5 cannot be read from standard input: give the path of a file");
  return detail::openHdf5(file->path(), dataset);
#else
  throw IoError(file->path() + ": HDF5 cannot be read by this program: " + kGetHdf5);
#endif
}

std::unique_ptr<ImageWriter> createHdf5File(const std::string& path,
                                            [[maybe_unused]] const ImageInfo& info) {
#ifdef VDB_MADF_HDF5
  return detail::createHdf5(path, info);
#else
  throw IoError(path + ": HDF5 cannot be written by this program: " + kGetHdf5);
#endif
}

std::unique_ptr<ImageReader> refuseRaw(std::unique_ptr<detail::InputFile> file) {
  throw IoError(file->path() + ": a raw file needs its size and sample type", Hint::rawLayout);
}

/// The formats of files. The first that recognizes the content is taken, else the first with the
/// ending of the file.
const std::vector<FileFormat>& fileFormats() {
  using namespace detail;
  static const std::vector<FileFormat> kFormats = {
      {[](const InputFile& file, const std::string&) { return isNifti(file); },
       {".nii", ".nii.gz"},
       openOnly<openNifti>},
      {hasHeader<isTiffHeader>,
       {".tif", ".tiff"},
       openOnly<openTiff>,
       createPlaceless<createTiff>,
       2},
      {hasHeader<isPicture>, {".png", ".bmp"}, openOnly<openPicture>},
      {hasHeader<isNrrd>, {".nrrd", ".nhdr"}, openOnly<openNrrd>, createNrrd, 1, true},
      {hasHeader<isNpyHeader>, {".npy"}, openOnly<openNpy>, createPlaceless<createNpy>, 1, true},
      {hasHeader<isHdf5>, {".h5", ".hdf5"}, openHdf5File, createPlaceless<createHdf5File>, 2},
      {hasHeader<isVdb>, {".vdb"}, nullptr},
      {hasHeader<isIsqHeader>, {".isq"}, openOnly<openIsq>},
      {hasHeader<isCompoundHeader>, {".txm", ".txrm"}, openOnly<openTxm>},
      {hasHeader<isMetaHeader>, {".mhd", ".mha"}, openOnly<openMeta>, createMeta, 2},
      {hasHeader<isDgtalHeader>, {".longvol"}, openOnly<openDgtal>},
      {hasHeader<isPyhstHeader>, {".vol", ".info"}, openOnly<openPyhst>},
      {nullptr, {".raw"}, openOnly<refuseRaw>, createPlaceless<createRaw>, 1, true}};
  return kFormats;
}

/// Enough for every magic number, and for the comments that may precede the keys of a MetaImage.
constexpr size_t kHeadBytes = 1024;

/// Null if no format has the ending.
const FileFormat* formatOfEnding(const std::string& path) {
  std::string ending = fileEnding(path);
  if (ending == ".gz") ending = fileEnding(std::filesystem::path(path).stem().string()) + ending;
  for (const FileFormat& format : fileFormats())
    if (std::find(format.endings.begin(), format.endings.end(), ending) != format.endings.end())
      return &format;
  return nullptr;
}

/// By content, then by ending; null if neither is known.
const FileFormat* formatOf(const detail::InputFile& file) {
  const std::string head = file.head(kHeadBytes);
  for (const FileFormat& format : fileFormats())
    if (format.recognize && format.recognize(file, head)) return &format;
  return formatOfEnding(file.path());
}

/// The format whose writer takes such an ending, or null.
const FileFormat* writtenFormat(const std::string& path) {
  const std::string ending = fileEnding(path);
  for (const FileFormat& format : fileFormats()) {
    const auto end = format.endings.begin() + std::ptrdiff_t(format.writtenEndings);
    if (std::find(format.endings.begin(), end, ending) != end)
      return isStandardOutput(path) && !format.isStreamed ? nullptr : &format;
  }
  return nullptr;
}

bool isFolder(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

/// Pictures in a folder of TIFF slices are previews.
std::unique_ptr<ImageReader> openFolder(const std::string& path, const std::string& dataset) {
  if (detail::isZarrFolder(path)) return detail::openZarr(path, dataset);
  refuseDataset(path, dataset);
  if (!detail::tiffFilesIn(path).empty()) return detail::openTiffFolder(path);
  return detail::openPictureFolder(path);
}

}  // namespace

bool hasDatasets(const std::string& path) {
  std::error_code error;
  if (isStandardInput(path)) return false;
  if (isFolder(path)) return detail::isZarrFolder(path);
  if (!std::filesystem::is_regular_file(path, error)) return false;  // a pipe is read once
  try {
    return isHdf5(detail::InputFile(path).head(kHeadBytes));
  } catch (const IoError&) {
    return false;
  }
}

std::unique_ptr<ImageReader> openImage(const std::string& path, const std::optional<RawLayout>& raw,
                                       const std::string& dataset) {
  if (!raw && !isStandardInput(path) && isFolder(path)) return openFolder(path, dataset);
  if (raw) refuseDataset(path, dataset);
  auto file = std::make_unique<detail::InputFile>(path);
  if (raw) return detail::openRaw(std::move(file), *raw);
  const FileFormat* format = formatOf(*file);
  if (format && format->open) return format->open(std::move(file), dataset);
  refuseDataset(path, dataset);
  if (format) throw IoError(path + ": is a VDB file, not an image");
  throw IoError(path + ": is no image of a known format; if it is raw, give its size and type",
                Hint::rawLayout);
}

std::vector<std::string> writtenEndings() {
  std::vector<std::string> endings;
  for (const FileFormat& format : fileFormats())
    endings.insert(endings.end(), format.endings.begin(),
                   format.endings.begin() + std::ptrdiff_t(format.writtenEndings));
  return endings;
}

bool readsHdf5() {
#ifdef VDB_MADF_HDF5
  return true;
#else
  return false;
#endif
}

bool looksLikeImage(const std::string& path) {
  try {
    if (!isStandardInput(path) && isFolder(path))
      return detail::isZarrFolder(path) || !detail::tiffFilesIn(path).empty() ||
             !detail::picturesIn(path).empty();
    const FileFormat* format = formatOf(detail::InputFile(path));
    return format && format->open;
  } catch (const IoError&) {  // nothing there to look at
    const FileFormat* format = formatOfEnding(path);
    return format && format->open;
  }
}

std::unique_ptr<ImageWriter> createImage(const std::string& path, const ImageInfo& info,
                                         const std::array<double, 3>& origin) {
  if (const FileFormat* format = writtenFormat(path)) return format->create(path, info, origin);
  throw InvalidInput(path + (isStandardOutput(path)
                                 ? ": images on standard output are raw:-, nrrd:- or npy:-"
                                 : ": images are written as " + wordList(writtenEndings())));
}

void checkImagePlace(const std::string& path) {
  const std::string ending = fileEnding(path);
  if (ending == ".mhd") detail::checkMetaPlace(path);
  if (!readsHdf5() && (ending == ".h5" || ending == ".hdf5")) createHdf5File(path, {});
}

bool isImageEnding(const std::string& path) {
  return writtenFormat(path) != nullptr;
}

}  // namespace vdb_madf
