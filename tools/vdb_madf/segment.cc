// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/segment.h"
#include "vdb_madf/base/memory.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <sstream>

#include "command.h"
#include "input_options.h"
#include "json_file.h"
#include "merge_options.h"
#include "outputs.h"
#include "parse.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/measure/measure.h"
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

constexpr int64_t kDustVoxels = 100;

/// Diameter of the ball of a grain's volume, in voxels, of which the given share of the object
/// lies in smaller grains. \p sizes ascending.
double diameterAtShare(const std::vector<int64_t>& sizes, int64_t object, double share) {
  int64_t below = 0;
  for (const int64_t size : sizes) {
    below += size;
    if (double(below) >= share * double(object)) return std::cbrt(6 * double(size) / M_PI);
  }
  return 0;
}

/// Size distribution: by volume, so that dust does not hide the grains.
void addGrainSizes(const Segmentation& s, Json& json) {
  std::vector<int64_t> sizes = s.grainVoxels;
  std::sort(sizes.begin(), sizes.end());
  int64_t dust = 0, dustVoxels = 0;
  for (const int64_t size : sizes) {
    if (size >= kDustVoxels) break;
    ++dust;
    dustVoxels += size;
  }
  json["grains_under_100_voxels"] = dust;
  json["voxels_in_grains_under_100_voxels"] = dustVoxels;
  for (const auto& [key, share] : {std::pair<const char*, double>{"grain_diameter_d10_voxels", 0.1},
                                   {"grain_diameter_d50_voxels", 0.5},
                                   {"grain_diameter_d90_voxels", 0.9}})
    json[key] = diameterAtShare(sizes, s.counts.objectVoxels, share);
}

Json summary(const Options& o, const Common& common, const Segmentation& s, const Timing& timing) {
  const SegmentCounts& counts = s.counts;
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
  if (s.domain) {
    const double volume = double(s.domain->volume());
    json["domain_min"] = {s.domain->min().x(), s.domain->min().y(), s.domain->min().z()};
    json["domain_max"] = {s.domain->max().x(), s.domain->max().y(), s.domain->max().z()};
    json["porosity"] = 1 - double(counts.objectVoxels) / volume;
  }
  if (const auto size = storedVoxelSize(*s.grain)) json["voxel_size_mm"] = size->metres * 1e3;
  addGrainSizes(s, json);
  for (const auto& [key, value] : {std::pair<const char*, std::string>{"grid", o.input.gridName},
                                   {"phase", o.input.phase},
                                   {"threshold", o.input.threshold},
                                   {"range", o.input.range},
                                   {"keep", o.keep}})
    if (!value.empty()) json[key] = value;
  if (o.input.invert) json["invert"] = true;
  json["gamma"] = o.segment.gamma;
  json["theta"] = o.segment.merge.theta;
  json["boundary"] = s.open ? "open" : "closed";
  json["merge"] = toString(o.segment.merge.mode);
  json["adjacency"] = toString(o.segment.merge.adjacency);
  json["threads"] = usedThreads(common);
  json["seconds_read"] = timing.read;
  for (const StageTime& stage : s.times) json["seconds_" + stage.stage] = stage.seconds;
  if (!o.tables.empty()) json["seconds_measure"] = timing.measure;
  json["seconds_write"] = timing.write;
  json["seconds_total"] = timing.total;
  for (const StageTime& stage : s.times)
    json["peak_memory_bytes_until_" + stage.stage] = stage.peakBytes;
  json["peak_memory_bytes"] = peakMemory();
  return json;
}

void printSummary(const Options& o, const Common& common, const Json& json) {
  const auto number = [&](const char* key) { return json[key].get<double>(); };
  const auto count = [&](const char* key) { return (long long)json[key].get<int64_t>(); };
  std::printf("%s: %lld grains\n", o.out.c_str(), count("grains"));
  std::printf("  object           %lld voxels in %lld leaf nodes%s\n", count("object_voxels"),
              count("leaves"), hintIfEmpty(count("object_voxels")));
  if (json.contains("porosity"))
    std::printf("  porosity         %.2f %%\n", 100 * number("porosity"));
  if (json.contains("voxel_size_mm"))
    std::printf("  voxel size       %g um\n", 1e3 * number("voxel_size_mm"));
  else
    std::printf("  voxel size       unknown, so no physical sizes (give --voxel-size)\n");
  const double d10 = number("grain_diameter_d10_voxels"), d50 = number("grain_diameter_d50_voxels"),
               d90 = number("grain_diameter_d90_voxels");
  std::printf("  grain diameter   d10 %.1f, d50 %.1f, d90 %.1f voxels", d10, d50, d90);
  if (json.contains("voxel_size_mm")) {
    const double um = 1e3 * number("voxel_size_mm");
    std::printf(" = %.4g, %.4g, %.4g um", um * d10, um * d50, um * d90);
  }
  std::printf(" (equal volume, by volume)\n");
  std::printf(
      "  dust             %lld grains under 100 voxels, %.3f %% of the object\n",
      count("grains_under_100_voxels"),
      100 * number("voxels_in_grains_under_100_voxels") / std::max(1.0, number("object_voxels")));
  std::printf("  medial balls     %lld, kept %lld; critical points %lld\n", count("medial_balls"),
              count("kept_balls"), count("critical_points"));
  std::printf("  settings         gamma %lld, theta %g, merge %s, adjacency %s, boundary %s\n",
              count("gamma"), number("theta"), json["merge"].get<std::string>().c_str(),
              json["adjacency"].get<std::string>().c_str(),
              json["boundary"].get<std::string>().c_str());
  std::printf("  time, memory     %.2f s with %lld threads, %.0f MiB at the peak\n",
              number("seconds_total"), count("threads"), number("peak_memory_bytes") / (1 << 20));
  if (!common.verbose) return;
  for (const auto& [key, value] : json.items())
    if (key.rfind("seconds_", 0) == 0)
      std::printf("    %-24s %8.3f s\n", key.c_str() + 8, value.get<double>());
}

/// The medial balls as two grids that share their voxels, the centres: squared radius, cell size.
std::vector<Int32Grid::Ptr> ballGrids(const Segmentation& s) {
  std::vector<Int32Grid::Ptr> grids;
  for (const char* gridName : {"balls", "balls_cell_size"}) {
    auto grid = Int32Grid::create(0);
    auto accessor = grid->getAccessor();
    const bool radius = grids.empty();
    for (const MedialBall& ball : s.balls)
      accessor.setValueOn(ball.center, radius ? ball.squaredRadius : int32_t(ball.cellSize));
    for (auto meta = s.grain->beginMeta(); meta != s.grain->endMeta(); ++meta)
      grid->insertMeta(meta->first, *meta->second);
    grid->setName(gridName);
    grid->setTransform(s.grain->transform().copy());
    grids.push_back(grid);
  }
  return grids;
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
  json["fits"] = needed <= mask + options.maxMemory;
  jsonFile.write(json);
  if (common.quiet || jsonFile.isStandardOutput()) return;
  std::printf("%s: %lld object voxels in %lld leaf nodes\n", o.input.path.c_str(),
              (long long)size.voxels, (long long)size.leaves);
  std::printf("  memory           about %s (%lld bytes) to segment it\n",
              readableBytes(needed).c_str(), (long long)needed);
  std::printf("  limit            %s: %s\n", readableBytes(mask + options.maxMemory).c_str(),
              json["fits"].get<bool>() ? "it fits" : "it does not fit");
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
  const Json json = summary(o, common, s, timing);
  jsonFile.write(json);
  if (!common.quiet && !jsonFile.isStandardOutput()) printSummary(o, common, json);
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
