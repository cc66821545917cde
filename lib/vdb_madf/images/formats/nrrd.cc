// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/lower_case.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/key_value_header.h"
#include "vdb_madf/images/detail/stored_samples.h"

namespace vdb_madf::detail {

namespace {

/// Headers hold key-value pairs of any program (DICOM tags, say), so they are allowed to be long.
constexpr size_t kMaxNrrdHeaderBytes = size_t(1) << 20;
/// A line skip beyond this is no header of text.
constexpr int64_t kMaxLines = 1 << 20;
/// Largest cosine between axes that still counts as a right angle.
constexpr double kShear = 1e-3;

std::optional<SampleType> typeFromName(const std::string& name) {
  static const std::map<std::string, SampleType> kNrrdTypes = {
      {"signed char", SampleType::int8},
      {"int8", SampleType::int8},
      {"int8_t", SampleType::int8},
      {"uchar", SampleType::uint8},
      {"unsigned char", SampleType::uint8},
      {"uint8", SampleType::uint8},
      {"uint8_t", SampleType::uint8},
      {"short", SampleType::int16},
      {"short int", SampleType::int16},
      {"signed short", SampleType::int16},
      {"signed short int", SampleType::int16},
      {"int16", SampleType::int16},
      {"int16_t", SampleType::int16},
      {"ushort", SampleType::uint16},
      {"unsigned short", SampleType::uint16},
      {"unsigned short int", SampleType::uint16},
      {"uint16", SampleType::uint16},
      {"uint16_t", SampleType::uint16},
      {"int", SampleType::int32},
      {"signed int", SampleType::int32},
      {"int32", SampleType::int32},
      {"int32_t", SampleType::int32},
      {"uint", SampleType::uint32},
      {"unsigned int", SampleType::uint32},
      {"uint32", SampleType::uint32},
      {"uint32_t", SampleType::uint32},
      {"float", SampleType::float32},
      {"double", SampleType::float64}};
  const auto found = kNrrdTypes.find(lowerCase(name));
  if (found == kNrrdTypes.end()) return std::nullopt;
  return found->second;
}

/// "line skip", "lineskip" and "Line Skip" are one field.
std::string fieldName(const std::string& text) {
  std::string name = lowerCase(text);
  name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
  return name;
}

HeaderSyntax nrrdSyntax() {
  HeaderSyntax syntax;
  syntax.article = "an";
  syntax.name = "NRRD header";
  syntax.lacks = "the NRRD header lacks ";
  syntax.lineForm = "field: value";
  syntax.separator = ':';
  syntax.foreignSeparator = ":=";
  syntax.comment = '#';
  syntax.endLine = "";
  syntax.canonicalKey = fieldName;
  return syntax;
}

/// The fields after the first line; the data follow an empty one.
KeyValueHeader nrrdHeader(const InputFile& file) {
  const std::string text = file.head(kMaxNrrdHeaderBytes);
  if (text.compare(0, 4, "NRRD") != 0) throw IoError(file.name() + ": does not begin with NRRD");
  const size_t second = std::min(text.find('\n'), text.size() - 1) + 1;
  KeyValueHeader header(file.name(), text, nrrdSyntax(), second);
  if (!header.ended() && file.size() > kMaxNrrdHeaderBytes)
    throw IoError(file.name() + ": the NRRD header has no end");
  return header;
}

/// The unit that all three quoted names agree on: "mm" "mm" "mm".
std::optional<double> commonUnit(const std::string& path, const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  std::vector<std::optional<double>> units;
  size_t begin = 0;
  while ((begin = text->find('"', begin)) != std::string::npos) {
    const size_t end = text->find('"', begin + 1);
    if (end == std::string::npos) break;
    units.push_back(unitsPerMetre(text->substr(begin + 1, end - begin - 1)));
    begin = end + 1;
  }
  if (units.size() != 3) return std::nullopt;
  if (units[0] != units[1] || units[0] != units[2])
    throw IoError(path + ": its axes have different units: " + inQuotes(*text));
  return units[0];
}

/// "(1,2,3) (4,5,6)" becomes numbers with blanks between them.
std::string withoutParentheses(std::string vectors) {
  for (char& c : vectors)
    if (c == '(' || c == ')' || c == ',') c = ' ';
  return vectors;
}

void setSpacingOfDirections(ImageInfo& info, const std::string& path,
                            const KeyValueHeader& header) {
  const std::string text = header.require("spacedirections");
  if (std::count(text.begin(), text.end(), '(') != 3) header.fail("spacedirections");
  const auto values = reals(withoutParentheses(text));
  if (!values || values->size() != 9) header.fail("spacedirections");
  const auto dot = [&](int a, int b) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += (*values)[size_t(3 * a + i)] * (*values)[size_t(3 * b + i)];
    return sum;
  };
  std::array<double, 3> spacing;
  for (int axis = 0; axis < 3; ++axis) spacing[size_t(axis)] = std::sqrt(dot(axis, axis));
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3;
    if (std::abs(dot(axis, next)) > kShear * spacing[size_t(axis)] * spacing[size_t(next)])
      throw IoError(path + ": its space directions are sheared: resample it to cubic voxels");
  }
  setSpacing(info, path, spacing, commonUnit(path, header.find("spaceunits")));
  const auto place = reals(withoutParentheses(header.find("spaceorigin").value_or("")));
  if (!place || place->size() != 3) return;
  for (size_t axis = 0; axis < 3; ++axis)
    info.isPlaced |= isVoxelAway((*place)[axis], spacing[axis]);
}

void setSpacingOf(ImageInfo& info, const std::string& path, const KeyValueHeader& header) {
  if (header.find("spacedirections")) return setSpacingOfDirections(info, path, header);
  const auto text = header.find("spacings");
  if (!text) return;
  const auto values = reals(*text);
  if (!values || values->size() != 3) header.fail("spacings");
  if (std::all_of(values->begin(), values->end(), [](double s) { return s != s; }))
    return;  // NaN: unknown, by the definition of the format
  auto units = header.find("units");
  if (!units) units = header.find("spaceunits");
  setSpacing(info, path, {(*values)[0], (*values)[1], (*values)[2]}, commonUnit(path, units));
}

/// The offset after `lines` lines of text from `offset` on.
uint64_t skipLines(const InputFile& file, uint64_t offset, int64_t lines) {
  std::string chunk;
  while (lines > 0) {
    if (offset >= file.size())
      throw IoError(file.name() + ": has fewer lines than its header wants skipped");
    chunk.resize(size_t(std::min<uint64_t>(1 << 16, file.size() - offset)));
    file.read(offset, chunk.data(), chunk.size());
    size_t used = 0;
    while (lines > 0 && used < chunk.size()) {
      const size_t end = chunk.find('\n', used);
      if (end == std::string::npos) {
        used = chunk.size();
      } else {
        used = end + 1;
        --lines;
      }
    }
    offset += used;
  }
  return offset;
}

SampleLayout layoutOf(const std::string& path, const KeyValueHeader& header, SampleType type) {
  SampleLayout layout;
  const std::string encoding = lowerCase(header.require("encoding"));
  layout.deflated = encoding == "gzip" || encoding == "gz";
  if (!layout.deflated && encoding != "raw")
    throw IoError(path + ": encoding " + inQuotes(encoding) + " cannot be read; write raw or gzip");
  const std::string endian = lowerCase(header.find("endian").value_or(""));
  if (endian != "little" && endian != "big" && (!endian.empty() || sampleSize(type) > 1))
    throw IoError(path + ": the NRRD header does not say endian: little or big");
  layout.bigEndian = endian == "big";
  return layout;
}

/// An origin needs a space, and the edges as vectors in it.
std::string placedEdges(const std::array<std::string, 3>& edges,
                        const std::array<double, 3>& origin) {
  std::string place;
  for (int axis = 0; axis < 3; ++axis) place += (axis ? "," : "") + shortestDecimal(origin[axis]);
  return "\nspace dimension: 3\nspace directions: (" + edges[0] + ",0,0) (0," + edges[1] +
         ",0) (0,0," + edges[2] + ")\nspace origin: (" + place + ")";
}

std::string headerText(const ImageInfo& info, const std::array<double, 3>& origin) {
  const std::map<SampleType, std::string> names = {
      {SampleType::uint8, "uint8"},   {SampleType::int8, "int8"},
      {SampleType::uint16, "uint16"}, {SampleType::int16, "int16"},
      {SampleType::uint32, "uint32"}, {SampleType::int32, "int32"},
      {SampleType::float32, "float"}, {SampleType::float64, "double"}};
  std::string text = "NRRD0004\ntype: " + names.at(info.type) + "\ndimension: 3\nsizes:";
  for (int axis = 0; axis < 3; ++axis) text += " " + std::to_string(info.size[axis]);
  const std::array<std::string, 3> edges = info.voxelSize
                                               ? lengthsIn(1e3, info.voxelSize->edges())
                                               : std::array<std::string, 3>{"1", "1", "1"};
  if (origin != std::array<double, 3>{}) {
    text += placedEdges(edges, origin);
    if (info.voxelSize) text += "\nspace units: \"mm\" \"mm\" \"mm\"";
  } else if (info.voxelSize) {
    text += "\nspacings: " + edges[0] + " " + edges[1] + " " + edges[2];
    text += "\nunits: \"mm\" \"mm\" \"mm\"";
  }
  return text + "\nendian: little\nencoding: raw\n\n";
}

}  // namespace

std::unique_ptr<ImageReader> openNrrd(std::unique_ptr<InputFile> file) {
  const std::string path = file->path();
  const KeyValueHeader header = nrrdHeader(*file);
  ImageInfo info;
  info.format = "nrrd";
  const auto size = integers(header.require("sizes"));
  if (!size) header.fail("sizes");
  info.size = checkedSize(path, *size);
  if (header.findInteger("dimension").value_or(3) != 3) header.fail("dimension");
  const auto type = typeFromName(header.require("type"));
  if (!type) header.fail("type");
  info.type = *type;
  setSpacingOf(info, path, header);

  SampleLayout layout = layoutOf(path, header, info.type);
  if (const auto dataFile = header.find("datafile"))
    file = openDataFile(path, *dataFile);
  else
    layout.offset = header.dataOffset();
  const int64_t lines = header.findInteger("lineskip").value_or(0),
                bytes = header.findInteger("byteskip").value_or(0);
  if (lines < 0 || lines > kMaxLines) header.fail("lineskip");
  if (bytes < -1 || (bytes == -1 && layout.deflated)) header.fail("byteskip");
  layout.offset = skipLines(*file, layout.offset, lines);
  // Of compressed data, lines are skipped before and bytes after decompression.
  if (layout.deflated)
    layout.skip = uint64_t(bytes);
  else if (bytes == -1)
    layout.atEnd = true;
  else
    layout.offset += uint64_t(bytes);
  return openSamples(path, info, std::move(file), layout);
}

std::unique_ptr<ImageWriter> createNrrd(const std::string& path, const ImageInfo& info,
                                        const std::array<double, 3>& origin) {
  return createSamples(path, info, headerText(info, origin));
}

}  // namespace vdb_madf::detail
