// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/segment.h"
#include "vdb_madf/base/memory.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "command.h"
#include "input_options.h"
#include "json_file.h"
#include "merge_options.h"
#include "outputs.h"
#include "parse.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/measure/grain_sizes.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/method/ball_grids.h"
#include "vdb_madf/method/segment_memory.h"
#include "vdb_madf/method/segmentation_metadata.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  InputOptions input;
  std::string out, gamma = "0", boundary = "auto", keep, json, maxMemory, tables;
  MergeArguments merge;
  bool paper = false, dryRun = false;
  SegmentOptions segment;
};

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void parse(Options& o) {
  o.input.outputs = {o.out, o.json};
  if (!o.tables.empty())
    for (const std::string& path : MeasurementTables::paths(o.tables))
      o.input.outputs.push_back(path);
  o.input.parse();
  if (!o.maxMemory.empty()) o.segment.maxMemory = parseMemory(o.maxMemory);
  if (o.out.empty() && !o.dryRun) throw WrongUsage("OUT.vdb is required (or --dry-run)");
  if (!o.out.empty() && !hasVdbEnding(o.out))
    throw WrongUsage(o.out + ": the output's ending must be .vdb");
  if (o.paper) {
    if (!o.merge.mode.empty() || !o.merge.adjacency.empty())
      throw WrongUsage("--paper sets --merge and --adjacency itself: leave them out");
    o.merge.mode = "angle";
    o.merge.adjacency = "cell";
    if (o.merge.theta.empty()) o.merge.theta = "-0.8";
  }
  o.segment.merge = o.merge.parse();
  o.segment.gamma = parseGamma(o.gamma);
  std::stringstream keep(o.keep);
  for (std::string what; std::getline(keep, what, ',');) {
    if (what == "distance")
      o.segment.keepDistance = true;
    else if (what == "power")
      o.segment.keepPower = true;
    else if (what == "manifold")
      o.segment.keepManifold = true;
    else if (what == "balls")
      o.segment.keepBalls = true;
    else
      throw WrongUsage("--keep " + what + ": can keep distance, power, manifold and balls");
  }
}

struct Timing {
  double read = 0, measure = 0, write = 0, total = 0;
};

/// What is said of a segmentation, by the lines that are printed and by the JSON.
struct Summary {
  SegmentCounts counts;
  GrainSizes sizes;
  std::optional<CoordBBox> domain;
  std::optional<VoxelSize> voxelSize;
  bool open = false;
  int threads = 0;
  std::vector<std::pair<std::string, double>> seconds;  ///< of each part of the work, then "total"
  std::vector<std::pair<std::string, int64_t>> peakBytesUntil;  ///< the end of each stage
  int64_t peakBytes = 0;

  std::optional<double> porosity() const {
    if (!domain) return std::nullopt;
    return 1 - double(counts.objectVoxels) / double(domain->volume());
  }
};

Summary summarize(const Options& o, const Common& common, const Segmentation& s,
                  const Timing& timing) {
  Summary summary;
  summary.counts = s.counts;
  summary.sizes = grainSizes(s.grainVoxels);
  summary.domain = s.domain;
  summary.voxelSize = storedVoxelSize(*s.grain);
  summary.open = s.open;
  summary.threads = usedThreads(common.threads);
  summary.seconds.emplace_back("read", timing.read);
  for (const StageTime& stage : s.times) {
    summary.seconds.emplace_back(stage.stage, stage.seconds);
    summary.peakBytesUntil.emplace_back(stage.stage, stage.peakBytes);
  }
  if (!o.tables.empty()) summary.seconds.emplace_back("measure", timing.measure);
  summary.seconds.emplace_back("write", timing.write);
  summary.seconds.emplace_back("total", timing.total);
  summary.peakBytes = peakMemory();
  return summary;
}

Json toJson(const Options& o, const Summary& summary) {
  const SegmentCounts& counts = summary.counts;
  Json json;
  json["input"] = o.input.path;
  json["output"] = o.out;
  json["object_voxels"] = counts.objectVoxels;
  json["medial_balls"] = counts.medialBalls;
  json["kept_balls"] = counts.keptBalls;
  json["critical_points"] = counts.criticalPoints;
  json["grains"] = counts.grains;
  json["largest_squared_distance"] = counts.largestSquaredDistance;
  json["leaves"] = counts.leaves;
  if (const auto& domain = summary.domain) {
    json["domain_min"] = {domain->min().x(), domain->min().y(), domain->min().z()};
    json["domain_max"] = {domain->max().x(), domain->max().y(), domain->max().z()};
    json["porosity"] = *summary.porosity();
  }
  if (summary.voxelSize) json["voxel_size_mm"] = summary.voxelSize->metres * 1e3;
  json["grains_under_100_voxels"] = summary.sizes.dustGrains;
  json["voxels_in_grains_under_100_voxels"] = summary.sizes.dustVoxels;
  json["grain_diameter_d10_voxels"] = summary.sizes.d10;
  json["grain_diameter_d50_voxels"] = summary.sizes.d50;
  json["grain_diameter_d90_voxels"] = summary.sizes.d90;
  for (const auto& [key, value] : {std::pair<const char*, std::string>{"grid", o.input.gridName},
                                   {"phase", o.input.phase},
                                   {"threshold", o.input.threshold},
                                   {"range", o.input.range},
                                   {"keep", o.keep}})
    if (!value.empty()) json[key] = value;
  if (o.input.invert) json["invert"] = true;
  json["gamma"] = o.segment.gamma;
  json["theta"] = o.segment.merge.theta;
  json["boundary"] = summary.open ? "open" : "closed";
  json["merge"] = toString(o.segment.merge.mode);
  json["adjacency"] = toString(o.segment.merge.adjacency);
  json["threads"] = summary.threads;
  for (const auto& [part, seconds] : summary.seconds) json["seconds_" + part] = seconds;
  for (const auto& [stage, bytes] : summary.peakBytesUntil)
    json["peak_memory_bytes_until_" + stage] = bytes;
  json["peak_memory_bytes"] = summary.peakBytes;
  return json;
}

void print(const Options& o, const Common& common, const Summary& summary) {
  const SegmentCounts& counts = summary.counts;
  const GrainSizes& sizes = summary.sizes;
  const auto count = [](int64_t number) { return (long long)number; };
  std::printf("%s: %lld grains\n", o.out.c_str(), count(counts.grains));
  std::printf("  object           %lld voxels in %lld leaf nodes%s\n", count(counts.objectVoxels),
              count(counts.leaves), hintIfEmpty(counts.objectVoxels));
  if (summary.domain) std::printf("  porosity         %.2f %%\n", 100 * *summary.porosity());
  const double um = summary.voxelSize ? 1e3 * (summary.voxelSize->metres * 1e3) : 0;
  if (summary.voxelSize)
    std::printf("  voxel size       %g um\n", um);
  else
    std::printf("  voxel size       unknown, so no physical sizes (give --voxel-size)\n");
  std::printf("  grain diameter   d10 %.1f, d50 %.1f, d90 %.1f voxels", sizes.d10, sizes.d50,
              sizes.d90);
  if (summary.voxelSize)
    std::printf(" = %.4g, %.4g, %.4g um", um * sizes.d10, um * sizes.d50, um * sizes.d90);
  std::printf(" (equal volume, by volume)\n");
  std::printf("  dust             %lld grains under 100 voxels, %.3f %% of the object\n",
              count(sizes.dustGrains),
              100 * double(sizes.dustVoxels) / std::max(1.0, double(counts.objectVoxels)));
  std::printf("  medial balls     %lld, kept %lld; critical points %lld\n",
              count(counts.medialBalls), count(counts.keptBalls), count(counts.criticalPoints));
  std::printf("  settings         gamma %lld, theta %g, merge %s, adjacency %s, boundary %s\n",
              count(o.segment.gamma), o.segment.merge.theta, toString(o.segment.merge.mode),
              toString(o.segment.merge.adjacency), summary.open ? "open" : "closed");
  std::printf("  time, memory     %.2f s with %d threads, %.0f MiB at the peak\n",
              summary.seconds.back().second, summary.threads,
              double(summary.peakBytes) / (1 << 20));
  if (!common.verbose) return;
  for (const auto& [part, seconds] : summary.seconds)
    std::printf("    %-24s %8.3f s\n", part.c_str(), seconds);
}

/// What segmenting would take, without doing it.
void printEstimate(const Options& o, const Common& common, const MaskGrid& object,
                   const SegmentOptions& options, double secondsRead, JsonFile& jsonFile) {
  const ObjectSize size = objectSize(object);
  const int64_t mask = int64_t(object.memUsage()), needed = mask + segmentMemory(size, options);
  Json json;
  json["input"] = o.input.path;
  json["object_voxels"] = size.voxels;
  json["leaves"] = size.leaves;
  json["estimated_memory_bytes"] = needed;
  json["memory_limit_bytes"] = mask + options.maxMemory;
  json["seconds_read"] = secondsRead;
  const bool fits = needed <= mask + options.maxMemory;
  json["fits"] = fits;
  jsonFile.write(json);
  if (common.quiet || jsonFile.isStandardOutput()) return;
  std::printf("%s: %lld object voxels in %lld leaf nodes\n", o.input.path.c_str(),
              (long long)size.voxels, (long long)size.leaves);
  std::printf("  memory           about %s (%lld bytes) to segment it\n",
              readableBytes(needed).c_str(), (long long)needed);
  std::printf("  limit            %s: %s\n", readableBytes(mask + options.maxMemory).c_str(),
              fits ? "it fits" : "it does not fit");
}

void run(const Options& o, const Common& common) {
  const Clock::time_point start = Clock::now();
  Timing timing;
  if (!o.dryRun) checkWritable(o.out);
  JsonFile jsonFile(o.json);
  std::optional<MeasurementTables> tables;
  if (!o.tables.empty() && !o.dryRun) tables.emplace(o.tables);
  common.progress->start("read");
  MaskGrid::Ptr object = loadObject(o.input, common.progress);
  SegmentOptions options = o.segment;
  options.boundary = boundaryOf(o.boundary, o.input, *object);
  timing.read = secondsSince(start);

  // What is free now, or what was allowed for the whole process, less the mask.
  if (o.maxMemory.empty())
    options.maxMemory = availableMemory();
  else
    options.maxMemory = std::max<int64_t>(1, options.maxMemory - int64_t(object->memUsage()));
  if (o.dryRun) {
    common.progress->end();
    return printEstimate(o, common, *object, options, timing.read, jsonFile);
  }

  Segmentation s =
      withFileName(o.input.path, [&] { return segment(*object, options, common.progress); });
  object.reset();

  if (tables) {
    const Clock::time_point startMeasure = Clock::now();
    tables->write(measure(s, common.progress));
    timing.measure = secondsSince(startMeasure);
  }

  common.progress->start("write");
  std::vector<openvdb::GridBase::ConstPtr> grids{s.grain};
  for (const Int32Grid::Ptr& grid : {s.distanceSquared, s.power, s.manifold})
    if (grid) grids.push_back(grid);
  if (options.keepBalls)
    for (const Int32Grid::Ptr& grid : ballGrids(s)) grids.push_back(grid);
  writeVdb(o.out, grids, common.progress);

  timing.total = secondsSince(start);
  timing.write = timing.total - timing.read - timing.measure;
  for (const StageTime& stage : s.times) timing.write -= stage.seconds;
  common.progress->end();
  const Summary summary = summarize(o, common, s, timing);
  jsonFile.write(toJson(o, summary));
  if (!common.quiet && !jsonFile.isStandardOutput()) print(o, common, summary);
}

}  // namespace

void addSegment(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<Options>();
  Verb verb = addVerb(command, common, "segment", "cut the object into grains",
                      "vdb_madf segment scan.tif grains.vdb --phase 1 --voxel-size 8.5um");
  verb.option("IN", o->input.path, "any readable volume").required();
  verb.option("OUT.vdb", o->out, "gets the Int32 grid 'grain'");
  o->input.addSelection(verb);
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  o->input.addDomain(verb);
  verb.option("--gamma", o->gamma, "least cell of a medial ball, voxels").showDefault();
  addBoundary(verb, o->boundary);
  o->merge.add(verb);
  verb.flag("--paper", o->paper, "the paper's merging: angle, cell, theta -0.8 unless given");
  verb.option("--keep", o->keep, "more grids: distance,power,manifold,balls").typeName("LIST");
  verb.option("--tables", o->tables, "also measure: grains.csv, bonds.csv, sample.json in here")
      .typeName("DIR");
  verb.option("--json", o->json, "machine-readable summary (-: standard output)").typeName("FILE");
  verb.option("--max-memory", o->maxMemory,
              "refuse what needs more, such as 12GiB (default: what the machine has free)")
      .typeName("SIZE");
  verb.flag("--dry-run", o->dryRun, "only say how much memory it would take");
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] { run(*o, common); };
  });
}

}  // namespace vdb_madf::tools
