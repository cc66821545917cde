// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "input_options.h"

#include <fmt/core.h>
#include <openvdb/Metadata.h>

#include <algorithm>

#include "outputs.h"
#include "parse.h"
#include "vdb_madf/base/lower_case.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/base/word_list.h"
#include "vdb_madf/files/standard_streams.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_keys.h"
#include "vdb_madf/scans/filtered_image.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "wrong_usage.h"

namespace vdb_madf::tools {

namespace {

std::string typeNames() {
  return wordList(sampleTypeNames());
}

/// Runs `choose`; if the grid has to be named, the message says by which option.
template <typename Choose>
auto withGridOption(const InputOptions& input, const std::string& gridOption,
                    const Choose& choose) {
  try {
    return choose();
  } catch (const AmbiguousGrid& error) {
    throw InvalidInput(fmt::format("{}: choose a grid with {}; the file holds {}", input.path,
                                   gridOption, error.grids()));
  }
}

/// Runs `load`; if it has to be said what is object, the message says by which options.
template <typename Load>
MaskGrid::Ptr withObjectOptions(const InputOptions& input, const Load& load) {
  if (!isVdb(input)) checkNoGrid(input, "--grid");
  try {
    return withGridOption(input, "--grid", load);
  } catch (const SelectionNeeded& error) {
    const char* options = error.orCylinder() ? " (--roi cylinder, or --threshold VALUE)"
                          : input.gray.automatic == AutomaticThreshold::none
                              ? " (--threshold otsu or a value, --phase, --range; labels of "
                                "grains: convert --labels)"
                              : " (--threshold VALUE)";
    throw InvalidInput(error.what() + std::string(options));
  }
}

}  // namespace

void InputOptions::addRaw(Verb verb) {
  verb.option("--dims", dims, "RAW input: size NXxNYxNZ, x fastest");
  verb.option("--type", type,
              "RAW input: its sample type (" + typeNames() + "); otherwise the output's")
      .offer(sampleTypeNames());
  verb.flag("--big-endian", bigEndian, "RAW input: most significant byte first");
  verb.option("--skip", skip, "RAW input: bytes before the first sample, a header")
      .typeName("BYTES");
  verb.option("--dataset", dataset, "Zarr or HDF5 input: the array to read").typeName("NAME");
}

void InputOptions::addSelection(Verb verb) {
  verb.option("--phase", phase, "object: value equals V, or one of V,W,...").typeName("V");
  verb.option("--threshold", threshold,
              "object: value >= T; otsu, valley: found in the histogram; LOW:HIGH: hysteresis")
      .typeName("T")
      .offer({"otsu", "valley"});
  verb.option("--range", range, "object: A <= value <= B").typeName("A:B");
  verb.flag("--invert", invert, "object: all other voxels");
  verb.option("--median", median, "image: first a median, of cubes of 2 R + 1 voxels (R: 1 to 3)")
      .typeName("R");
  verb.option("--smooth", smooth, "image: then a Gaussian of standard deviation S voxels")
      .typeName("S");
  verb.option("--despeckle", despeckle, "last: drop islands, fill cavities under N voxels")
      .typeName("N");
  verb.option("--grid", gridName, "VDB input: the grid to take").typeName("NAME");
}

void InputOptions::addVoxelSize(Verb verb) {
  verb.option("--voxel-size", voxelSizeText,
              "edge of a voxel with unit, for example 8.5um, or its three: 0.5x0.5x1.2um");
}

void InputOptions::addDomain(Verb verb) {
  verb.option("--domain", domainText,
              "image domain x0,y0,z0:x1,y1,z1 (inclusive), instead of the file's");
}

void InputOptions::addRegion(Verb verb) {
  verb.option("--roi", roi,
              "work within a region: cylinder[:x|y|z[:CX,CY[:RADIUS]]], or a mask, not 0 inside")
      .typeName("REGION")
      .offer({"cylinder"});
  verb.option("--crop", cropText, "work within x0,y0,z0:x1,y1,z1 (inclusive); coordinates stay")
      .typeName("BOX");
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
  if (!skip.empty() && !size) throw WrongUsage("--skip describes a RAW input: give --dims too");
  if (!skip.empty()) bytesToSkip = uint64_t(parseCount(skip, "--skip"));
  if (size && !sampleType) throw WrongUsage("a RAW input needs --type: " + typeNames());
  parseSelection();
  parseGray();
  if (!voxelSizeText.empty()) voxelSize = parseVoxelSize(voxelSizeText);
  if (!domainText.empty()) domain = parseBox(domainText, "--domain");
  parseRegion();
  checkOutputs(outputs, path);
  if (isStandardInput(path)) keepStandardInput();  // before signals are caught: it may have to wait
}

void InputOptions::parseRegion() {
  if (!roi.empty()) region = parseRoi(roi);
  if (!cropText.empty()) region.crop = parseBox(cropText, "--crop");
  if (region.mask.empty()) return;
  if (isStandardInput(region.mask))
    throw WrongUsage("--roi " + roi + ": a region is read from a file");
  if (hasRawEnding(region.mask))
    throw WrongUsage("--roi " + roi +
                     ": a RAW file does not say how large it is: convert it to .tif or .npy first");
  checkOutputs(outputs, region.mask);
}

void InputOptions::parseSelection() {
  if (int(!phase.empty()) + int(!threshold.empty()) + int(!range.empty()) > 1)
    throw WrongUsage("give only one of --phase, --threshold and --range");
  if (!phase.empty()) {
    std::vector<double> values;
    for (const std::string& value : split(phase, ','))
      values.push_back(parseNumber(value, "--phase"));
    selection = Selection::phases(values);
  }
  const std::string automatic = lowerCase(threshold);
  if (automatic == "otsu" || automatic == "valley") {
    gray.automatic = automatic == "otsu" ? AutomaticThreshold::otsu : AutomaticThreshold::valley;
    selection = Selection::threshold(0);  // to be replaced
  } else if (!threshold.empty()) {
    const std::vector<std::string> parts = split(threshold, ':');
    if (parts.size() > 2)
      throw WrongUsage("--threshold " + threshold + ": write T, LOW:HIGH, otsu or valley");
    selection = Selection::threshold(parseNumber(parts.back(), "--threshold"));
    if (parts.size() == 2) {
      gray.low = parseNumber(parts[0], "--threshold");
      if (*gray.low > selection->low)
        throw WrongUsage("--threshold " + threshold + ": the first value exceeds the second");
    }
  }
  if (!range.empty()) {
    const std::vector<std::string> ends = split(range, ':');
    if (ends.size() != 2 || ends[0].empty() || ends[1].empty())
      throw WrongUsage("--range " + range +
                       ": write A:B, for example 1:5; --threshold A takes all from A on");
    selection = Selection::range(parseNumber(ends[0], "--range"), parseNumber(ends[1], "--range"));
    if (selection->low > selection->high)
      throw WrongUsage("--range " + range + ": the first value exceeds the second");
  }
  if (invert) {
    if (!selection) selection = Selection{};
    selection->invert = true;
  }
}

void InputOptions::parseGray() {
  if (!median.empty()) {
    const int64_t radius = parseCount(median, "--median");
    if (radius > kMaxMedianRadius)
      throw WrongUsage(
          fmt::format("--median {}: must be a radius of 0 to {} voxels", median, kMaxMedianRadius));
    gray.median = int(radius);
  }
  if (!smooth.empty()) {
    gray.smooth = parseNumber(smooth, "--smooth");
    if (gray.smooth != 0 && !(gray.smooth >= kMinSmoothing && gray.smooth <= kMaxSmoothing))
      throw WrongUsage(
          fmt::format("--smooth {}: must be 0, or 0.1 to {} voxels", smooth, int(kMaxSmoothing)));
  }
  if (!despeckle.empty()) gray.despeckle = parseCount(despeckle, "--despeckle");
}

VolumeOptions InputOptions::volume(Progress* progress) const {
  VolumeOptions options;
  options.grid = gridName;
  options.dataset = dataset;
  if (size) options.raw = RawLayout{toImageSize(*size), *sampleType, bigEndian, bytesToSkip};
  options.selection = selection;
  options.gray = gray;
  options.voxelSize = voxelSize;
  options.domain = domain;
  options.region = region;
  options.outputs = filesOf(outputs);
  options.longestSide = longestSide;
  options.areLabels = areLabels;
  options.note = [progress](const std::string& text, NoteAbout about) {
    progress->note(text + (about == NoteAbout::voxelSize  ? " (--voxel-size)"
                           : about == NoteAbout::labels   ? " (convert --labels keeps them apart)"
                           : about == NoteAbout::cylinder ? " (--roi cylinder)"
                                                          : ""));
  };
  return options;
}

bool isVdb(const InputOptions& input) {
  if (input.size || !isVdbFile(input.path)) return false;
  if (!input.dataset.empty())
    throw InvalidInput(input.path + ": --dataset is for Zarr and HDF5; choose with --grid here");
  return true;
}

void checkNoGrid(const InputOptions& input, const std::string& gridOption) {
  if (!input.gridName.empty())
    throw InvalidInput(input.path + ": " + gridOption + " is for VDB files, and this is none");
}

openvdb::GridBase::Ptr chooseGrid(const InputOptions& input,
                                  const std::vector<openvdb::GridBase::Ptr>& grids, GridUse use) {
  return withGridOption(input, "--grid", [&] {
    return vdb_madf::chooseGrid(grids, input.path, use, input.gridName);
  });
}

MaskGrid::Ptr streamObject(const InputOptions& input, const TakeLayer& take,
                           const ObjectShare& share, Progress* progress) {
  return withObjectOptions(input, [&] {
    return vdb_madf::streamObject(input.path, input.volume(progress), take, share, progress);
  });
}

MaskGrid::Ptr loadObject(const InputOptions& input, Progress* progress) {
  const MaskGrid::Ptr object = withObjectOptions(
      input, [&] { return vdb_madf::loadObject(input.path, input.volume(progress), progress); });
  if (input.selection && object->empty())
    progress->note(input.path +
                   (input.gray.despeckle > 0
                        ? ": nothing is left after --despeckle, or was selected"
                        : hintIfEmpty(0)) +
                   "; vdb_madf info says what values there are");
  return object;
}

namespace {

/// Says what memory labels take, before all slabs of a folder are read.
void noteMemory(const InputOptions& input, Progress* progress) {
  constexpr int64_t kLeafBytes = 2224;
  int64_t leaves = 0;
  for (const openvdb::GridBase::Ptr& grid : readVdbHeaders(input.path, progress))
    if (const auto count = grid->getMetadata<openvdb::Int64Metadata>("madf_leaves"))
      leaves = std::max(leaves, count->value());
  if (leaves == 0) return;
  const int64_t free = availableMemory();
  progress->note(fmt::format("{}: its labels are needed in memory together: about {}{}", input.path,
                             readableBytes(leaves * kLeafBytes),
                             free ? fmt::format(", and {} are free", readableBytes(free)) : ""));
}

}  // namespace

Int32Grid::Ptr loadLabels(const InputOptions& input, const std::string& gridOption,
                          Progress* progress) {
  if (isInSlabs(input)) noteMemory(input, progress);
  if (!isVdb(input)) checkNoGrid(input, gridOption);
  return withGridOption(input, gridOption, [&] {
    return vdb_madf::loadLabels(input.path, input.volume(progress), progress);
  });
}

bool cutsGray(const InputOptions& input) {
  return readsGray(input.gray) ||
         (input.selection && input.selection->kind == Selection::Kind::threshold);
}

bool isInSlabs(const InputOptions& input) {
  return isVdb(input) && isSlabFolder(input.path);
}

LabelSlabs openLabelSlabs(const InputOptions& input, const std::string& gridOption,
                          Progress* progress) {
  return withGridOption(input, gridOption, [&] {
    return vdb_madf::openLabelSlabs(input.path, input.volume(progress), progress);
  });
}

std::optional<LabelSlabs> openBoxSlabs(const InputOptions& input, const std::string& gridOption,
                                       Progress* progress) {
  if (!isInSlabs(input)) return std::nullopt;
  LabelSlabs labels = openLabelSlabs(input, gridOption, progress);
  const auto domain = storedDomain(*labels.about);
  if (!domain || !domain->isBox()) return std::nullopt;
  return labels;
}

AnyLabels loadAnyLabels(const InputOptions& input, const std::string& gridOption,
                        Progress* progress) {
  if (const auto slabs = openBoxSlabs(input, gridOption, progress)) return *slabs;
  return Int32Grid::ConstPtr(loadLabels(input, gridOption, progress));
}

void addBoundary(Verb verb, std::string& boundary) {
  verb.option("--boundary", boundary, "beyond the scan's faces: open: unknown, closed: background")
      .oneOf({"auto", "open", "closed"})
      .showDefault();
}

Boundary boundaryOf(const std::string& boundary, const InputOptions& input, const MaskGrid& object,
                    Progress* progress) {
  Boundary result = parseBoundary(boundary);
  if (result == Boundary::automatic) result = storedBoundary(object);
  if (result == Boundary::open && !storedDomain(object))
    throw InvalidInput(input.path +
                       ": its domain is unknown, so the boundary cannot be open: use --boundary "
                       "closed, or give --domain x0,y0,z0:x1,y1,z1");
  const std::string note = noteOnBoundary(result, storedDomain(object));
  if (!note.empty()) progress->note(input.path + ": " + note);
  return result;
}

void addDensity(Verb verb, std::string& density, bool& ice) {
  verb.option("--density", density, "of the grains' material, kg/m3: adds what is per mass")
      .typeName("D");
  verb.flag("--ice", ice, "the density of ice: --density 917");
}

std::string objectSteps(const openvdb::GridBase& grid) {
  const auto steps = grid.getMetadata<openvdb::StringMetadata>(kObjectKey);
  return steps ? steps->value() : "";
}

std::string regionText(const Domain& domain) {
  return fmt::format("{} of {} voxels of the box", int64_t(domain.voxelCount()),
                     int64_t(Domain(domain.box()).voxelCount()));
}

const char* hintIfEmpty(int64_t objectVoxels) {
  return objectVoxels > 0 ? ""
                          : ": nothing is selected (see --phase, --threshold, --range, --invert)";
}

}  // namespace vdb_madf::tools
