// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/image_file.h"

#include <filesystem>

#include "vdb_madf/detail/header_text.h"
#include "vdb_madf/detail/input_file.h"
#include "vdb_madf/detail/meta_image.h"
#include "vdb_madf/detail/nrrd_image.h"
#include "vdb_madf/detail/raw_image.h"
#include "vdb_madf/detail/tiff_image.h"
#include "vdb_madf/errors.h"

namespace vdb_madf {

namespace {

struct TypeName {
  SampleType type;
  const char* name;
  size_t size;
};
constexpr TypeName kTypes[] = {
    {SampleType::uint8, "uint8", 1},     {SampleType::int8, "int8", 1},
    {SampleType::uint16, "uint16", 2},   {SampleType::int16, "int16", 2},
    {SampleType::uint32, "uint32", 4},   {SampleType::int32, "int32", 4},
    {SampleType::float32, "float32", 4}, {SampleType::float64, "float64", 8}};

enum class Format { unknown, tiff, folder, meta, nrrd, raw, vdb };

std::string ending(const std::string& path) {
  return detail::lowerCase(std::filesystem::path(path).extension().string());
}

Format formatOfEnding(const std::string& path) {
  const std::string end = ending(path);
  if (end == ".tif" || end == ".tiff") return Format::tiff;
  if (end == ".mhd" || end == ".mha") return Format::meta;
  if (end == ".nrrd" || end == ".nhdr") return Format::nrrd;
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
  if (begins("NRRD0", 5)) return Format::nrrd;
  if (begins(" BDV\0\0\0\0", 8)) return Format::vdb;
  if (detail::isMetaHeader(head)) return Format::meta;
  return Format::unknown;
}

/// Enough for every magic number, and for the comments that may precede the keys of a MetaImage.
constexpr size_t kHeadBytes = 1024;

/// By content, then by ending.
Format formatOf(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return Format::folder;
  const Format format = formatOfContent(detail::InputFile(path).head(kHeadBytes));
  return format == Format::unknown ? formatOfEnding(path) : format;
}

}  // namespace

size_t sampleSize(SampleType type) {
  return kTypes[size_t(type)].size;
}

std::string sampleTypeName(SampleType type) {
  return kTypes[size_t(type)].name;
}

std::optional<SampleType> sampleTypeFromName(const std::string& name) {
  for (const TypeName& known : kTypes)
    if (name == known.name) return known.type;
  return std::nullopt;
}

std::unique_ptr<ImageReader> openImage(const std::string& path,
                                       const std::optional<RawLayout>& raw) {
  if (raw) return detail::openRaw(path, *raw);
  switch (formatOf(path)) {
    case Format::tiff:
      return detail::openTiff(path);
    case Format::folder:
      return detail::openTiffFolder(path);
    case Format::meta:
      return detail::openMeta(path);
    case Format::nrrd:
      return detail::openNrrd(path);
    case Format::raw:
      throw IoError(path + ": a raw file needs its size and sample type (--dims, --type)");
    case Format::vdb:
      throw IoError(path + ": is a VDB file, not an image");
    case Format::unknown:
      break;
  }
  throw IoError(
      path +
      ": is not TIFF, MetaImage or NRRD; if it is raw, give its size and type (--dims, --type)");
}

bool looksLikeImage(const std::string& path) {
  try {
    const Format format = formatOf(path);
    if (format == Format::folder) return !detail::tiffFilesIn(path).empty();
    return format != Format::unknown && format != Format::vdb;
  } catch (const IoError&) {  // nothing there to look at
    const Format format = formatOfEnding(path);
    return format != Format::unknown && format != Format::vdb;
  }
}

std::unique_ptr<ImageWriter> createImage(const std::string& path, const ImageInfo& info) {
  switch (formatOfEnding(path)) {
    case Format::raw:
      return detail::createRaw(path, info);
    case Format::meta:
      return detail::createMeta(path, info);
    case Format::tiff:
      return detail::createTiff(path, info);
    default:
      throw InvalidInput(path + ": images are written as .raw, .mhd, .mha, .tif or .tiff");
  }
}

bool isImageEnding(const std::string& path) {
  const Format format = formatOfEnding(path);
  return format == Format::raw || format == Format::meta || format == Format::tiff;
}

}  // namespace vdb_madf
