// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "command.h"
#include "grid_image.h"
#include "input_options.h"
#include "outputs.h"
#include "parse.h"
#include "sample_kinds.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/word_list.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/files/written_together.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/samples/balls.h"
#include "vdb_madf/samples/pack.h"
#include "vdb_madf/samples/scan.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/vdb/slab_folder_writer.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "vdb_madf/volumes/write_image.h"

namespace vdb_madf::tools {

namespace {

constexpr uint64_t kMostListBytes = uint64_t(1) << 30;

/// Numbers between colons; those that are not typed stay as they are.
void parseNumbers(const std::string& text, const std::string& option, const std::string& form,
                  const std::vector<double*>& values) {
  if (text.empty()) return;
  const auto parts = split(text, ':');
  if (parts.size() < 2 || parts.size() > values.size())
    throw WrongUsage(option + " " + text + ": write " + form);
  for (size_t i = 0; i < parts.size(); ++i) *values[i] = parseNumber(parts[i], option);
}

void parseScan(const GenerateArguments& typed, ScanOptions& scan) {
  scan.seed = typed.seed;
  parseNumbers(typed.surface, "--surface", "A:L", {&scan.surface, &scan.surfaceLength});
  parseNumbers(typed.scanNoise, "--scan-noise", "B:S or B:S:L",
               {&scan.blur, &scan.noise, &scan.noiseLength});
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
  const CoordBBox box = storedDomain(*sample.object)->box();
  writeImage(out, *sample.object, box, SampleType::uint8, interrupter);
  if (sample.truth) writeImage(truthPath(out), *sample.truth, box, SampleType::int32, interrupter);
}

void readCenters(GenerateArguments& options) {
  const auto read = [&] {
    return parseBalls(readText(options.centers, kMostListBytes), options.numbered);
  };
  options.balls.balls = withFileName(options.centers, read);
}

/// Slices of the scan that are made at a time.
constexpr int kGraySlices = 64;

void writeGray(const GenerateArguments& options, const Sample& sample, Interrupter* interrupter) {
  CoordBBox box = storedDomain(*sample.object)->box();
  ImageInfo info;
  info.size = toImageSize(box.dim());
  info.type = SampleType::uint16;
  info.voxelSize = storedVoxelSize(*sample.object);
  const auto writer = createImage(options.gray, info);
  for (int z = 0; z < info.size.z; z += kGraySlices) {
    box.min().z() = z;
    box.max().z() = std::min(z + kGraySlices, info.size.z) - 1;
    writer->write(box.dim().z(), grayValues(sample, options.scan, box, interrupter).data());
  }
  writer->finish();
}

/// The list of centers is read before.
Sample makeSample(const SampleKind& kind, const GenerateArguments& options,
                  Interrupter* interrupter) {
  return madeOfOptions([&] {
    checkScan(options.scan);
    const Sample sample = kind.make(options, interrupter);
    if (!options.gray.empty()) return sample;
    return scanned(sample, options.scan, interrupter);
  });
}

void checkVoxels(const SampleKind& kind, const GenerateArguments& options) {
  if (!options.voxelSize || options.voxelSize->isCube()) return;
  const std::string given = "--voxel-size " + options.voxelSizeText;
  if (kind.cubesOnly)
    throw WrongUsage(given + ": samples of " + kind.name + " are made of cubes; give one edge");
  if (!options.surface.empty() || !options.scanNoise.empty())
    throw WrongUsage(given + ": --surface and --scan-noise need cubes; give one edge");
}

/// All files that the sample is written to.
std::vector<std::string> outputsOf(const SampleKind& kind, const GenerateArguments& options) {
  std::vector<std::string> outputs{options.out};
  if (kind.hasTruth && !hasVdbEnding(options.out)) outputs.push_back(truthPath(options.out));
  if (!options.gray.empty()) outputs.push_back(options.gray);
  return outputs;
}

void checkGray(const GenerateArguments& options) {
  if (options.gray.empty()) return;
  if (isOnStandardOutput(options.gray) || !isImageEnding(options.gray))
    throw WrongUsage("--gray " + options.gray + ": the scan is an image: write " +
                     wordList(writtenEndings()));
  if (!options.surface.empty())
    throw WrongUsage(
        "--surface moves the voxels of the object, and --gray shows the bodies: leave one out");
}

void parse(const SampleKind& kind, GenerateArguments& options) {
  if (isOnStandardOutput(options.out))
    throw WrongUsage(options.out + ": samples are written to files only; give the path of one");
  if (hasSlabsEnding(options.out)) {
    if (kind.name != std::string("pack"))
      throw WrongUsage(options.out + ": only packs are made in slabs; give a .vdb or an image");
    if (!options.surface.empty() || !options.scanNoise.empty())
      throw WrongUsage(options.out +
                       ": --surface and --scan-noise change the whole: leave them out in slabs");
  } else {
    checkVolumeEnding(options.out);
  }
  checkGray(options);
  if (!options.voxelSizeText.empty()) options.voxelSize = parseVoxelSize(options.voxelSizeText);
  checkVoxels(kind, options);
  if (kind.isListed || !options.gray.empty())
    checkOutputs(outputsOf(kind, options), options.centers);
  kind.parse(options);
  parseScan(options, options.scan);
}

void printVoxels(const GenerateArguments& options, double voxels, double ofAll) {
  std::cout << options.out << ": " << int64_t(voxels) << " object voxels, " << 100 * voxels / ofAll
            << " % of the volume\n";
}

void runInSlabs(const GenerateArguments& options, const Common& common) {
  common.progress->start("generate");
  const PackSlabs slabs = madeOfOptions([&] { return PackSlabs(options.pack, common.progress); });
  common.progress->start("write");
  const SlabFolderWriter folder(options.out, slabs.cuts());
  for (size_t s = 0; s < slabs.slabCount(); ++s)
    folder.write(s, {toBoolGrid(*slabs.object(s, common.progress))}, common.progress);
  folder.commit(fmt::format(R"({{"object_voxels": {}}})", slabs.objectVoxels()));
  common.progress->end();
  if (!common.quiet)
    printVoxels(options, double(slabs.objectVoxels()),
                double(storedDomain(*slabs.object(0))->voxelCount()));
}

void runGenerate(const SampleKind& kind, const GenerateArguments& options, const Common& common) {
  if (hasSlabsEnding(options.out)) return runInSlabs(options, common);
  for (const std::string& output : outputsOf(kind, options)) checkWritable(output);
  if (kind.hasTruth && !hasVdbEnding(options.out))
    checkWrittenTogether(options.out, {truthPath(options.out)});
  Sample sample = makeSample(kind, options, common.progress);
  if (options.voxelSize) {
    setVoxelSize(*sample.object, options.voxelSize);
    if (sample.truth) setVoxelSize(*sample.truth, options.voxelSize);
  }
  OutputSet files;
  writeSample(options.out, sample, common.progress);
  if (!options.gray.empty()) writeGray(options, sample, common.progress);
  files.commit();
  common.progress->end();
  if (common.quiet) return;
  printVoxels(options, double(sample.object->activeVoxelCount()),
              double(storedDomain(*sample.object)->voxelCount()));
}

void addKind(Verb generate, Common& common, Action& action, const SampleKind& kind) {
  auto options = std::make_shared<GenerateArguments>();
  Verb verb = addVerb(generate, common, kind.name, kind.description, kind.example);
  if (kind.isListed)
    verb.option("CENTERS", options->centers,
                "text, a line for each ball: x y z, or x y z r (without r the radius is 1)")
        .required();
  verb.option("OUT", options->out, "file to write: .vdb, " + wordList(writtenEndings())).required();
  const Option size = verb.option("--size", options->size,
                                  kind.isListed ? "edge of a cube in the middle, voxels (default: "
                                                  "all balls)"
                                                : "edge of a cube, voxels")
                          .range(1, kMaxExtent);
  verb.option("--dims", options->dims, "size NXxNYxNZ, voxels").excludes(size);
  verb.option("--seed", options->seed, "same seed, same bits")
      .notNegative()  // would wrap around
      .showDefault();
  verb.option("--voxel-size", options->voxelSizeText,
              kind.cubesOnly ? "edge of a voxel with unit, for example 8.5um"
                             : "edge of a voxel with unit, for example 8.5um; or three, 1x1x3um: "
                               "sizes and lengths are then in shortest edges, not voxels");
  kind.add(verb, *options);
  verb.option("--surface", options->surface,
              "A:L moves the surface by a smooth random field of standard deviation A and "
              "correlation length L, voxels");
  verb.option("--scan-noise", options->scanNoise,
              "B:S blurs the object by B voxels, adds noise of standard deviation S, cuts at 0.5; "
              "B:S:L for noise of correlation length L, voxels");
  if (kind.hasBodies)
    verb.option("--gray", options->gray,
                "writes a gray scan of the same bodies, too, uint16 with air at 10000 and solid at "
                "30000; --scan-noise is then in the scan alone")
        .typeName("SCAN");
  verb.onParsed([options, &common, &action, &kind] {
    parse(kind, *options);
    action = [options, &common, &kind] {
      if (kind.isListed) readCenters(*options);
      runGenerate(kind, *options, common);
    };
  });
}

}  // namespace

void addGenerate(Verb command, Common& common, Action& action) {
  Verb generate = command.verb("generate", "make a synthetic sample");
  generate.footer(
      "vdb_madf generate KIND --help explains a kind.\nExample:\n"
      "  vdb_madf generate snow snow.vdb --size 256");
  for (const SampleKind& kind : sampleKinds()) addKind(generate, common, action, kind);
  addEvolve(generate, common, action);
}

}  // namespace vdb_madf::tools
