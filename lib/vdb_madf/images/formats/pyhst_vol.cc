// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/pyhst_vol.h"

#include <filesystem>
#include <map>
#include <optional>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/formats/raw.h"

namespace vdb_madf::detail {

namespace {

/// A dozen lines.
constexpr size_t kMaxHeaderBytes = size_t(1) << 14;
const std::string kInfoEnding = ".info";

bool hasInfoEnding(const std::string& path) {
  return fileEnding(path) == kInfoEnding;
}

/// Lines of KEY = value; those that begin with an exclamation mark are comments.
class PyhstHeader {
 public:
  explicit PyhstHeader(const InputFile& file) : path_(file.name()) {
    const std::string text = file.head(kMaxHeaderBytes);
    if (file.size() > text.size()) throw IoError(path_ + ": is too long for an .info file");
    for (size_t begin = 0; begin < text.size();) {
      const size_t end = std::min(text.find('\n', begin), text.size());
      const std::string line = trimmed(text.substr(begin, end - begin));
      begin = end + 1;
      if (line.empty() || line[0] == '!') continue;
      const size_t equals = line.find('=');
      if (equals == std::string::npos)
        throw IoError(path_ + ": not an .info file: the line " + quoted(line) +
                      " is not 'KEY = value'");
      fields_[trimmed(line.substr(0, equals))] = trimmed(line.substr(equals + 1));
    }
  }

  std::optional<std::string> find(const std::string& key) const {
    const auto found = fields_.find(key);
    if (found == fields_.end()) return std::nullopt;
    return found->second;
  }
  int64_t integer(const std::string& key) const {
    const auto text = find(key);
    if (!text) throw IoError(path_ + ": lacks " + key);
    const auto values = integers(*text);
    if (!values || values->size() != 1) fail(key);
    return values->front();
  }
  std::optional<VoxelSize> voxelSize() const {
    const auto text = find("voxelSize");
    if (!text) return std::nullopt;
    const auto edge = reals(*text);
    if (!edge || edge->size() != 1) fail("voxelSize");
    return cubicVoxelSize(path_, {edge->front(), edge->front(), edge->front()},
                          unitsPerMetre("um"));
  }
  bool bigEndian() const {
    const std::string order = find("BYTEORDER").value_or("LOWBYTEFIRST");
    if (order != "LOWBYTEFIRST" && order != "HIGHBYTEFIRST") fail("BYTEORDER");
    return order == "HIGHBYTEFIRST";
  }
  std::optional<SampleType> type() const {
    const auto name = find("DATA_TYPE");
    if (!name) return std::nullopt;
    auto known = sampleTypeFromName(lowerCase(*name));
    if (lowerCase(*name) == "float") known = SampleType::float32;
    if (lowerCase(*name) == "double") known = SampleType::float64;
    if (!known) fail("DATA_TYPE");
    return known;
  }

 private:
  [[noreturn]] void fail(const std::string& key) const {
    throw IoError(path_ + ": " + key + " = " + quoted(find(key).value_or("")) +
                  " cannot be read in this .info file");
  }

  std::string path_;
  std::map<std::string, std::string> fields_;
};

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

std::unique_ptr<ImageReader> openPyhst(const std::string& path) {
  const bool named = hasInfoEnding(path);
  const std::string infoPath = named ? path : path + kInfoEnding;
  std::error_code error;
  if (!named && !std::filesystem::exists(infoPath, error))
    throw IoError(path + ": is no DGtal file, and there is no " + infoPath +
                  " of PyHST beside it; if it is raw, give its size and type (--dims, --type)");
  const PyhstHeader header(named ? InputFile(path) : InputFile(path, infoPath));
  ImageInfo info;
  info.format = "pyhst";
  info.size = checkedSize(
      path, {header.integer("NUM_X"), header.integer("NUM_Y"), header.integer("NUM_Z")});
  info.voxelSize = header.voxelSize();
  auto data =
      named ? std::make_unique<InputFile>(path, path.substr(0, path.size() - kInfoEnding.size()))
            : std::make_unique<InputFile>(path);
  info.type = header.type().value_or(typeBySize(info, data->size()));
  SampleLayout layout;
  layout.bigEndian = header.bigEndian();
  return openSamples(path, info, std::move(data), layout, {infoPath});
}

}  // namespace vdb_madf::detail
