// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/meta_image.h"

#include <filesystem>
#include <map>
#include <optional>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/slice_counter.h"
#include "vdb_madf/images/formats/raw.h"

namespace vdb_madf::detail {

namespace {

/// Real headers have well under 2 KiB.
constexpr size_t kMaxHeaderBytes = size_t(1) << 16;

struct TypeName {
  const char* name;
  SampleType type;
};
constexpr TypeName kTypes[] = {
    {"MET_UCHAR", SampleType::uint8},   {"MET_CHAR", SampleType::int8},
    {"MET_USHORT", SampleType::uint16}, {"MET_SHORT", SampleType::int16},
    {"MET_UINT", SampleType::uint32},   {"MET_INT", SampleType::int32},
    {"MET_FLOAT", SampleType::float32}, {"MET_DOUBLE", SampleType::float64}};

/// The fields of a header, up to and with ElementDataFile.
class MetaHeader {
 public:
  explicit MetaHeader(const InputFile& file) : path_(file.name()) {
    const std::string head = file.head(kMaxHeaderBytes);
    while (dataOffset_ < head.size() && !find("ElementDataFile")) {
      const size_t end = std::min(head.find('\n', dataOffset_), head.size());
      const std::string line = trimmed(head.substr(dataOffset_, end - dataOffset_));
      dataOffset_ = std::min(end + 1, head.size());
      if (line.empty()) continue;
      const size_t equals = line.find('=');
      if (equals == std::string::npos)
        throw IoError(path_ + ": not a MetaImage header: the line " + quoted(line) +
                      " is not 'Key = Value'");
      fields_[trimmed(line.substr(0, equals))] = trimmed(line.substr(equals + 1));
    }
    require("ElementDataFile");
  }

  size_t dataOffset() const { return dataOffset_; }

  std::optional<std::string> find(const std::string& key) const {
    const auto found = fields_.find(key);
    if (found == fields_.end()) return std::nullopt;
    return found->second;
  }
  std::string require(const std::string& key) const {
    const auto value = find(key);
    if (!value || value->empty()) throw IoError(path_ + ": the MetaImage header lacks " + key);
    return *value;
  }
  int64_t integer(const std::string& key, int64_t otherwise) const {
    const auto text = find(key);
    if (!text) return otherwise;
    const auto values = integers(*text);
    if (!values || values->size() != 1) fail(key);
    return values->front();
  }
  bool flag(const std::string& key) const {
    const std::string text = lowerCase(find(key).value_or("false"));
    if (text == "true" || text == "1") return true;
    if (text != "false" && text != "0") fail(key);
    return false;
  }
  [[noreturn]] void fail(const std::string& key) const {
    throw IoError(path_ + ": " + key + " = " + quoted(find(key).value_or("")) +
                  " cannot be read in this MetaImage header");
  }

 private:
  std::string path_;
  std::map<std::string, std::string> fields_;
  size_t dataOffset_ = 0;
};

SampleType elementType(const MetaHeader& header) {
  const std::string name = header.require("ElementType");
  for (const TypeName& known : kTypes)
    if (name == known.name) return known.type;
  header.fail("ElementType");
}

std::optional<VoxelSize> elementSpacing(const std::string& path, const MetaHeader& header) {
  const char* key = header.find("ElementSpacing") ? "ElementSpacing" : "ElementSize";
  const auto text = header.find(key);
  if (!text) return std::nullopt;
  const auto values = reals(*text);
  if (!values || values->size() != 3) header.fail(key);
  const std::array<double, 3> spacing{(*values)[0], (*values)[1], (*values)[2]};
  if (spacing == std::array<double, 3>{1, 1, 1}) return std::nullopt;
  return cubicVoxelSize(path, spacing, unitsPerMetre("mm"));
}

std::string headerText(const ImageInfo& info, const std::array<double, 3>& origin,
                       const std::string& dataFile) {
  std::string text =
      "ObjectType = Image\nNDims = 3\nBinaryData = True\n"
      "BinaryDataByteOrderMSB = False\nCompressedData = False\nDimSize =";
  for (int axis = 0; axis < 3; ++axis) text += " " + std::to_string(info.size[axis]);
  if (info.voxelSize) {
    const std::string edge = lengthIn(1e3, info.voxelSize->metres);
    text += "\nElementSpacing = " + edge + " " + edge + " " + edge;
  }
  if (origin != std::array<double, 3>{}) {
    text += "\nOffset =";
    for (int axis = 0; axis < 3; ++axis) text += " " + shortestDecimal(origin[axis]);
  }
  text += "\nElementType = ";
  for (const TypeName& known : kTypes)
    if (known.type == info.type) text += known.name;
  return text + "\nElementDataFile = " + dataFile + "\n";
}

class MetaWriter : public ImageWriter {
 public:
  MetaWriter(const std::string& path, const ImageInfo& info, const std::array<double, 3>& origin)
      : counter_(path, info), out_(path) {
    const std::filesystem::path name(path);
    const bool local = fileEnding(path) == ".mha";
    const std::filesystem::path dataFile = std::filesystem::path(name).replace_extension(".raw");
    if (!local) data_.emplace(dataFile.string());
    const std::string text =
        headerText(info, origin, local ? "LOCAL" : dataFile.filename().string());
    out_.write(text.data(), text.size());
  }
  void write(int count, const void* samples) override {
    (data_ ? *data_ : out_).write(samples, counter_.add(count));
  }
  void finish() override {
    counter_.finish();
    if (data_) data_->close();
    out_.close();
    if (data_) data_->commit();
    out_.commit();
  }

 private:
  SliceCounter counter_;
  OutputStream out_;
  std::optional<OutputStream> data_;
};

}  // namespace

bool isMetaHeader(const std::string& head) {
  for (const char* key : {"ObjectType", "NDims"})
    if (head.compare(0, std::char_traits<char>::length(key), key) == 0 ||
        head.find(std::string("\n") + key) != std::string::npos)
      return true;
  return false;
}

std::unique_ptr<ImageReader> openMeta(const std::string& path) {
  auto file = std::make_unique<InputFile>(path);
  const MetaHeader header(*file);
  if (header.find("ObjectType").value_or("Image") != "Image") header.fail("ObjectType");
  if (header.integer("NDims", 3) != 3)
    throw IoError(path + ": NDims is not 3; only 3-D images can be read");
  if (header.find("BinaryData") && !header.flag("BinaryData"))
    throw IoError(path + ": its samples are text; write them in binary form");
  if (header.integer("ElementNumberOfChannels", 1) != 1)
    throw IoError(path + ": has several channels; convert it to grey values first");

  ImageInfo info;
  info.format = "mhd";
  const auto size = integers(header.require("DimSize"));
  if (!size) header.fail("DimSize");
  info.size = checkedSize(path, *size);
  info.type = elementType(header);
  info.voxelSize = elementSpacing(path, header);

  SampleLayout layout;
  layout.deflated = header.flag("CompressedData");
  layout.bigEndian = header.flag("BinaryDataByteOrderMSB") || header.flag("ElementByteOrderMSB");
  const int64_t headerSize = header.integer("HeaderSize", 0);
  if (headerSize < -1 || (headerSize == -1 && layout.deflated)) header.fail("HeaderSize");
  layout.atEnd = headerSize == -1;

  const std::string dataFile = header.require("ElementDataFile");
  if (dataFile == "LOCAL" || dataFile == "Local" || dataFile == "local") {
    if (headerSize <= 0)
      layout.offset = header.dataOffset();
    else
      layout.offset = uint64_t(headerSize);
    return openSamples(path, info, std::move(file), layout);
  }
  if (dataFile.compare(0, 4, "LIST") == 0 || dataFile.find('%') != std::string::npos)
    throw IoError(path + ": its data are spread over several files; write them into one");
  layout.offset = uint64_t(std::max<int64_t>(headerSize, 0));
  return openSamples(path, info, std::make_unique<InputFile>(path, besideHeader(path, dataFile)),
                     layout);
}

std::unique_ptr<ImageWriter> createMeta(const std::string& path, const ImageInfo& info,
                                        const std::array<double, 3>& origin) {
  return std::make_unique<MetaWriter>(path, info, origin);
}

}  // namespace vdb_madf::detail
