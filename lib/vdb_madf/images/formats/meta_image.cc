// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include <filesystem>
#include <optional>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/lower_case.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/files/same_file.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/key_value_header.h"
#include "vdb_madf/images/detail/slice_counter.h"
#include "vdb_madf/images/detail/stored_samples.h"

namespace vdb_madf::detail {

namespace {

/// Real headers have well under 2 KiB.
constexpr size_t kMaxMetaHeaderBytes = size_t(1) << 16;

struct TypeName {
  const char* name;
  SampleType type;
};
constexpr TypeName kMetaTypes[] = {
    {"MET_UCHAR", SampleType::uint8},   {"MET_CHAR", SampleType::int8},
    {"MET_USHORT", SampleType::uint16}, {"MET_SHORT", SampleType::int16},
    {"MET_UINT", SampleType::uint32},   {"MET_INT", SampleType::int32},
    {"MET_FLOAT", SampleType::float32}, {"MET_DOUBLE", SampleType::float64}};

HeaderSyntax metaSyntax() {
  HeaderSyntax syntax;
  syntax.name = "MetaImage header";
  syntax.lacks = "the MetaImage header lacks ";
  syntax.lineForm = "Key = Value";
  syntax.endKey = "ElementDataFile";
  syntax.skipsBlankLines = true;
  return syntax;
}

bool flag(const KeyValueHeader& header, const std::string& key) {
  const std::string text = lowerCase(header.find(key).value_or("false"));
  if (text == "true" || text == "1") return true;
  if (text != "false" && text != "0") header.fail(key);
  return false;
}

SampleType elementType(const KeyValueHeader& header) {
  const std::string name = header.require("ElementType");
  for (const TypeName& known : kMetaTypes)
    if (name == known.name) return known.type;
  header.fail("ElementType");
}

std::optional<VoxelSize> elementSpacing(const std::string& path, const KeyValueHeader& header) {
  const char* key = header.find("ElementSpacing") ? "ElementSpacing" : "ElementSize";
  const auto text = header.find(key);
  if (!text) return std::nullopt;
  const auto values = reals(*text);
  if (!values || values->size() != 3) header.fail(key);
  const std::array<double, 3> spacing{(*values)[0], (*values)[1], (*values)[2]};
  if (spacing == std::array<double, 3>{1, 1, 1}) return std::nullopt;
  return checkedVoxelSize(path, spacing, unitsPerMetre("mm"));
}

bool isPlaced(const KeyValueHeader& header, const std::optional<VoxelSize>& size) {
  for (const char* key : {"Offset", "Position", "Origin"})
    if (const auto place = reals(header.find(key).value_or("")); place && place->size() == 3)
      for (size_t axis = 0; axis < 3; ++axis)
        if (isVoxelAway((*place)[axis], size ? 1e3 * size->edges()[axis] : 1)) return true;
  return false;
}

std::string headerText(const ImageInfo& info, const std::array<double, 3>& origin,
                       const std::string& dataFile) {
  std::string text =
      "ObjectType = Image\nNDims = 3\nBinaryData = True\n"
      "BinaryDataByteOrderMSB = False\nCompressedData = False\nDimSize =";
  for (int axis = 0; axis < 3; ++axis) text += " " + std::to_string(info.size[axis]);
  if (info.voxelSize) {
    text += "\nElementSpacing =";
    for (const std::string& edge : lengthsIn(1e3, info.voxelSize->edges())) text += " " + edge;
  }
  if (origin != std::array<double, 3>{}) {
    text += "\nOffset =";
    for (int axis = 0; axis < 3; ++axis) text += " " + shortestDecimal(origin[axis]);
  }
  text += "\nElementType = ";
  for (const TypeName& known : kMetaTypes)
    if (known.type == info.type) text += known.name;
  return text + "\nElementDataFile = " + dataFile + "\n";
}

/// Where the samples of an .mhd go.
std::string dataFileOf(const std::string& header) {
  return std::filesystem::path(header).replace_extension(".raw").string();
}

bool namesDataFile(const std::string& header, const std::string& data) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(header, ignored)) return false;
  const std::string text = InputFile(header).head(kMaxMetaHeaderBytes);
  try {
    const KeyValueHeader fields(header, text, metaSyntax());
    const auto name = fields.find("ElementDataFile");
    return name && isSameFile(besideHeader(header, *name), data);
  } catch (const IoError&) {  // no header of such an image
    return false;
  }
}

class MetaWriter : public ImageWriter {
 public:
  MetaWriter(const std::string& path, const ImageInfo& info, const std::array<double, 3>& origin)
      : counter_(path, info), out_(path) {
    const bool local = fileEnding(path) == ".mha";
    const std::string dataFile = dataFileOf(path);
    checkMetaPlace(path);
    if (!local) data_.emplace(dataFile);
    const std::string header = headerText(
        info, origin, local ? "LOCAL" : std::filesystem::path(dataFile).filename().string());
    out_.text(header);
    if (local) before_ = header.size();
  }
  void write(int count, const void* samples) override {
    (data_ ? *data_ : out_).bytes(samples, counter_.add(count));
  }
  void finish() override {
    counter_.finish();
    OutputSet files;
    if (data_) data_->commit();
    out_.commit();
    files.commit();
  }
  std::optional<SharedImage> share() override {
    return shareSamples(counter_, data_ ? *data_ : out_, before_);
  }

 private:
  SliceCounter counter_;
  OutputStream out_;
  std::optional<OutputStream> data_;
  uint64_t before_ = 0;  // bytes before the samples in their file
};

}  // namespace

bool isMetaHeader(const std::string& head) {
  for (const char* key : {"ObjectType", "NDims"})
    if (head.compare(0, std::char_traits<char>::length(key), key) == 0 ||
        head.find(std::string("\n") + key) != std::string::npos)
      return true;
  return false;
}

std::unique_ptr<ImageReader> openMeta(std::unique_ptr<InputFile> file) {
  const std::string path = file->path();
  const KeyValueHeader header(path, file->head(kMaxMetaHeaderBytes), metaSyntax());
  const std::string dataFile = header.require("ElementDataFile");
  if (header.find("ObjectType").value_or("Image") != "Image") header.fail("ObjectType");
  if (header.findInteger("NDims").value_or(3) != 3)
    throw IoError(path + ": NDims is not 3; only 3-D images can be read");
  if (header.find("BinaryData") && !flag(header, "BinaryData"))
    throw IoError(path + ": its samples are text; write them in binary form");
  if (header.findInteger("ElementNumberOfChannels").value_or(1) != 1)
    throw IoError(path + ": has several channels; convert it to gray values first");

  ImageInfo info;
  info.format = "mhd";
  const auto size = integers(header.require("DimSize"));
  if (!size) header.fail("DimSize");
  info.size = checkedSize(path, *size);
  info.type = elementType(header);
  info.voxelSize = elementSpacing(path, header);
  info.isPlaced = isPlaced(header, info.voxelSize);

  SampleLayout layout;
  layout.deflated = flag(header, "CompressedData");
  layout.bigEndian = flag(header, "BinaryDataByteOrderMSB") || flag(header, "ElementByteOrderMSB");
  const int64_t headerSize = header.findInteger("HeaderSize").value_or(0);
  if (headerSize < -1 || (headerSize == -1 && layout.deflated)) header.fail("HeaderSize");
  layout.atEnd = headerSize == -1;

  if (dataFile == "LOCAL" || dataFile == "Local" || dataFile == "local") {
    if (headerSize <= 0)
      layout.offset = header.dataOffset();
    else
      layout.offset = uint64_t(headerSize);
    return openSamples(path, info, std::move(file), layout);
  }
  layout.offset = uint64_t(std::max<int64_t>(headerSize, 0));
  return openSamples(path, info, openDataFile(path, dataFile), layout);
}

void checkMetaPlace(const std::string& path) {
  if (fileEnding(path) == ".mha") return;
  const std::string data = dataFileOf(path);
  std::error_code ignored;
  if (std::filesystem::exists(data, ignored) && !namesDataFile(path, data))
    throw IoError("cannot write " + path + ": its samples would replace " + data +
                  ", which is there and not part of it; move that away, choose another name, or "
                  "write .mha, which is one file");
}

std::unique_ptr<ImageWriter> createMeta(const std::string& path, const ImageInfo& info,
                                        const std::array<double, 3>& origin) {
  return std::make_unique<MetaWriter>(path, info, origin);
}

}  // namespace vdb_madf::detail
