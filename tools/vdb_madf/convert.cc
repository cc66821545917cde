// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <iostream>
#include <limits>
#include <memory>
#include <type_traits>

#include "command.h"
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
#include "vdb_madf/volumes/label_type.h"
#include "vdb_madf/volumes/write_image.h"

namespace vdb_madf::tools {

namespace {

struct Options {
  InputOptions input;
  std::string out, outType, boundary = "auto";
  std::optional<SampleType> parsedOutType;
};

/// The smallest sample type that surely holds a grid's values. Programs that look at TIFF take
/// signed samples for something else than labels, if they take them at all.
SampleType naturalType(const openvdb::GridBase& grid, const std::string& path) {
  if (grid.isType<Int32Grid>() && hasTiffEnding(path))
    return labelType(static_cast<const Int32Grid&>(grid));
  const std::string type = grid.valueType();
  if (grid.isType<MaskGrid>() || type == "bool") return SampleType::uint8;
  if (type == "float") return SampleType::float32;
  if (type == "double") return SampleType::float64;
  return SampleType::int32;
}

std::optional<SampleType> outputType(const Options& o) {
  if (o.parsedOutType) return o.parsedOutType;
  return o.input.size ? std::nullopt : o.input.sampleType;
}

/// A RAW file does not tell these itself.
void report(const Options& o, const Common& common, const std::string& what, const Coord& size,
            SampleType type) {
  common.progress->end();
  if (common.quiet) return;
  std::cout << o.out << ": " << what << ", " << size.x() << "x" << size.y() << "x" << size.z()
            << " voxels of type " << sampleTypeName(type) << "\n";
}

void writeGridAsImage(const Options& o, const Common& common, const openvdb::GridBase& grid) {
  std::optional<CoordBBox> box = storedDomain(grid);
  if (!box) {
    box = grid.evalActiveVoxelBoundingBox();
    if (grid.activeVoxelCount() == 0)
      throw InvalidInput(o.input.path + ": grid '" + grid.getName() +
                         "' is empty and has no domain: there is nothing to write; give --domain");
    if (!common.quiet)
      std::cout << o.out
                << ": no known domain, so the active bounding box is written; its origin is "
                << box->min() << "\n";
  }
  const SampleType type = outputType(o).value_or(naturalType(grid, o.out));
  writeImage(o.out, grid, *box, type, common.progress);
  report(o, common, "grid '" + grid.getName() + "'", box->dim(), type);
}

void convertMask(const Options& o, const Common& common) {
  const MaskGrid::Ptr object = loadObject(o.input, common.progress);
  if (!hasVdbEnding(o.out)) {
    writeGridAsImage(o, common, *object);
    return;
  }
  const BoolGrid::Ptr grid = toBoolGrid(*object);
  if (o.boundary != "auto") setBoundary(*grid, parseBoundary(o.boundary));
  writeVdb(o.out, {grid}, common.progress);
  common.progress->end();
  const auto voxels = int64_t(object->activeVoxelCount());
  if (!common.quiet)
    std::cout << o.out << ": " << voxels << " object voxels" << hintIfEmpty(voxels) << "\n";
}

void copyVdb(const Options& o, const Common& common) {
  auto grids = readVdb(o.input.path, {}, common.progress);
  if (!o.input.gridName.empty() || !hasVdbEnding(o.out)) grids = {chooseGrid(o.input, grids)};
  for (const auto& grid : grids) {
    overrideFile(*grid, o.input.path, o.input.volume(common.progress));
    if (o.boundary != "auto") setBoundary(*grid, parseBoundary(o.boundary));
  }
  if (!hasVdbEnding(o.out)) {
    writeGridAsImage(o, common, *grids[0]);
    return;
  }
  writeVdb(o.out, {grids.begin(), grids.end()}, common.progress);
}

void run(const Options& o, const Common& common) {
  checkWritable(o.out);
  const bool fromVdb = isVdb(o.input);
  if (o.input.selection || (!fromVdb && hasVdbEnding(o.out)))
    convertMask(o, common);
  else if (fromVdb)
    copyVdb(o, common);
  else {
    checkNoGrid(o.input, "--grid");
    if (o.input.domain || o.boundary != "auto")
      throw InvalidInput(o.input.path +
                         ": --domain and --boundary are for VDB files and masks, and this is "
                         "copied from image to image; leave them out");
    const auto image = openVolumeImage(o.input.path, o.input.volume(common.progress));
    const SampleType type = outputType(o).value_or(image->info().type);
    copyImage(o.out, *image, type, o.input.voxelSize, common.progress);
    report(o, common, "all values", toCoord(image->info().size), type);
  }
}

}  // namespace

void addConvert(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<Options>();
  Verb verb =
      addVerb(command, common, "convert", "any readable volume to any writable volume",
              "vdb_madf convert scan.raw ice.vdb --dims 301x301x251 --type uint8 --threshold 128");
  verb.option("IN", o->input.path, "any readable volume").required();
  verb.option("OUT", o->out, ".vdb (a mask, of an image), .tif, .raw, .mhd, .mha, .nrrd, .npy")
      .required();
  o->input.addSelection(verb);
  o->input.addRaw(verb);
  verb.option("--out-type", o->outType, "sample type of the output").typeName("TYPE");
  o->input.addVoxelSize(verb);
  o->input.addDomain(verb);
  verb.option("--boundary", o->boundary, "what 'segment --boundary auto' shall take the mask for")
      .oneOf({"auto", "open", "closed"})
      .showDefault();
  verb.onParsed([o, &common, &action] {
    o->input.outputs = {o->out};
    o->input.typeIsOfInput = hasVdbEnding(o->out);
    o->input.parse();
    if (!o->outType.empty()) {
      if (hasVdbEnding(o->out))
        throw WrongUsage("--out-type is for images, and " + o->out + " is none: leave it out");
      o->parsedOutType = sampleTypeFromName(o->outType);
      if (!o->parsedOutType) throw WrongUsage("--out-type " + o->outType + ": no such sample type");
    }
    if (!hasVdbEnding(o->out) && !isImageEnding(o->out))
      throw WrongUsage(o->out + ": the ending must be .vdb, .tif, .raw, .mhd, .mha, .nrrd or .npy");
    action = [o, &common] { run(*o, common); };
  });
}

}  // namespace vdb_madf::tools
