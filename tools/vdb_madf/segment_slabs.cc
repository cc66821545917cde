// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "segment_slabs.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

#include "parse.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/slabs/folder_scratch.h"
#include "vdb_madf/slabs/slab_builder.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What the slabs in scratch depend on.
std::string workOf(const SegmentArguments& o) {
  const InputOptions& in = o.input;
  std::error_code ignored;
  std::string work =
      std::string(kVersion) + "\n" + fs::absolute(in.path, ignored).string() + " " +
      std::to_string(fs::file_size(in.path, ignored)) + " " +
      std::to_string(fs::last_write_time(in.path, ignored).time_since_epoch().count());
  for (const std::string& text :
       {in.gridName,  in.dataset,        in.dims,       in.type,     in.skip,
        in.phase,     in.threshold,      in.range,      in.median,   in.smooth,
        in.despeckle, in.voxelSizeText,  in.domainText, in.roi,      in.cropText,
        o.boundary,   o.gamma,           o.fillHoles,   o.tidy,      o.merge.theta,
        o.merge.mode, o.merge.adjacency, o.merge.delta, o.maxMemory, std::to_string(o.slabHeight)})
    work += "\n" + text;
  for (const bool flag : {in.bigEndian, in.invert, o.paper}) work += flag ? "\nyes" : "\nno";
  return work;
}

SlabLimits limitsOf(const SegmentArguments& o) {
  SlabLimits limits;
  limits.height = o.slabHeight;
  limits.leastHeight = o.segment.tidy;
  const int64_t memory = o.maxMemory.empty() ? availableMemory() : o.segment.maxMemory;
  if (memory == 0) return limits;
  const int64_t voxels = (memory - kSlabOtherBytes) / kSlabBytesPerVoxel;
  if (voxels < 1 << 20)
    throw InvalidInput("slabs need at least " +
                           readableBytes(kSlabOtherBytes + (kSlabBytesPerVoxel << 20)) +
                           " of memory, and " + readableBytes(memory) + " may be used: allow more",
                       Hint::memoryLimit);
  limits.voxels = voxels;
  return limits;
}

/// Folders of work that is not done yet.
class WorkPlace {
 public:
  explicit WorkPlace(const SegmentArguments& o) : part_(o.out + ".part") {
    checkSlabFolder(o.out);
    std::error_code error;
    const bool isNew = fs::create_directory(part_, error);
    if (error) throw IoError("cannot make " + part_ + ": " + error.message());
    if (!isNew && !o.resume && !fs::is_empty(part_, error))
      throw IoError(part_ +
                    ": is what a run left that did not end: give --resume to go on, or remove it");
    const std::string scratch =
        o.scratch.empty() ? (fs::path(part_) / "scratch").string() : o.scratch;
    try {
      scratch_.emplace(scratch, workOf(o), o.resume);
    } catch (...) {
      if (isNew) fs::remove_all(part_, error);
      throw;
    }
  }

  FolderScratch& scratch() { return *scratch_; }
  std::string file(const std::string& name) const { return (fs::path(part_) / name).string(); }

  /// Puts the folder in the place of OUT.
  void finish(const std::string& out) {
    scratch_->removeAll();
    commitSlabFolder(part_, out);
  }
  void discard() {
    std::error_code ignored;
    scratch_->removeAll();
    fs::remove_all(part_, ignored);
  }

 private:
  std::string part_;
  std::optional<FolderScratch> scratch_;
};

/// Reads the object into slabs; returns it without voxels.
MaskGrid::Ptr readSlabs(const SegmentArguments& o, const Common& common, WorkPlace& place) {
  const std::string about = place.scratch().file("about.vdb");
  if (hasSlabs(place.scratch())) {
    VdbReadOptions any;
    any.anyVoxelShape = true;
    return openvdb::gridPtrCast<MaskGrid>(readVdb(about, any).at(0));
  }
  SlabBuilder builder(limitsOf(o), place.scratch());
  VolumeOptions volume = o.input.volume(common.progress);
  volume.takeLayer = [&](const MaskTree& layer) { builder.add(layer); };
  const MaskGrid::Ptr object = loadObject(o.input, volume, common.progress);
  writeVdb(about, {object}, common.progress);
  builder.finish(storedDomain(*object));
  return object;
}

Json indexOf(const SegmentArguments& o, const SlabObject& object, const Json& summary) {
  Json index;
  index["format"] = "vdb_madf slabs";
  index["format_version"] = 1;
  index["version"] = kVersion;
  index["slabs"] = Json::array();
  for (size_t s = 0; s < object.slabCount(); ++s)
    index["slabs"].push_back({{"file", slabFileName(s)},
                              {"z_first", object.cuts[s]},
                              {"z_last", object.cuts[s + 1] - 1}});
  for (const auto& [key, value] : summary.items())
    if (key.rfind("seconds_", 0) != 0 && key.find("memory") == std::string::npos &&
        key != "threads" && key != "output" && key != "hints" && key != "input")
      index[key] = value;
  index["input"] = fs::path(o.input.path).filename().string();
  return index;
}

}  // namespace

bool hasSlabsEnding(const std::string& path) {
  return fileEnding(path) == ".slabs";
}

void checkSlabArguments(const SegmentArguments& o) {
  const bool isSlabs = hasSlabsEnding(o.out);
  if (!isSlabs && (o.slabHeight > 0 || !o.scratch.empty() || o.resume))
    throw WrongUsage("--slab-height, --scratch and --resume are for an output like OUT.slabs");
  if (!isSlabs) return;
  if (!o.keep.empty() || !o.tables.empty() || o.dryRun)
    throw WrongUsage(o.out + ": slabs get labels alone: leave --keep, --tables and --dry-run out");
  if (o.segment.gamma > 1)
    throw WrongUsage(o.out + ": --gamma does not work in slabs yet: leave it out");
  if (!o.input.roi.empty())
    throw WrongUsage(o.out + ": --roi does not work in slabs yet: take a box with --crop");
}

void runInSlabs(const SegmentArguments& o, const Common& common) {
  const Clock::time_point start = Clock::now();
  SegmentTiming timing;
  JsonFile jsonFile(o.json);
  WorkPlace place(o);
  try {
    common.progress->start("read");
    const MaskGrid::Ptr about = readSlabs(o, common, place);
    timing.read = secondsSince(start);
    SegmentOptions options = o.segment;
    options.boundary = boundaryOf(o.boundary, o.input, *about);
    options.maxMemory = 0;
    const SlabObject object = storedSlabs(place.scratch(), about);

    common.progress->start("segment");
    const SlabSegmentation s = withFileName(o.input.path, [&] {
      return segmentSlabs(
          object, options, place.scratch(),
          [&](size_t slab, const Int32Grid::Ptr& grain) {
            const Clock::time_point startWrite = Clock::now();
            markSlab(*grain, slab, object.slabCount());
            writeVdb(place.file(slabFileName(slab)), {grain}, common.progress);
            timing.write += secondsSince(startWrite);
          },
          common.progress);
    });
    timing.total = secondsSince(start);
    common.progress->end();
    const SegmentSummary summary = summarize(o, common, s, *about, timing);
    Json json = toJson(o, summary);
    json["slab_count"] = object.slabCount();
    addNotes(json, *common.progress);
    JsonFile(place.file(kSlabIndex)).write(indexOf(o, object, json));
    place.finish(o.out);
    jsonFile.write(json);
    if (common.quiet || jsonFile.isStandardOutput()) return;
    print(o, common, summary);
    std::printf("  slabs            %zu, each a .vdb; convert makes one of them\n",
                object.slabCount());
  } catch (const InvalidInput&) {  // it would be the same again
    common.progress->end();
    place.discard();
    throw;
  } catch (...) {
    common.progress->end();
    if (!hasSlabs(place.scratch()))
      place.discard();
    else
      common.progress->note(o.out +
                            ".part: what was done so far is kept: give --resume to go on, or "
                            "remove the folder");
    throw;
  }
}

}  // namespace vdb_madf::tools
