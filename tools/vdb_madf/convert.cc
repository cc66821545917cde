// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <openvdb/tools/Count.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "command.h"
#include "grid_image.h"
#include "input_options.h"
#include "outputs.h"
#include "parse.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/images/copy_image.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/method/segmentation_metadata.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "vdb_madf/volumes/image_box.h"

namespace vdb_madf::tools {

namespace {

struct Options {
  InputOptions input;
  std::string out, outType, boundary = "auto";
  bool labels = false;
  std::optional<SampleType> parsedOutType;
};

std::optional<SampleType> outputType(const Options& o) {
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

void convertMask(const Options& o, const Common& common) {
  const MaskGrid::Ptr object = loadObject(withGridOfValues(o.input), common.progress);
  if (!hasVdbEnding(o.out)) {
    writeGridAsImage(o.out, *object, outputType(o), o.input.path, common);
    return;
  }
  const std::string steps = objectSteps(*object);
  const BoolGrid::Ptr grid = toBoolGrid(*object);
  if (o.boundary != "auto") setBoundary(*grid, parseBoundary(o.boundary));
  writeVdb(o.out, {grid}, common.progress);
  common.progress->end();
  const auto voxels = int64_t(object->activeVoxelCount());
  if (!common.quiet)
    std::cout << o.out << ": " << counted(voxels, "object voxel") << hintIfEmpty(voxels)
              << (steps.empty() ? "" : ": ") << steps << "\n";
}

/// Labels of another program become what `segment` writes, but for the method's own metadata.
void convertLabels(const Options& o, const Common& common) {
  const Int32Grid::Ptr labels = loadLabels(o.input, "--grid", common.progress);
  const auto range = openvdb::tools::minMax(labels->tree());
  if (range.min() < 0)
    throw InvalidInput(
        o.input.path + ": has the label " + std::to_string(range.min()) +
        "; grains have numbers above 0, and 0 is background: set negative ones to 0");
  labels->setName("grain");
  if (o.boundary != "auto") setBoundary(*labels, parseBoundary(o.boundary));
  writeVdb(o.out, {labels}, common.progress);
  common.progress->end();
  if (common.quiet) return;
  const int64_t voxels = int64_t(labels->activeVoxelCount());
  std::cout << o.out << ": grid 'grain', " << counted(voxels, "labelled voxel");
  if (voxels > 0) std::cout << ", largest label " << range.max();
  if (voxels > 0 && range.min() == range.max())
    std::cout << ", which all of them have: is this a mask? segment it";
  std::cout << "\n";
}

void copyVdb(const Options& o, const Common& common) {
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

void run(const Options& o, const Common& common) {
  checkWritable(o.out);
  const bool fromVdb = isVdb(o.input);
  if (fromVdb && readsGray(o.input.gray) && !o.input.selection)
    throw InvalidInput(o.input.path + ": --median and --smooth are for images; leave them out");
  if (o.labels)
    convertLabels(o, common);
  else if (o.input.selection || o.input.gray.despeckle > 0 || o.input.region.any() ||
           (!fromVdb && hasVdbEnding(o.out)))
    convertMask(o, common);
  else if (fromVdb)
    copyVdb(o, common);
  else {
    checkNoGrid(o.input, "--grid");
    if (o.input.domain || o.boundary != "auto")
      throw InvalidInput(o.input.path +
                         ": --domain and --boundary are for VDB files and masks, and this is "
                         "copied from image to image; leave them out");
    const auto image =
        filteredImage(openVolumeImage(o.input.path, o.input.volume(common.progress)), o.input.gray);
    const SampleType type = outputType(o).value_or(image->info().type);
    copyImage(o.out, *image, type, o.input.voxelSize, common.progress);
    const auto size = o.input.voxelSize ? o.input.voxelSize : image->info().voxelSize;
    noteLostEdges(o.out, size ? size->isCube() : !image->info().proportions, size, common);
    reportImage(o.out, "all values", toCoord(image->info().size), type, common);
  }
}

}  // namespace

void addConvert(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<Options>();
  Verb verb =
      addVerb(command, common, "convert", "any readable volume to any writable volume",
              "vdb_madf convert scan.raw ice.vdb --dims 301x301x251 --type uint8 --threshold 128");
  verb.option("IN", o->input.path, "any readable volume").required();
  verb.option("OUT", o->out,
              ".vdb (of an image a mask, or see --labels), .tif, .raw, .mhd, .mha, .nrrd, .npy")
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
  verb.option("--boundary", o->boundary, "what 'segment --boundary auto' shall take the mask for")
      .oneOf({"auto", "open", "closed"})
      .showDefault();
  verb.onParsed([o, &common, &action] {
    o->input.outputs = {o->out};
    o->input.typeIsOfInput = hasVdbEnding(o->out);
    o->input.parse();
    if (o->labels && !hasVdbEnding(o->out))
      throw WrongUsage("--labels makes a .vdb; images keep their values in any case: leave it out");
    if (o->labels && o->input.selection)
      throw WrongUsage(
          "--labels takes all values: leave out --phase, --threshold, --range, --invert");
    if (o->labels && o->input.region.any())
      throw WrongUsage("--labels takes all of IN: leave out --roi and --crop");
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
    action = [o, &common] { run(*o, besideOutput(common, o->out)); };
  });
}

}  // namespace vdb_madf::tools
