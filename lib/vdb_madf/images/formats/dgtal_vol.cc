// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/key_value_header.h"
#include "vdb_madf/images/detail/stored_samples.h"

namespace vdb_madf::detail {

namespace {

/// DGtal itself takes 20 lines of 128 characters.
constexpr size_t kMaxDgtalHeaderBytes = 4096;

/// Lines of "Key: value" up to a line with a full stop.
KeyValueHeader dgtalHeader(const InputFile& file) {
  HeaderSyntax syntax;
  syntax.name = "vol header";
  syntax.lacks = "the vol header lacks ";
  syntax.lineForm = "Key: value";
  syntax.separator = ':';
  syntax.endLine = ".";
  std::string text = file.head(kMaxDgtalHeaderBytes);
  text.erase(text.rfind('\n') + 1);  // a line that is cut short
  KeyValueHeader header(file.name(), text, syntax);
  if (!header.ended())
    throw IoError(file.name() + ": the header has no end, a line with a full stop");
  return header;
}

}  // namespace

bool isDgtalHeader(const std::string& head) {
  for (const char* key : {"\nVoxel-Size:", "\nLvoxel-Size:"})
    if (head.find(key) != std::string::npos &&
        (head.compare(0, 2, "X:") == 0 || head.find("\nX:") != std::string::npos))
      return true;
  return false;
}

std::unique_ptr<ImageReader> openDgtal(std::unique_ptr<InputFile> file) {
  const std::string path = file->path();
  const KeyValueHeader header = dgtalHeader(*file);
  const bool longVoxels = header.has("Lvoxel-Size");
  if (!header.has("Version"))
    throw IoError(path + ": is of version 1 of the format: write it again with DGtal");
  const int64_t version = header.requireInteger("Version");
  if (version != 2 && version != 3)
    throw IoError(path + ": is of version " + std::to_string(version) +
                  " of the format; only 2 and 3 can be read");
  ImageInfo info;
  info.format = longVoxels ? "longvol" : "vol";
  info.size = checkedSize(
      path, {header.requireInteger("X"), header.requireInteger("Y"), header.requireInteger("Z")});
  info.type = longVoxels ? SampleType::uint32 : SampleType::uint8;
  if (!longVoxels && header.has("Voxel-Size") && header.requireInteger("Voxel-Size") != 1)
    throw IoError(path + ": voxels of " + std::to_string(header.requireInteger("Voxel-Size")) +
                  " bytes cannot be read; a vol file has one, a longvol file eight");
  SampleLayout layout;
  layout.offset = header.dataOffset();
  layout.deflated = version == 3;
  // What Lvoxel-Size says is 4 for eight bytes, too.
  layout.is64Bit =
      longVoxels && (layout.deflated || file->size() - layout.offset != imageBytes(info));
  return openSamples(path, info, std::move(file), layout);
}

}  // namespace vdb_madf::detail
