// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include <filesystem>
#include <optional>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/lower_case.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/key_value_header.h"
#include "vdb_madf/images/detail/stored_samples.h"

namespace vdb_madf::detail {

namespace {

/// A dozen lines.
constexpr size_t kMaxPyHstHeaderBytes = size_t(1) << 14;
const std::string kInfoEnding = ".info";

bool hasInfoEnding(const std::string& path) {
  return fileEnding(path) == kInfoEnding;
}

/// Lines of KEY = value; those that begin with an exclamation mark are comments.
KeyValueHeader pyHstHeader(const InputFile& file) {
  HeaderSyntax syntax;
  syntax.article = "an";
  syntax.name = ".info file";
  syntax.lacks = "lacks ";
  syntax.lineForm = "KEY = value";
  syntax.comment = '!';
  syntax.skipsBlankLines = true;
  if (file.size() > kMaxPyHstHeaderBytes)
    throw IoError(file.name() + ": is too long for an .info file");
  return KeyValueHeader(file.name(), file.head(kMaxPyHstHeaderBytes), syntax);
}

std::optional<VoxelSize> voxelSizeOf(const std::string& path, const KeyValueHeader& header) {
  const auto text = header.find("voxelSize");
  if (!text) return std::nullopt;
  const auto edge = reals(*text);
  if (!edge || edge->size() != 1) header.fail("voxelSize");
  return checkedVoxelSize(path, {edge->front(), edge->front(), edge->front()}, unitsPerMetre("um"));
}

bool isBigEndian(const KeyValueHeader& header) {
  const std::string order = header.find("BYTEORDER").value_or("LOWBYTEFIRST");
  if (order != "LOWBYTEFIRST" && order != "HIGHBYTEFIRST") header.fail("BYTEORDER");
  return order == "HIGHBYTEFIRST";
}

std::optional<SampleType> typeOf(const KeyValueHeader& header) {
  const auto name = header.find("DATA_TYPE");
  if (!name) return std::nullopt;
  auto known = sampleTypeFromName(lowerCase(*name));
  if (lowerCase(*name) == "float") known = SampleType::float32;
  if (lowerCase(*name) == "double") known = SampleType::float64;
  if (!known) header.fail("DATA_TYPE");
  return known;
}

SampleType typeBySize(const ImageInfo& info, uint64_t bytes) {
  const uint64_t voxels = imageBytes(info) / sampleSize(info.type);
  if (bytes == voxels) return SampleType::uint8;
  if (bytes == voxels * 2) return SampleType::uint16;
  return SampleType::float32;  // PyHST's own; another size does not pass the check of the samples
}

}  // namespace

bool isPyhstHeader(const std::string& head) {
  return head.compare(0, 7, "! PyHST") == 0 || head.compare(0, 5, "NUM_X") == 0;
}

std::unique_ptr<ImageReader> openPyhst(std::unique_ptr<InputFile> file) {
  const std::string path = file->path();
  const bool named = hasInfoEnding(path);
  const std::string infoPath = named ? path : path + kInfoEnding;
  std::error_code error;
  if (!named && !std::filesystem::exists(infoPath, error))
    throw IoError(path + ": is no DGtal file, and there is no " + infoPath +
                      " of PyHST beside it; if it is raw, give its size and type",
                  Hint::rawLayout);
  const auto infoFile = named ? std::move(file) : std::make_unique<InputFile>(path, infoPath);
  const KeyValueHeader header = pyHstHeader(*infoFile);
  ImageInfo info;
  info.format = "pyhst";
  info.size = checkedSize(path, {header.requireInteger("NUM_X"), header.requireInteger("NUM_Y"),
                                 header.requireInteger("NUM_Z")});
  info.voxelSize = voxelSizeOf(infoFile->name(), header);
  auto data =
      named ? std::make_unique<InputFile>(path, path.substr(0, path.size() - kInfoEnding.size()))
            : std::move(file);
  info.type = typeOf(header).value_or(typeBySize(info, data->size()));
  SampleLayout layout;
  layout.bigEndian = isBigEndian(header);
  return openSamples(path, info, std::move(data), layout, {infoPath});
}

}  // namespace vdb_madf::detail
