// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/dgtal_vol.h"

#include <map>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/formats/raw.h"

namespace vdb_madf::detail {

namespace {

/// DGtal itself takes 20 lines of 128 characters.
constexpr size_t kMaxHeaderBytes = 4096;

/// Lines of "Key: value" up to a line with a full stop.
class DgtalHeader {
 public:
  explicit DgtalHeader(const InputFile& file) : path_(file.name()) {
    const std::string head = file.head(kMaxHeaderBytes);
    while (true) {
      const size_t end = head.find('\n', dataOffset_);
      if (end == std::string::npos)
        throw IoError(path_ + ": the header has no end, a line with a full stop");
      const std::string line = trimmed(head.substr(dataOffset_, end - dataOffset_));
      dataOffset_ = end + 1;
      if (line == ".") return;
      const size_t colon = line.find(':');
      if (colon == std::string::npos)
        throw IoError(path_ + ": not a vol header: the line " + quoted(line) +
                      " is not 'Key: value'");
      fields_[trimmed(line.substr(0, colon))] = trimmed(line.substr(colon + 1));
    }
  }

  size_t dataOffset() const { return dataOffset_; }
  bool has(const std::string& key) const { return fields_.count(key) > 0; }
  int64_t integer(const std::string& key) const {
    const auto found = fields_.find(key);
    if (found == fields_.end()) throw IoError(path_ + ": the vol header lacks " + key);
    const auto values = integers(found->second);
    if (!values || values->size() != 1)
      throw IoError(path_ + ": " + key + ": " + quoted(found->second) +
                    " cannot be read in this vol header");
    return values->front();
  }

 private:
  std::string path_;
  std::map<std::string, std::string> fields_;
  size_t dataOffset_ = 0;
};

}  // namespace

bool isDgtalHeader(const std::string& head) {
  for (const char* key : {"\nVoxel-Size:", "\nLvoxel-Size:"})
    if (head.find(key) != std::string::npos &&
        (head.compare(0, 2, "X:") == 0 || head.find("\nX:") != std::string::npos))
      return true;
  return false;
}

std::unique_ptr<ImageReader> openDgtal(const std::string& path) {
  auto file = std::make_unique<InputFile>(path);
  const DgtalHeader header(*file);
  const bool longVoxels = header.has("Lvoxel-Size");
  if (!header.has("Version"))
    throw IoError(path + ": is of version 1 of the format: write it again with DGtal");
  const int64_t version = header.integer("Version");
  if (version != 2 && version != 3)
    throw IoError(path + ": is of version " + std::to_string(version) +
                  " of the format; only 2 and 3 can be read");
  ImageInfo info;
  info.format = longVoxels ? "longvol" : "vol";
  info.size = checkedSize(path, {header.integer("X"), header.integer("Y"), header.integer("Z")});
  info.type = longVoxels ? SampleType::uint32 : SampleType::uint8;
  if (!longVoxels && header.has("Voxel-Size") && header.integer("Voxel-Size") != 1)
    throw IoError(path + ": voxels of " + std::to_string(header.integer("Voxel-Size")) +
                  " bytes cannot be read; a vol file has one, a longvol file eight");
  SampleLayout layout;
  layout.offset = header.dataOffset();
  layout.deflated = version == 3;
  // What Lvoxel-Size says is 4 for eight bytes, too.
  layout.wide = longVoxels && (layout.deflated || file->size() - layout.offset != imageBytes(info));
  return openSamples(path, info, std::move(file), layout);
}

}  // namespace vdb_madf::detail
