// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/segment.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <vector>

#include "auto_slabs.h"
#include "command.h"
#include "estimate.h"
#include "grid_image.h"
#include "input_options.h"
#include "json_file.h"
#include "merge_options.h"
#include "outputs.h"
#include "parse.h"
#include "scan_option.h"
#include "segment_summary.h"
#include "slab_output.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/estimate_blur.h"
#include "vdb_madf/intensity/measure_necks.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/measure/size_biases.h"
#include "vdb_madf/measure/table_unit.h"
#include "vdb_madf/segmentation/ball_grids.h"
#include "vdb_madf/segmentation/segment_memory.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

namespace {

void parseFiles(SegmentArguments& o) {
  o.input.outputs = {o.out, o.json};
  if (!o.tables.empty()) {
    for (const std::string& path : MeasurementTables::paths(o.tables))
      o.input.outputs.push_back(path);
    for (const std::string* file : {&o.out, &o.json})
      if (!file->empty() && placeOf(*file) == placeOf(o.tables))
        throw WrongUsage(*file + ": two outputs would go to this place; choose another name");
  }
  o.input.longestSide = hasSlabsEnding(o.out) || o.autoSlabs ? kMaxImageSide : kMaxExtent;
  o.input.parse();
  if (!o.maxMemory.empty()) o.segment.maxMemory = parseMemory(o.maxMemory);
  if (!o.unit.empty() && o.tables.empty())
    throw WrongUsage("--unit is that of the tables: give --tables, too");
  if (o.necks && (o.tables.empty() || !cutsGray(o.input)))
    throw WrongUsage("--necks measures those of a gray scan: give --tables and --threshold, too");
  if (o.out.empty() && !o.dryRun) throw WrongUsage("OUT is required (or --dry-run)");
  if (o.out.empty() || hasSlabsEnding(o.out)) return;
  checkVolumeEnding(o.out);
  if (!hasVdbEnding(o.out) && !o.keep.empty())
    throw WrongUsage(fmt::format(
        "--keep is for .vdb files, and {} takes the labels alone: leave it out, or write a .vdb "
        "and convert it",
        o.out));
}

/// The tables, with the necks as the gray scan IN shows them if that was asked for.
Measurements measureGrains(const SegmentArguments& o, const Segmentation& s, Progress* progress) {
  Measurements measurements = measure(s, progress);
  if (!o.necks) return measurements;
  progress->start("necks");
  const auto open = [&] { return openGrayScan(o.input.path, o.input.volume(progress), progress); };
  const ScanBlur blur = blurOf(open(), storedDomain(*s.grain), progress);
  noteOfScan(o.input.path, noteOn(blur), progress);
  GrayScan scan = open();
  measureNecks(*s.grain, scan, blur, measurements, progress);
  return measurements;
}

void applyPaper(SegmentArguments& o) {
  if (!o.paper) return;
  for (const std::string* given :
       {&o.merge.mode, &o.merge.adjacency, &o.merge.delta, &o.fillHoles, &o.tidy})
    if (!given->empty())
      throw WrongUsage(
          "--paper sets --merge, --adjacency, --delta, --fill-holes and --tidy itself: leave them "
          "out");
  o.merge.mode = "angle";
  o.merge.adjacency = "cell";
  o.merge.delta = o.fillHoles = o.tidy = "0";
  if (o.merge.theta.empty()) o.merge.theta = "-0.8";
}

void parseMethod(SegmentArguments& o) {
  applyPaper(o);
  o.segment.merge = o.merge.parse();
  o.segment.autoStrictness = o.merge.isAutomatic();
  o.segment.gamma = parseCount(o.gamma, "--gamma");
  o.segment.fillHoles = parseFillHoles(o.fillHoles);
  o.segment.tidy = parseTidy(o.tidy);
}

void parseKeep(SegmentArguments& o) {
  const std::map<std::string, bool*> grids{{"distance", &o.segment.keepDistance},
                                           {"power", &o.segment.keepPower},
                                           {"manifold", &o.segment.keepManifold},
                                           {"balls", &o.segment.keepBalls}};
  std::stringstream keep(o.keep);
  for (std::string what; std::getline(keep, what, ',');) {
    if (grids.count(what) == 0)
      throw WrongUsage("--keep " + what + ": can keep distance, power, manifold and balls");
    *grids.at(what) = true;
  }
}

void checkAutoSlabs(const SegmentArguments& o) {
  if (hasSlabsEnding(o.out))
    throw WrongUsage(o.out + " is in slabs anyway: leave --auto-slabs out");
  if (!couldBeInSlabs(o))
    throw WrongUsage(
        "--auto-slabs gives one file of labels and manifolds: leave other grids of --keep, "
        "--tables and --dry-run out");
}

void parse(SegmentArguments& o) {
  parseFiles(o);
  parseMethod(o);
  parseKeep(o);
  if (o.segment.autoStrictness && (o.autoSlabs || hasSlabsEnding(o.out)))
    throw WrongUsage(
        "--strictness auto is not for slabs: segment with --keep manifold, then remerge with it");
  if (o.autoSlabs)
    checkAutoSlabs(o);
  else
    checkSlabArguments(o);
}

/// Bytes beside the mask: to segment it, and to measure what comes of it, if that is asked for.
int64_t neededMemory(const SegmentArguments& o, const ObjectSize& size,
                     const SegmentOptions& options) {
  const int64_t segmenting = segmentMemory(size, options);
  return o.tables.empty() ? segmenting : std::max(segmenting, tablesMemory(size, options));
}

void runSegment(const SegmentArguments& o, const Common& common) {
  if (hasSlabsEnding(o.out)) return o.dryRun ? estimateSlabs(o, common) : runInSlabs(o, common);
  if (o.autoSlabs && isSurelyForSlabs(o)) return runAutoSlabs(o, common);
  const Clock::time_point start = Clock::now();
  SegmentTiming timing;
  if (!o.dryRun) checkWritable(o.out);
  JsonFile jsonFile(o.json);
  std::optional<MeasurementTables> tables;
  if (!o.tables.empty() && !o.dryRun) tables.emplace(o.tables);
  common.progress->start("read");
  MaskGrid::Ptr object = loadObject(o.input, common.progress);
  SegmentOptions options = o.segment;
  options.boundary = boundaryOf(o.boundary, o.input, *object, common.progress);
  timing.read = secondsSince(start);
  requireTableUnit(o.unit, storedVoxelSize(*object));

  // What is free now, or what was allowed for the whole process, less the mask.
  if (o.maxMemory.empty())
    options.maxMemory = availableMemory();
  else
    options.maxMemory = std::max<int64_t>(1, options.maxMemory - int64_t(object->memUsage()));
  const auto sampled = [&] {
    return withFileName(o.input.path, [&] { return sampledSize(*object, options); });
  };
  if (o.dryRun) {
    common.progress->end();
    const ObjectSize size = sampled();
    const auto mask = int64_t(object->memUsage());
    return say(o, common,
               {size.voxels, size.leaves, mask + neededMemory(o, size, options),
                options.maxMemory > 0 ? mask + options.maxMemory : 0, 0, timing.read},
               jsonFile);
  }

  ObjectSize size = sizeAtMost(*object, options);
  bool fits = options.maxMemory == 0 || neededMemory(o, size, options) <= options.maxMemory;
  if (!fits && (tables || o.autoSlabs)) {  // else segment() finds out
    size = sampled();
    fits = neededMemory(o, size, options) <= options.maxMemory;
  }
  if (!fits && tables && segmentMemory(size, options) <= options.maxMemory)
    throw InvalidInput(
        fmt::format("{}: to segment and measure it needs about {} of memory, and {} may be used: "
                    "allow more, or "
                    "leave --tables out and measure the labels",
                    o.input.path, readableBytes(neededMemory(o, size, options)),
                    readableBytes(options.maxMemory)));
  if (!fits && o.autoSlabs) {
    object.reset();
    return runAutoSlabs(o, common);
  }
  Segmentation s;
  try {
    s = withFileName(o.input.path, [&] { return segment(*object, options, common.progress); });
  } catch (const InvalidInput& error) {
    if (error.hint() == Hint::memoryLimit && couldBeInSlabs(o)) throw withSlabsAdvice(o, error);
    throw;
  }
  object.reset();

  std::vector<SizeBias> biases;
  OutputSet files;
  if (tables) {
    const Clock::time_point startMeasure = Clock::now();
    TableOptions about;
    about.labels = o.out;
    about.unit = o.unit;
    const Measurements measurements = measureGrains(o, s, common.progress);
    biases = sizeBiases(measurements);
    tables->write(measurements, about);
    timing.measure = secondsSince(startMeasure);
  }

  common.progress->start("write");
  std::vector<openvdb::GridBase::ConstPtr> grids{s.grain};
  for (const Int32Grid::Ptr& grid : {s.distanceSquared, s.power, s.manifold})
    if (grid) grids.push_back(grid);
  if (options.keepBalls)
    for (const Int32Grid::Ptr& grid : ballGrids(s)) grids.push_back(grid);
  if (hasVdbEnding(o.out)) {
    writeVdb(o.out, grids, common.progress);
  } else {
    Common heard = common;
    heard.quiet |= jsonFile.isStandardOutput();
    writeGridAsImage(o.out, *s.grain, std::nullopt, o.input.path, heard);
  }

  timing.total = secondsSince(start);
  timing.write = timing.total - timing.read - timing.measure;
  for (const StageTime& stage : s.times) timing.write -= stage.seconds;
  common.progress->end();
  SegmentArguments used = o;
  if (s.stable) used.segment.merge.strictness = s.stable->strictness;
  SegmentSummary summary = summarize(used, common, s, timing);
  for (const SizeBias& bias : biases) summary.hints.push_back("too small for " + toString(bias));
  Json json = toJson(used, summary);
  addNotes(json, *common.progress);
  jsonFile.write(json);
  files.commit();
  if (!common.quiet && !jsonFile.isStandardOutput()) print(used, common, summary);
}

}  // namespace

void addSegment(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<SegmentArguments>();
  Verb verb = addVerb(command, common, "segment", "cut the object into grains",
                      exampleOfSegment(common.team), MemoryLimit::planned);
  verb.option("IN", o->input.path, "any readable volume").required();
  verb.option("OUT", o->out,
              "gets the labels: .vdb (Int32 grid 'grain'), an image: .tif, .npy ..., or .slabs");
  o->input.addSelection(verb);
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  o->input.addDomain(verb);
  o->input.addRegion(verb);
  verb.option("--gamma", o->gamma, "least cell of a medial ball, voxels").showDefault();
  addBoundary(verb, o->boundary);
  addFillHoles(verb, o->fillHoles);
  o->merge.add(verb);
  addTidy(verb, o->tidy);
  verb.flag("--paper", o->paper,
            "to the letter: angle, cell, theta -0.8 unless given, delta, fill-holes, tidy 0");
  verb.option("--keep", o->keep, "more grids: distance,power,manifold,balls")
      .typeName("LIST")
      .offer({"distance", "power", "manifold", "balls"});
  verb.option("--tables", o->tables,
              "also measure: grains.csv, bonds.csv, sample.json in here (a folder, or FILE.h5)")
      .typeName("DIR");
  verb.option("--unit", o->unit, "with --tables: of lengths; default: mm, of voxels under 20 nm um")
      .oneOf({"mm", "um"});
  verb.flag("--necks", o->necks,
            "with --tables: the necks as the gray scan shows them, freed of its blur, too");
  verb.option("--json", o->json, "machine-readable summary (-: standard output)").typeName("FILE");
  verb.option("--max-memory", o->maxMemory,
              "refuse what needs more, such as 12GiB (default: what the machine has free)")
      .typeName("SIZE");
  verb.option("--slab-height", o->slabHeight,
              "OUT.slabs: height of a slab, voxels (default: what --max-memory allows)")
      .range(0, kMaxImageSide);
  verb.option("--scratch", o->scratch,
              "OUT.slabs: folder for what is done so far (default: beside it)")
      .typeName("DIR");
  verb.flag("--auto-slabs", o->autoSlabs,
            "what does not fit is cut into slabs, and one file made of these");
  verb.flag("--resume", o->resume, "OUT.slabs: go on with what a run left that did not end");
  verb.flag("--dry-run", o->dryRun, "only say how much memory it would take, in slabs also disk");
  verb.onParsed([o, &common, &action] {
    parse(*o);
    if (common.team && !hasSlabsEnding(o->out))
      throw WrongUsage("vdb_madf_mpi writes a folder of slabs: choose an output like OUT.slabs");
    action = [o, &common] { runSegment(*o, besideOutput(common, o->out)); };
  });
}

}  // namespace vdb_madf::tools
