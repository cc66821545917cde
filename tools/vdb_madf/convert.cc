// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <fmt/core.h>
#include <openvdb/tools/Count.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <memory>

#include "command.h"
#include "grid_image.h"
#include "input_options.h"
#include "member_failure.h"
#include "outputs.h"
#include "parse.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/word_list.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/grids/resampled_grid.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/labels/label_sizes.h"
#include "vdb_madf/scans/copy_image.h"
#include "vdb_madf/scans/histogram.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/scans/resampled_image.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "vdb_madf/volumes/image_losses.h"

namespace vdb_madf::tools {

namespace {

struct ConvertArguments {
  InputOptions input;
  std::string out, outType, boundary = "auto", resample;
  bool labels = false;
  std::optional<SampleType> parsedOutType;
  std::optional<double> cube;  ///< edge to resample to, meters
};

std::optional<SampleType> outputType(const ConvertArguments& o) {
  if (o.parsedOutType) return o.parsedOutType;
  return o.input.size ? std::nullopt : o.input.sampleType;
}

/// Values are chosen of the grid that would be copied: a label is a phase of the labels.
InputOptions withGridOfValues(InputOptions input) {
  const bool byValue = !(input.phase + input.threshold + input.range).empty();
  if (byValue && input.gridName.empty() && isVdb(input))
    input.gridName = chooseGrid(input, readVdbHeaders(input.path))->getName();
  return input;
}

void convertMask(const ConvertArguments& o, const Common& common) {
  MaskGrid::Ptr object = loadObject(withGridOfValues(o.input), common.progress);
  if (o.cube)
    object =
        withFileName(o.input.path, [&] { return resampleMask(*object, *o.cube, common.progress); });
  if (o.boundary != "auto") setBoundary(*object, parseBoundary(o.boundary));
  if (!hasVdbEnding(o.out)) {
    writeGridAsImage(o.out, *object, outputType(o), o.input.path, common);
    return;
  }
  const std::string steps = objectSteps(*object);
  writeVdb(o.out, {toBoolGrid(*object)}, common.progress);
  common.progress->end();
  const auto voxels = int64_t(object->activeVoxelCount());
  if (!common.quiet)
    std::cout << o.out << ": " << counted(voxels, "object voxel") << hintIfEmpty(voxels)
              << (steps.empty() ? "" : ": ") << steps << "\n";
}

/// Grains that a region left out are no longer counted.
void updateCountsOf(Int32Grid& labels, Progress* progress) {
  updateCounts(labels, int64_t(labelSizes(labels, progress).size()), true);
}

/// Labels of another program become what `segment` writes, but for the method's own metadata.
void convertLabels(const ConvertArguments& o, const Common& common) {
  Int32Grid::Ptr labels = loadLabels(o.input, "--grid", common.progress);
  auto range = openvdb::tools::minMax(labels->tree());
  if (range.min() < 0)
    throw InvalidInput(fmt::format(
        "{}: has the label {}; grains have numbers above 0, and 0 is background: set negative ones "
        "to 0",
        o.input.path, range.min()));
  if (o.cube) {
    labels = withFileName(o.input.path,
                          [&] { return resampleLabels(*labels, *o.cube, common.progress); });
    range = openvdb::tools::minMax(labels->tree());
  }
  labels->setName("grain");
  if (o.boundary != "auto") setBoundary(*labels, parseBoundary(o.boundary));
  if (o.input.region.any() && grainCount(*labels)) updateCountsOf(*labels, common.progress);
  if (!hasVdbEnding(o.out)) {
    writeGridAsImage(o.out, *labels, outputType(o), o.input.path, common);
    return;
  }
  writeVdb(o.out, {labels}, common.progress);
  common.progress->end();
  if (common.quiet) return;
  const int64_t voxels = int64_t(labels->activeVoxelCount());
  std::cout << o.out << ": grid 'grain', " << counted(voxels, "labeled voxel");
  if (voxels > 0) std::cout << ", largest label " << range.max();
  if (voxels > 0 && range.min() == range.max())
    std::cout << ", which all of them have: is this a mask? segment it";
  std::cout << "\n";
}

/// One grid, the one that would be copied: labels or a mask, cut to a region or of other voxels.
void convertGrid(ConvertArguments o, const Common& common) {
  const auto grid = chooseGrid(o.input, readVdbHeaders(o.input.path));
  o.input.gridName = grid->getName();
  if (grid->isType<Int32Grid>()) return convertLabels(o, common);
  if (!grid->isType<MaskGrid>() && !grid->isType<BoolGrid>() &&
      grid->getGridClass() != openvdb::GRID_LEVEL_SET)
    throw InvalidInput(fmt::format(
        "{}: grid '{}' holds {} values, and {} masks and labels: say which values are object "
        "(--threshold, --range)",
        o.input.path, o.input.gridName, grid->valueType(),
        o.cube ? "--resample takes" : "--roi and --crop take"));
  convertMask(o, common);
}

void copyVdb(const ConvertArguments& o, const Common& common) {
  auto grids = readVdb(o.input.path, {}, common.progress);
  if (o.input.domain) {  // the region that was is none any more
    const auto all = grids;
    grids.erase(std::remove_if(grids.begin(), grids.end(),
                               [&](const auto& grid) { return isRegion(*grid, all); }),
                grids.end());
  }
  if (!o.input.gridName.empty() || !hasVdbEnding(o.out)) grids = {chooseGrid(o.input, grids)};
  for (const auto& grid : grids) {
    overrideFile(*grid, o.input.path, o.input.volume(common.progress));
    if (o.boundary != "auto") setBoundary(*grid, parseBoundary(o.boundary));
  }
  if (!hasVdbEnding(o.out)) {
    writeGridAsImage(o.out, *grids[0], outputType(o), o.input.path, common);
    return;
  }
  writeVdb(o.out, {grids.begin(), grids.end()}, common.progress);
}

/// Of a folder of slabs that becomes an image.
void copySlabs(const ConvertArguments& o, const Common& common) {
  LabelSlabs labels = openLabelSlabs(o.input, "--grid", common.progress);
  if (o.boundary != "auto") {
    const Int32Grid::Ptr about = labels.about->deepCopy();
    setBoundary(*about, parseBoundary(o.boundary));
    labels.about = about;
  }
  writeSlabsAsImage(o.out, labels, outputType(o), o.input.path, common);
}

bool isImageOfLabels(const ConvertArguments& o, const Common& common) {
  if (isVdb(o.input) || readsGray(o.input.gray)) return false;
  const auto image = openVolumeImage(o.input.path, o.input.volume(common.progress));
  return kindOf(histogramOf(*image, common.progress)) == ImageKind::labels;
}

std::unique_ptr<ImageReader> openFiltered(const ConvertArguments& o, const Common& common) {
  return filteredImage(openVolumeImage(o.input.path, o.input.volume(common.progress)),
                       o.input.gray);
}

/// Labels can look like a gray image, and the other way round.
void checkGray(const ConvertArguments& o, const Common& common) {
  const ImageKind kind = kindOf(histogramOf(*openFiltered(o, common), common.progress));
  if (kind == ImageKind::mask || kind == ImageKind::phases)
    throw InvalidInput(o.input.path +
                       ": has a few values alone, which --resample must not mix: add --phase for a "
                       "mask, or --labels to keep them");
  if (kind == ImageKind::labels)
    common.progress->note(o.input.path +
                          ": seems to hold labels, whose values are mixed now as those of a gray "
                          "image (--labels keeps them)");
}

void copyAsImage(const ConvertArguments& o, const Common& common) {
  if (o.cube) checkGray(o, common);
  auto image = openFiltered(o, common);
  auto size = o.input.voxelSize ? o.input.voxelSize : image->info().voxelSize;
  bool areCubes = size ? size->isCube() : !image->info().proportions;
  std::array<double, 3> origin{};
  if (o.cube) {
    if (!size)
      throw InvalidInput(o.input.path + ": the size of its voxels is unknown: give it",
                         Hint::voxelSize);
    origin = resampledOrigin(*size, *o.cube);
    image = withFileName(o.input.path,
                         [&] { return resampledImage(std::move(image), *size, *o.cube); });
    size = VoxelSize(*o.cube);
    areCubes = true;
  }
  const SampleType type = outputType(o).value_or(image->info().type);
  copyImage(o.out, *image, type, size, common.progress, origin);
  note({lostEdges(o.out, areCubes, size)}, common);
  reportImage(o.out, "all values", toCoord(image->info().size), type, common);
}

/// @throw WrongUsage for what is not done slab by slab
void runByMembers(const ConvertArguments& o, const Common& common) {
  if (!isInSlabs(o.input) || hasVdbEnding(o.out) || o.labels || o.cube || o.input.selection ||
      readsGray(o.input.gray) || o.input.gray.despeckle > 0 || o.input.region.any() ||
      o.boundary != "auto")
    throw WrongUsage(
        "several processes copy the labels of a folder of slabs to an image; for all else there is "
        "vdb_madf convert");
  // The others would take the temporary of a process of another node for one that a killed run
  // left.
  inAllMembers(*common.team, [&] {
    if (common.team->member() == 0) checkWritable(o.out);
  });
  copySlabs(o, common);
}

void runConvert(const ConvertArguments& o, const Common& common) {
  if (common.team) return runByMembers(o, common);
  checkWritable(o.out);
  const bool fromVdb = isVdb(o.input);
  if (fromVdb && readsGray(o.input.gray) && !o.input.selection)
    throw InvalidInput(o.input.path + ": --median and --smooth are for images; leave them out");
  const bool isCut = o.input.region.any();
  const bool makesMask = o.input.selection || o.input.gray.despeckle > 0;
  if (o.labels || (isCut && !makesMask && !hasVdbEnding(o.out) && isImageOfLabels(o, common)))
    convertLabels(o, common);
  else if (makesMask || (!fromVdb && (isCut || hasVdbEnding(o.out))))
    convertMask(o, common);
  else if (fromVdb && (o.cube || isCut))
    convertGrid(o, common);
  else if (isInSlabs(o.input) && !hasVdbEnding(o.out))
    copySlabs(o, common);
  else if (fromVdb)
    copyVdb(o, common);
  else {
    checkNoGrid(o.input, "--grid");
    if (o.input.domain || o.boundary != "auto")
      throw InvalidInput(o.input.path +
                         ": --domain and --boundary are for VDB files and masks, and this is "
                         "copied from image to image; leave them out");
    copyAsImage(o, common);
  }
}

}  // namespace

void addConvert(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<ConvertArguments>();
  Verb verb =
      addVerb(command, common, "convert", "any readable volume to any writable volume",
              common.team ? "mpiexec -n 4 vdb_madf_mpi convert core.slabs core.raw"
                          : "vdb_madf convert scan.raw ice.vdb --dims 301x301x251 --type uint8 "
                            "--threshold 128");
  verb.option("IN", o->input.path, "any readable volume").required();
  verb.option("OUT", o->out,
              ".vdb (of an image a mask, or see --labels), " + wordList(writtenEndings()))
      .required();
  o->input.addSelection(verb);
  o->input.addRaw(verb);
  verb.flag("--labels", o->labels,
            "IN holds grains of another program: write them as labels, the Int32 grid 'grain'");
  verb.option("--out-type", o->outType, "sample type of the output")
      .typeName("TYPE")
      .offer(sampleTypeNames());
  o->input.addVoxelSize(verb);
  o->input.addDomain(verb);
  o->input.addRegion(verb);
  verb.option("--resample", o->resample,
              "last: cubes of that edge (10um); gray: linear; labels: nearest; mask: by volume")
      .typeName("SIZE");
  verb.option("--boundary", o->boundary, "what 'segment --boundary auto' shall take the mask for")
      .oneOf({"auto", "open", "closed"})
      .showDefault();
  verb.onParsed([o, &common, &action] {
    o->input.outputs = {o->out};
    o->input.typeIsOfInput = hasVdbEnding(o->out);
    o->input.areLabels = o->labels;
    o->input.parse();
    if (!o->resample.empty()) {
      const VoxelSize cube = parseVoxelSize(o->resample, "--resample");
      if (!cube.isCube())
        throw WrongUsage("--resample " + o->resample + ": a cube has one edge, for example 10um");
      o->cube = cube.edge();
    }
    if (o->labels && !hasVdbEnding(o->out) && !o->cube && !o->input.region.any())
      throw WrongUsage("--labels makes a .vdb; images keep their values in any case: leave it out");
    if (o->labels && o->input.selection)
      throw WrongUsage(
          "--labels takes all values: leave out --phase, --threshold, --range, --invert");
    if (o->labels && (readsGray(o->input.gray) || o->input.gray.despeckle > 0))
      throw WrongUsage(
          "--labels takes values as they are: leave out --median, --smooth, --despeckle");
    if (!o->outType.empty()) {
      if (hasVdbEnding(o->out))
        throw WrongUsage("--out-type is for images, and " + o->out + " is none: leave it out");
      o->parsedOutType = sampleTypeFromName(o->outType);
      if (!o->parsedOutType) throw WrongUsage("--out-type " + o->outType + ": no such sample type");
    }
    checkVolumeEnding(o->out);
    action = [o, &common] { runConvert(*o, besideOutput(common, o->out)); };
  });
}

}  // namespace vdb_madf::tools
