// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <iostream>
#include <limits>
#include <memory>
#include <type_traits>

#include "command.h"
#include "input.h"
#include "vdb_madf/errors.h"
#include "vdb_madf/object_mask.h"
#include "vdb_madf/segmentation_metadata.h"
#include "vdb_madf/vdb_file.h"

namespace vdb_madf::tools {

namespace {

struct Options {
  InputOptions input;
  std::string out, outType, boundary = "auto";
  std::optional<SampleType> parsedOutType;
};

/// The smallest sample type that surely holds a grid's values.
SampleType naturalType(const openvdb::GridBase& grid) {
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

void writeGridAsImage(const Options& o, const Common& common, const openvdb::GridBase& grid) {
  std::optional<CoordBBox> box = domain(grid);
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
  writeImage(o.out, grid, *box, outputType(o).value_or(naturalType(grid)), common.progress);
}

void convertMask(const Options& o, const Common& common) {
  const MaskGrid::Ptr object = loadObject(o.input, common.progress);
  if (!hasVdbEnding(o.out)) {
    writeGridAsImage(o, common, *object);
    return;
  }
  const BoolGrid::Ptr grid = toBoolGrid(*object);
  if (o.boundary != "auto")
    setBoundary(*grid, o.boundary == "open" ? Boundary::open : Boundary::closed);
  if (!common.quiet) std::cout << o.out << ": " << object->activeVoxelCount() << " object voxels\n";
  writeVdb(o.out, {grid}, common.progress);
}

void copyVdb(const Options& o, const Common& common) {
  auto grids = readVdb(o.input.path, {}, common.progress);
  if (!o.input.gridName.empty() || !hasVdbEnding(o.out))
    grids = {chooseGrid(grids, o.input.path, o.input.gridName, "--grid",
                        {"grain", "truth", "object"}, isNumericGrid)};
  for (const auto& grid : grids) {
    if (o.input.domain) setDomain(*grid, *o.input.domain);
    if (o.input.voxelSize) setVoxelSize(*grid, o.input.voxelSize);
    if (o.boundary != "auto")
      setBoundary(*grid, o.boundary == "open" ? Boundary::open : Boundary::closed);
  }
  if (!hasVdbEnding(o.out)) {
    writeGridAsImage(o, common, *grids[0]);
    return;
  }
  writeVdb(o.out, {grids.begin(), grids.end()}, common.progress);
}

void run(const Options& o, const Common& common) {
  const bool fromVdb = !o.input.size && isVdb(o.input.path);
  if (o.input.selection || (!fromVdb && hasVdbEnding(o.out)))
    convertMask(o, common);
  else if (fromVdb)
    copyVdb(o, common);
  else {
    if (!o.input.gridName.empty())
      throw InvalidInput(o.input.path + ": --grid is for VDB files, and this is none");
    const auto image = openImage(o.input.path, o.input.rawLayout());
    copyImage(o.out, *image, outputType(o).value_or(image->info().type), o.input.voxelSize,
              common.progress);
  }
}

}  // namespace

void addConvert(CLI::App& app, Common& common, Action& action) {
  auto o = std::make_shared<Options>();
  CLI::App* verb =
      addVerb(app, common, "convert", "any readable volume to any writable volume",
              "vdb_madf convert scan.raw ice.vdb --dims 301x301x251 --type uint8 --threshold 128");
  verb->add_option("IN", o->input.path, "any readable volume")->required();
  verb->add_option("OUT", o->out, ".vdb (a mask, of an image), .tif, .raw, .mhd, .mha")->required();
  o->input.addSelection(*verb);
  o->input.addRaw(*verb);
  verb->add_option("--out-type", o->outType, "sample type of the output")->type_name("TYPE");
  o->input.addVoxelSize(*verb);
  o->input.addDomain(*verb);
  verb->add_option("--boundary", o->boundary,
                   "what 'segment --boundary auto' shall take the mask for")
      ->check(CLI::IsMember({"auto", "open", "closed"}))
      ->capture_default_str();
  verb->callback([o, &common, &action] {
    o->input.parse();
    if (!o->outType.empty()) {
      o->parsedOutType = sampleTypeFromName(o->outType);
      if (!o->parsedOutType) throw WrongUsage("--out-type " + o->outType + ": no such sample type");
    }
    if (!hasVdbEnding(o->out) && !isImageEnding(o->out))
      throw WrongUsage(o->out + ": the ending must be .vdb, .tif, .raw, .mhd or .mha");
    checkOutputIsNotInput(o->input.path, o->out);
    action = [o, &common] { run(*o, common); };
  });
}

}  // namespace vdb_madf::tools
