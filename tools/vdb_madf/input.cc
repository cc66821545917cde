// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "input.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "command.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/files/output_file.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/method/segmentation_metadata.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/volumes/image_box.h"
#include "vdb_madf/volumes/read_labels.h"
#include "vdb_madf/volumes/read_mask.h"

namespace vdb_madf::tools {

namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

std::optional<int> parseInt(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<Coord> parseCoord(const std::string& text, char separator) {
  const std::vector<std::string> parts = split(text, separator);
  if (parts.size() != 3) return std::nullopt;
  Coord coord;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<int> value = parseInt(parts[size_t(axis)]);
    if (!value) return std::nullopt;
    coord[axis] = *value;
  }
  return coord;
}

CoordBBox parseDomain(const std::string& text) {
  constexpr int kFarthest = 1 << 20;
  const std::vector<std::string> corners = split(text, ':');
  if (corners.size() == 2) {
    const std::optional<Coord> lower = parseCoord(corners[0], ','),
                               upper = parseCoord(corners[1], ',');
    if (lower && upper) {
      const CoordBBox box(*lower, *upper);
      if (!box.empty() && CoordBBox(Coord(-kFarthest), Coord(kFarthest)).isInside(box)) return box;
    }
  }
  throw WrongUsage("--domain " + text +
                   ": write x0,y0,z0:x1,y1,z1 (inclusive, x0 <= x1 ..., within +-1048576)");
}

std::string typeNames() {
  return "uint8, int8, uint16, int16, uint32, int32, float32 or float64";
}

bool sameFile(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return a == b || std::filesystem::equivalent(a, b, ignored);
}

/// All files that the outputs are written to: an .mhd has its samples in a file beside it.
std::vector<std::string> filesOf(const std::vector<std::string>& outputs) {
  std::vector<std::string> files;
  for (const std::string& output : outputs) {
    if (output.empty() || output == "-") continue;
    files.push_back(output);
    if (fileEnding(output) == ".mhd")
      files.push_back(std::filesystem::path(output).replace_extension(".raw").string());
  }
  return files;
}

bool isVdbFile(const std::string& path) {
  // OpenVDB's magic number: ' BDV' as a little-endian 64-bit integer.
  constexpr char kMagic[8] = {' ', 'B', 'D', 'V', 0, 0, 0, 0};
  std::ifstream file(path, std::ios::binary);
  char start[8] = {};
  if (file.read(start, 8) && std::memcmp(start, kMagic, 8) == 0) return true;
  return hasVdbEnding(path) && !looksLikeImage(path);
}

}  // namespace

double parseNumber(const std::string& text, const std::string& option) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value))
    throw WrongUsage(option + " " + text + ": not a finite number");
  return value;
}

Coord parseDims(const std::string& text, const std::string& option) {
  constexpr int kLargest = 1 << 20;
  const std::optional<Coord> size = parseCoord(text, 'x');
  if (!size || size->x() < 1 || size->y() < 1 || size->z() < 1 || size->x() > kLargest ||
      size->y() > kLargest || size->z() > kLargest)
    throw WrongUsage(option + " " + text +
                     ": write NXxNYxNZ, each from 1 to 1048576, for example 301x301x251");
  return *size;
}

VoxelSize parseVoxelSize(const std::string& text) {
  for (const auto& [unit, metres] :
       {std::pair<const char*, double>{"nm", 1e-9}, {"um", 1e-6}, {"mm", 1e-3}, {"m", 1.0}}) {
    const size_t length = std::strlen(unit);
    if (text.size() <= length || text.compare(text.size() - length, length, unit) != 0) continue;
    const std::string number = text.substr(0, text.size() - length);
    const double value = parseNumber(number, "--voxel-size");
    // Dividing by a power of ten keeps decimal inputs exact to the last bit.
    const double size = metres == 1.0 ? value : value / std::round(1 / metres);
    if (size >= 1e-10 && size <= 1) return {size};
    throw WrongUsage("--voxel-size " + text + ": must lie between 0.1nm and 1m");
  }
  throw WrongUsage("--voxel-size " + text + ": give a unit (nm, um, mm or m), for example 8.5um");
}

void InputOptions::addRaw(CLI::App& verb) {
  verb.add_option("--dims", dims, "RAW input: size NXxNYxNZ, x fastest");
  verb.add_option("--type", type,
                  "RAW input: its sample type (" + typeNames() + "); otherwise the output's");
  verb.add_flag("--big-endian", bigEndian, "RAW input: most significant byte first");
  verb.add_option("--dataset", dataset, "Zarr or HDF5 input: the array to read")->type_name("NAME");
}

void InputOptions::addSelection(CLI::App& verb) {
  verb.add_option("--phase", phase, "object: value equals V")->type_name("V");
  verb.add_option("--threshold", threshold, "object: value >= T")->type_name("T");
  verb.add_option("--range", range, "object: A <= value <= B")->type_name("A:B");
  verb.add_flag("--invert", invert, "object: all other voxels");
  verb.add_option("--grid", gridName, "VDB input: the grid to take")->type_name("NAME");
}

void InputOptions::addVoxelSize(CLI::App& verb) {
  verb.add_option("--voxel-size", voxelSizeText, "edge of a voxel with unit, for example 8.5um");
}

void InputOptions::addDomain(CLI::App& verb) {
  verb.add_option("--domain", domainText,
                  "image domain x0,y0,z0:x1,y1,z1 (inclusive), instead of the file's");
}

void InputOptions::parse() {
  if (!dims.empty()) size = parseDims(dims, "--dims");
  if (!type.empty()) {
    sampleType = sampleTypeFromName(type);
    if (!sampleType) throw WrongUsage("--type " + type + ": must be " + typeNames());
  }
  if (typeIsOfInput && sampleType && !size)
    throw WrongUsage("--type describes a RAW input: give --dims too");
  if (bigEndian && !size) throw WrongUsage("--big-endian describes a RAW input: give --dims too");
  if (size && !sampleType) throw WrongUsage("a RAW input needs --type: " + typeNames());
  if (int(!phase.empty()) + int(!threshold.empty()) + int(!range.empty()) > 1)
    throw WrongUsage("give only one of --phase, --threshold and --range");
  if (!phase.empty()) selection = Selection::phase(parseNumber(phase, "--phase"));
  if (!threshold.empty()) selection = Selection::threshold(parseNumber(threshold, "--threshold"));
  if (!range.empty()) {
    const std::vector<std::string> ends = split(range, ':');
    if (ends.size() != 2) throw WrongUsage("--range " + range + ": write A:B");
    selection = Selection::range(parseNumber(ends[0], "--range"), parseNumber(ends[1], "--range"));
    if (selection->low > selection->high)
      throw WrongUsage("--range " + range + ": the first value exceeds the second");
  }
  if (invert) {
    if (!selection) selection = Selection{};
    selection->invert = true;
  }
  if (!voxelSizeText.empty()) voxelSize = parseVoxelSize(voxelSizeText);
  if (!domainText.empty()) domain = parseDomain(domainText);
  const std::vector<std::string> files = filesOf(outputs);
  for (size_t i = 0; i < files.size(); ++i) {
    if (sameFile(path, files[i]))
      throw WrongUsage(files[i] + ": the output would overwrite the input; choose another name");
    for (size_t j = 0; j < i; ++j)
      if (sameFile(files[j], files[i]))
        throw WrongUsage(files[i] + ": two outputs would go to this file; choose another name");
  }
}

std::optional<RawLayout> InputOptions::rawLayout() const {
  if (!size) return std::nullopt;
  return RawLayout{toImageSize(*size), *sampleType, bigEndian};
}

bool isVdb(const InputOptions& input) {
  if (input.size || !isVdbFile(input.path)) return false;
  if (!input.dataset.empty())
    throw InvalidInput(input.path + ": --dataset is for Zarr and HDF5; choose with --grid here");
  return true;
}

bool hasVdbEnding(const std::string& path) {
  return fileEnding(path) == ".vdb";
}
bool hasTiffEnding(const std::string& path) {
  const std::string ending = fileEnding(path);
  return ending == ".tif" || ending == ".tiff";
}
bool hasRawEnding(const std::string& path) {
  return fileEnding(path) == ".raw";
}
bool hasPngEnding(const std::string& path) {
  return fileEnding(path) == ".png";
}

bool isNumericGrid(const openvdb::GridBase& grid) {
  const std::string type = grid.valueType();
  return grid.isType<MaskGrid>() || type == "bool" || type == "int32" || type == "int64" ||
         type == "float" || type == "double";
}

bool isLabelGrid(const openvdb::GridBase& grid) {
  return grid.isType<Int32Grid>();
}

openvdb::GridBase::Ptr chooseGrid(const std::vector<openvdb::GridBase::Ptr>& grids,
                                  const std::string& path, const std::string& name,
                                  const std::string& gridOption,
                                  const std::vector<std::string>& preferred,
                                  bool (*usable)(const openvdb::GridBase&)) {
  std::string list;
  std::vector<openvdb::GridBase::Ptr> candidates;
  for (const auto& grid : grids) {
    list += (list.empty() ? "" : ", ") + grid->getName() + " (" + grid->valueType() + ")";
    if (usable(*grid)) candidates.push_back(grid);
  }
  if (list.empty()) throw InvalidInput(path + ": the file holds no grid");
  if (!name.empty()) {
    for (const auto& grid : grids) {
      if (grid->getName() != name) continue;
      if (usable(*grid)) return grid;
      throw InvalidInput(path + ": grid '" + name + "' holds " + grid->valueType() +
                         " values, which this command cannot use");
    }
    throw InvalidInput(path + ": there is no grid '" + name + "'; the file holds " + list);
  }
  for (const std::string& wanted : preferred)
    for (const auto& grid : candidates)
      if (grid->getName() == wanted) return grid;
  if (candidates.size() == 1) return candidates[0];
  throw InvalidInput(path + ": " +
                     (!candidates.empty() ? "choose a grid with " + gridOption
                      : usable == isLabelGrid
                          ? "there is no grid of labels (int32), such as segment writes"
                          : "there is no grid of a mask or numbers") +
                     "; the file holds " + list);
}

std::unique_ptr<ImageReader> openInput(const InputOptions& input) {
  auto image = openImage(input.path, input.rawLayout(), input.dataset);
  for (const std::string& output : filesOf(input.outputs))
    for (const std::string& file : image->files())
      if (sameFile(file, output))
        throw InvalidInput(output + ": holds samples of " + input.path +
                           ", which the output would overwrite; choose another name");
  return image;
}

void checkWritable(const std::string& output) {
  const OutputFile probe(output);
}

Boundary parseBoundary(const std::string& boundary) {
  return boundary == "open"     ? Boundary::open
         : boundary == "closed" ? Boundary::closed
                                : Boundary::automatic;
}

void addBoundary(CLI::App& verb, std::string& boundary) {
  verb.add_option("--boundary", boundary,
                  "beyond the scan's faces: open: unknown, closed: background")
      ->check(CLI::IsMember({"auto", "open", "closed"}))
      ->capture_default_str();
}

Boundary boundaryOf(const std::string& boundary, const InputOptions& input,
                    const MaskGrid& object) {
  Boundary result = parseBoundary(boundary);
  if (result == Boundary::automatic) result = storedBoundary(object);
  if (result == Boundary::open && !storedDomain(object))
    throw InvalidInput(input.path +
                       ": its domain is unknown, so the boundary cannot be open: use --boundary "
                       "closed, or give --domain x0,y0,z0:x1,y1,z1");
  return result;
}

const char* hintIfEmpty(int64_t objectVoxels) {
  return objectVoxels > 0 ? ""
                          : ": nothing is selected (see --phase, --threshold, --range, --invert)";
}

MaskGrid::Ptr loadObject(const InputOptions& input, Interrupter* interrupter) {
  MaskGrid::Ptr object;
  if (isVdb(input)) {
    const auto grid = chooseGrid(readVdb(input.path, {}, interrupter), input.path, input.gridName,
                                 "--grid", {"object"}, isNumericGrid);
    if (input.domain) setDomain(*grid, *input.domain);  // an inversion needs it
    object = naming(input.path, [&] { return objectMask(*grid, input.selection); });
  } else {
    if (!input.gridName.empty())
      throw InvalidInput(input.path + ": --grid is for VDB files, and this is none");
    const auto image = openInput(input);
    object = readMask(*image, input.selection.value_or(Selection{}), interrupter);
  }
  if (input.domain) setDomain(*object, *input.domain);
  if (input.voxelSize) setVoxelSize(*object, input.voxelSize);
  object->setName("object");
  return object;
}

Int32Grid::Ptr loadLabels(const InputOptions& input, const std::string& gridOption,
                          Interrupter* interrupter) {
  if (isVdb(input)) {
    const auto grid = chooseGrid(readVdb(input.path, {}, interrupter), input.path, input.gridName,
                                 gridOption, {"grain", "truth"}, isLabelGrid);
    return openvdb::gridPtrCast<Int32Grid>(grid);
  }
  if (!input.gridName.empty())
    throw InvalidInput(input.path + ": " + gridOption + " is for VDB files, and this is none");
  const auto image = openInput(input);
  return readLabels(*image, interrupter);
}

}  // namespace vdb_madf::tools
