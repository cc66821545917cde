// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <filesystem>
#include <iostream>
#include <memory>

#include "command.h"
#include "input.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/output_file.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/samples/pack.h"
#include "vdb_madf/samples/sintered.h"
#include "vdb_madf/samples/snow.h"
#include "vdb_madf/samples/spheres.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "vdb_madf/volumes/write_image.h"

namespace vdb_madf::tools {

namespace {

struct GenerateOptions {
  std::string out, dims, radius, voxelSize;
  int size = 0;
  uint64_t seed = 1;
  SphereOptions spheres;
  PackOptions pack;
  SnowOptions snow;
  SinteredOptions sintered;
};

void parseRadius(const std::string& text, double& low, double& high) {
  if (text.empty()) return;
  const size_t colon = text.find(':');
  low = parseNumber(text.substr(0, colon), "--radius");
  high = colon == std::string::npos ? low : parseNumber(text.substr(colon + 1), "--radius");
  if (!(low > 0 && low <= high)) throw WrongUsage("--radius " + text + ": write A:B, 0 < A <= B");
}

void checkFraction(double fraction) {
  if (!(fraction > 0 && fraction < 1)) throw WrongUsage("--fraction must lie between 0 and 1");
}

/// OUT.tif -> OUT.truth.tif
std::string truthPath(const std::string& out) {
  const std::filesystem::path path(out);
  return (path.parent_path() / (path.stem().string() + ".truth" + path.extension().string()))
      .string();
}

void writeSample(const std::string& out, Sample& sample, Interrupter* interrupter) {
  if (hasVdbEnding(out)) {
    std::vector<openvdb::GridBase::ConstPtr> grids{toBoolGrid(*sample.object)};
    if (sample.truth) grids.push_back(sample.truth);
    writeVdb(out, grids, interrupter);
    return;
  }
  const CoordBBox box = *storedDomain(*sample.object);
  writeImage(out, *sample.object, box, SampleType::uint8, interrupter);
  if (sample.truth) writeImage(truthPath(out), *sample.truth, box, SampleType::int32, interrupter);
}

/// Nothing is read, so whatever cannot be made is the fault of the options.
Sample makeSample(const std::function<Sample(Interrupter*)>& make, Interrupter* interrupter) {
  try {
    return make(interrupter);
  } catch (const InvalidInput& error) {
    throw WrongUsage(std::string("cannot generate this: ") + error.what());
  }
}

/// A kind of sample: its own options besides those that all share, and the call that makes it.
void addKind(CLI::App& verb, Common& common, Action& action, GenerateOptions& o,
             const std::string& kind, const std::string& description,
             const std::function<void(CLI::App&)>& addOptions,
             const std::function<Sample(Interrupter*)>& make, const std::string& example) {
  CLI::App* app = addVerb(verb, common, kind, description, example);
  app->add_option("OUT", o.out, "file to write: .vdb, .tif, .raw, .mhd, .mha, .nrrd, .npy")
      ->required();
  CLI::Option* size =
      app->add_option("--size", o.size, "edge of a cube, voxels")->check(CLI::Range(1, 26754));
  app->add_option("--dims", o.dims, "size NXxNYxNZ, voxels")->excludes(size);
  app->add_option("--seed", o.seed, "same seed, same bits")
      ->check(CLI::NonNegativeNumber)  // would wrap around
      ->capture_default_str();
  app->add_option("--voxel-size", o.voxelSize, "edge of a voxel with unit, for example 8.5um");
  addOptions(*app);
  app->callback([&common, &action, &o, make] {
    if (!hasVdbEnding(o.out) && !isImageEnding(o.out))
      throw WrongUsage(o.out + ": the ending must be .vdb, .tif, .raw, .mhd, .mha, .nrrd or .npy");
    Coord dims;
    if (!o.dims.empty()) dims = parseDims(o.dims, "--dims");
    if (o.size > 0) dims = Coord(o.size);
    const auto common_ = [&](auto& options) {
      if (dims != Coord()) options.size = dims;
      options.seed = o.seed;
    };
    common_(o.spheres);
    common_(o.pack);
    common_(o.snow);
    common_(o.sintered);
    parseRadius(o.radius, o.spheres.minRadius, o.spheres.maxRadius);
    parseRadius(o.radius, o.pack.minRadius, o.pack.maxRadius);
    parseRadius(o.radius, o.sintered.minRadius, o.sintered.maxRadius);
    checkFraction(o.pack.fraction);
    checkFraction(o.snow.fraction);
    std::optional<VoxelSize> voxelSize;
    if (!o.voxelSize.empty()) voxelSize = parseVoxelSize(o.voxelSize);
    action = [&common, &o, make, voxelSize] {
      checkWritable(o.out);
      Sample sample = makeSample(make, common.progress);
      if (voxelSize) {
        setVoxelSize(*sample.object, voxelSize);
        if (sample.truth) setVoxelSize(*sample.truth, voxelSize);
      }
      writeSample(o.out, sample, common.progress);
      common.progress->end();
      if (!common.quiet)
        std::cout << o.out << ": " << sample.object->activeVoxelCount() << " object voxels, "
                  << 100.0 * double(sample.object->activeVoxelCount()) /
                         double(storedDomain(*sample.object)->volume())
                  << " % of the volume\n";
    };
  });
}

}  // namespace

void addGenerate(CLI::App& app, Common& common, Action& action) {
  CLI::App* verb = app.add_subcommand("generate", "make a synthetic sample");
  verb->require_subcommand(0, 1);
  verb->footer(
      "vdb_madf generate KIND --help explains a kind.\nExample:\n"
      "  vdb_madf generate snow snow.vdb --size 256");
  auto o = std::make_shared<GenerateOptions>();
  // The options live as long as the parser, which holds the callbacks that hold them.
  verb->final_callback([o] {});

  addKind(
      *verb, common, action, *o, "spheres", "overlapping balls with known grains (paper, Table 1)",
      [&](CLI::App& a) {
        a.add_option("--count", o->spheres.count, "number of balls")->capture_default_str();
        a.add_option("--radius", o->radius, "radii A:B, voxels (default 20:30)");
        a.add_option("--overlap", o->spheres.overlap, "overlap of the balls (paper, section 6.1)")
            ->capture_default_str();
        a.add_option("--max-cover", o->spheres.maxCover,
                     "most balls that may share a voxel (0: any)")
            ->check(CLI::NonNegativeNumber)
            ->capture_default_str();
      },
      [o](Interrupter* i) { return generateSpheres(o->spheres, i); },
      "vdb_madf generate spheres balls.vdb --count 100 --radius 20:30 --overlap 0.084");
  addKind(
      *verb, common, action, *o, "pack", "many balls at a given solid fraction",
      [&](CLI::App& a) {
        a.add_option("--fraction", o->pack.fraction, "solid fraction")->capture_default_str();
        a.add_option("--radius", o->radius, "radii A:B, voxels (default 8:28)");
      },
      [o](Interrupter* i) { return generatePack(o->pack, i); },
      "vdb_madf generate pack pack.vdb --size 512 --fraction 0.25");
  addKind(
      *verb, common, action, *o, "snow", "a snow-like random structure",
      [&](CLI::App& a) {
        a.add_option("--fraction", o->snow.fraction, "ice fraction")->capture_default_str();
        a.add_option("--length", o->snow.length, "peak wavelength, voxels")->capture_default_str();
      },
      [o](Interrupter* i) { return generateSnow(o->snow, i); },
      "vdb_madf generate snow snow.vdb --size 256 --fraction 0.3 --voxel-size 10um");
  addKind(
      *verb, common, action, *o, "sintered", "sintered balls with known grains",
      [&](CLI::App& a) {
        a.add_option("--count", o->sintered.count, "number of balls")->capture_default_str();
        a.add_option("--radius", o->radius, "radii A:B, voxels (default 12:22)");
        a.add_option("--neck", o->sintered.neck, "least distance of centres / (ri + rj)")
            ->capture_default_str();
        a.add_option("--roughness", o->sintered.roughness, "amplitude of surface noise")
            ->capture_default_str();
      },
      [o](Interrupter* i) { return generateSintered(o->sintered, i); },
      "vdb_madf generate sintered grains.vdb --count 90 --roughness 0.15");
}

}  // namespace vdb_madf::tools
