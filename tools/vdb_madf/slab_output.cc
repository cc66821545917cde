// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "slab_output.h"

#include <fmt/core.h>
#include <openvdb/Metadata.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "estimate.h"
#include "member_failure.h"
#include "outputs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/cavities.h"
#include "vdb_madf/slabs/deal_slabs.h"
#include "vdb_madf/slabs/folder_scratch.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/slab_folder_writer.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "work_place.h"

namespace vdb_madf::tools {

namespace {

/// Of any slab: far fewer leaf nodes than can be numbered.
constexpr int64_t kMostSlabBytes = int64_t(8) << 30;
/// That slabs can be cut for.
constexpr int64_t kLeastSlabBytes = int64_t(32) << 20;

/// \p memory: of this process; 0: not known.
SlabLimits limitsOf(const SegmentArguments& o, int64_t memory) {
  SlabLimits limits{kMostSlabBytes, o.slabHeight, o.segment.tidy};
  if (memory == 0) return limits;
  limits.bytes = std::min(memory - kSlabOtherBytes, kMostSlabBytes);
  if (limits.bytes < kLeastSlabBytes)
    throw InvalidInput(
        fmt::format("slabs need at least {} of memory, and {} may be used: allow more",
                    readableBytes(kSlabOtherBytes + kLeastSlabBytes), readableBytes(memory)),
        Hint::memoryLimit);
  return limits;
}

/// Bytes of scratch for each object voxel, of fine snow; coarse grains take a seventh.
constexpr int64_t kScratch = 5, kFilteredScratch = 13;

int64_t memoryFor(const SegmentArguments& o) {
  return o.maxMemory.empty() ? availableMemory() : o.segment.maxMemory;
}

/// Reads the object into slabs; returns it without voxels.
MaskGrid::Ptr readSlabs(const SegmentArguments& o, const Common& common, WorkPlace& place) {
  SlabBuilder builder(limitsOf(o, memoryFor(o)), SlabCosts(o.segment), place.scratch());
  const MaskGrid::Ptr object = streamObject(
      o.input, [&](const MaskTree& layer) { builder.add(layer); }, {}, common.progress);
  writeVdb(place.aboutFile(), {object}, common.progress);
  builder.finish(storedDomain(*object));
  return object;
}

/// The same by several members, each of which reads a part.
MaskGrid::Ptr readShare(const SegmentArguments& o, const Common& common, WorkPlace& place) {
  Team& team = *common.team;
  const SlabLimits limits = limitsOf(o, o.segment.maxMemory);  // others share what is free
  SlabDealer dealer(team, SlabCosts(o.segment), place.scratch());
  MaskGrid::Ptr object;
  inAllMembers(team, [&] {
    object = streamObject(
        o.input, [&](const MaskTree& layer) { dealer.add(layer); }, {team.member(), team.count()},
        common.progress);
    if (team.member() == 0 && !place.isInMemory())
      writeVdb(place.aboutFile(), {object}, common.progress);
  });
  const auto domain = storedDomain(*object);
  dealer.finish(limits, o.segment.fillHoles.value_or(defaultFillHoles(domain)), domain);
  return object;
}

MaskGrid::Ptr storedAbout(const WorkPlace& place) {
  VdbReadOptions any;
  any.anyVoxelShape = true;
  try {
    return openvdb::gridPtrCast<MaskGrid>(readVdb(place.aboutFile(), any).at(0));
  } catch (const IoError&) {
    failDamagedScratch(place.aboutFile());
  }
}

}  // namespace

void checkSlabArguments(const SegmentArguments& o) {
  const bool isSlabs = hasSlabsEnding(o.out);
  if (!isSlabs && (o.slabHeight > 0 || !o.scratch.empty() || o.resume))
    throw WrongUsage("--slab-height, --scratch and --resume are for an output like OUT.slabs");
  if (!isSlabs) return;
  const SegmentOptions& keep = o.segment;
  if (!o.tables.empty())
    throw WrongUsage(o.out + ": tables are made of slabs by vdb_madf measure: leave --tables out");
  if (keep.keepDistance || keep.keepPower || keep.keepBalls)
    throw WrongUsage(o.out + ": slabs get labels and --keep manifold alone: leave other grids out");
  if (o.dryRun && o.resume)
    throw WrongUsage("--resume goes on with work, and --dry-run does none: leave one of them out");
}

namespace {

/// Keeps nothing, for who wants to know where an object would be cut.
class NoScratch : public Scratch {
 public:
  void writeBytes(const std::string&, const char*, size_t) override {}
  void readBytes(const std::string&, const Allocate& allocate) const override { allocate(0); }
  bool has(const std::string&) const override { return false; }
  void remove(const std::string&) override {}
};

/// Adds to the summary of a segmentation what slabs took: `slab_count`, `exchanges`, and of each
/// stage `seconds` and `message_bytes`.
void addSlabCosts(const SlabObject& object, const SlabSegmentation& s, Json& json) {
  json["slab_count"] = object.slabCount();
  json["exchanges"] = s.exchanges;
  for (const SlabStage& stage : s.stages)
    json["stages"].push_back(
        {{"name", stage.name}, {"seconds", stage.seconds}, {"message_bytes", stage.messageBytes}});
}

/// The part of what is said of the segmentation that index.json says, too, as JSON.
std::string aboutSlabs(const SegmentArguments& o, const Json& summary) {
  Json index = Json::object();
  for (const auto& [key, value] : summary.items())
    if (key.rfind("seconds_", 0) != 0 && key.rfind("page_faults_", 0) != 0 &&
        key.find("memory") == std::string::npos && key != "threads" && key != "stages" &&
        key != "exchanges" && key != "ranks" && key != "output" && key != "hints" &&
        key != "input" && key != "notes")
      index[key] = value;
  index.update(originOf(o));
  return index.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Reads, segments and puts slabs in their place. @param jsonFile of member 0; null for the others
void workInSlabs(const SegmentArguments& o, const Common& common, Team& team, WorkPlace& place,
                 JsonFile* jsonFile) {
  const Clock::time_point start = Clock::now();
  SegmentTiming timing;
  common.progress->start("read");
  const MaskGrid::Ptr about = place.holdsSlabs() ? storedAbout(place)
                              : common.team      ? readShare(o, common, place)
                                                 : readSlabs(o, common, place);
  timing.read = secondsSince(start);
  SegmentOptions options = o.segment;
  options.boundary = boundaryOf(o.boundary, o.input, *about, common.progress);
  options.maxMemory = 0;
  const SlabObject object = storedSlabs(place.scratch(), about);
  place.checkSlabs(object.slabCount());

  common.progress->start("segment");
  const SlabSegmentation s = withFileName(o.input.path, [&] {
    return segmentSlabs(
        object, options, place.scratch(), team,
        [&](size_t slab, const SlabGrids& grids) {
          const Clock::time_point startWrite = Clock::now();
          std::vector<openvdb::GridBase::ConstPtr> written{grids.grain};
          if (grids.manifold) written.push_back(grids.manifold);
          writeSlab(place.part(), slab, object.slabCount(), written, common.progress);
          timing.write += secondsSince(startWrite);
        },
        common.progress);
  });
  common.progress->end();
  if (!jsonFile) return;
  timing.total = secondsSince(start);
  const SegmentSummary summary = summarize(o, common, s, *about, timing);
  Json json = toJson(o, summary);
  addSlabCosts(object, s, json);
  json["seconds_scratch"] = place.scratchSeconds();
  if (common.team) json["ranks"] = team.count();
  addNotes(json, *common.progress);
  writeSlabIndex(place.part(), object.cuts, aboutSlabs(o, json));
  place.finish();
  jsonFile->write(json);
  if (common.quiet || jsonFile->isStandardOutput()) return;
  print(o, common, summary);
  const std::string by = ", by " + std::to_string(team.count()) + " processes";
  std::printf("  slabs            %zu%s%s\n", object.slabCount(), common.team ? by.c_str() : "",
              o.fileOfSlabs.empty() ? ", each a .vdb; convert makes one of them" : "");
}

}  // namespace

void estimateSlabs(const SegmentArguments& o, const Common& common) {
  if (common.team) throw WrongUsage("--dry-run is for one process: take vdb_madf");
  const Clock::time_point start = Clock::now();
  JsonFile jsonFile(o.json);
  SegmentEstimate estimate;
  estimate.limit = memoryFor(o);
  common.progress->start("read");
  NoScratch nowhere;
  SlabBuilder builder(limitsOf(o, estimate.limit), SlabCosts(o.segment), nowhere);
  const MaskGrid::Ptr about = streamObject(
      o.input,
      [&](const MaskTree& layer) {
        estimate.voxels += int64_t(layer.activeVoxelCount());
        estimate.leaves += int64_t(layer.leafCount());
        builder.add(layer);
      },
      {}, common.progress);
  builder.finish(storedDomain(*about));
  boundaryOf(o.boundary, o.input, *about, common.progress);
  estimate.memory = kSlabOtherBytes + std::max(builder.bytes(), kLeastSlabBytes);
  estimate.slabs = int64_t(builder.slabCount());
  estimate.scratch = estimate.voxels * (o.segment.gamma > 1 ? kFilteredScratch : kScratch);
  estimate.secondsRead = secondsSince(start);
  common.progress->end();
  say(o, common, estimate, jsonFile);
}

/// Reads all slabs of a folder that may be damaged. @throw IoError, which says what to do
void checkWhole(const std::string& path, Progress* progress) {
  try {
    const SlabFolder folder = openSlabFolder(path);
    for (size_t slab = 0; slab < folder.slabCount(); ++slab)
      readVdbSlab(folder, slab, {}, progress);
  } catch (const IoError& error) {
    throw IoError(fmt::format("{}: to make it anew, remove {} first", error.what(), path));
  }
}

/// Says that there is nothing to do, and what the folder knows of itself: not what its run took.
void sayDone(const SegmentArguments& o, const Common& common, const std::string& why) {
  common.progress->note(o.out + why);
  JsonFile jsonFile(o.json);
  std::ifstream file((std::filesystem::path(o.out) / kSlabIndex).string());
  Json json = Json::parse(file, nullptr, false);
  if (!json.is_object()) return;
  json["slab_count"] = json["slabs"].size();
  for (const char* ofIndex : {"format", "format_version", "slabs", "digest"}) json.erase(ofIndex);
  json["output"] = o.out;
  addNotes(json, *common.progress);
  jsonFile.write(json);
}

void runInSlabs(const SegmentArguments& o, const Common& common) {
  Team alone;
  Team& team = common.team ? *common.team : alone;
  checkAlike(o, team);
  bool finished = false;
  inAllMembers(team, [&] { finished = o.resume && isFinished(o); });
  if (finished) {
    inAllMembers(team, [&] {
      if (team.member() == 0) checkWhole(o.out, common.progress);
    });
    if (team.member() == 0) sayDone(o, common, ": is finished, there is nothing to go on with");
    return;
  }
  std::optional<JsonFile> jsonFile;
  if (team.member() == 0) jsonFile.emplace(o.json);
  WorkPlace place(o, common, team);
  if (place.isDone()) {
    place.finish();
    if (team.member() == 0) sayDone(o, common, ": was whole already");
    return;
  }
  try {
    workInSlabs(o, common, team, place, jsonFile ? &*jsonFile : nullptr);
  } catch (const InvalidInput&) {
    common.progress->end();
    place.abandon(true);
    throw;
  } catch (...) {
    common.progress->end();
    place.abandon(false);
    throw;
  }
}

}  // namespace vdb_madf::tools
