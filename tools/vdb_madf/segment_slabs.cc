// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "segment_slabs.h"

#include <openvdb/Metadata.h>

#include <algorithm>
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

/// What the slabs in scratch depend on.
std::string workOf(const SegmentArguments& o) {
  const InputOptions& in = o.input;
  std::error_code ignored;
  std::string work =
      std::string(kVersion) + "\n" + fs::absolute(o.out, ignored).string() + "\n" +
      fs::absolute(in.path, ignored).string() + " " +
      std::to_string(fs::file_size(in.path, ignored)) + " " +
      std::to_string(fs::last_write_time(in.path, ignored).time_since_epoch().count());
  for (const std::string& text : {in.gridName,   in.dataset,
                                  in.dims,       in.type,
                                  in.skip,       in.phase,
                                  in.threshold,  in.range,
                                  in.median,     in.smooth,
                                  in.despeckle,  in.voxelSizeText,
                                  in.domainText, in.roi,
                                  in.cropText,   o.boundary,
                                  o.gamma,       o.fillHoles,
                                  o.tidy,        o.merge.theta,
                                  o.merge.mode,  o.merge.adjacency,
                                  o.merge.delta, o.keep,
                                  o.maxMemory,   std::to_string(o.slabHeight)})
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

/// Is a path that of a folder, or of something in it?
bool isWithin(const std::string& path, const std::string& folder) {
  std::error_code ignored;
  const std::string a = (fs::weakly_canonical(fs::absolute(path, ignored), ignored) / "").string(),
                    b = (fs::weakly_canonical(fs::absolute(folder, ignored), ignored) / "")
                            .string();
  return a.compare(0, b.size(), b) == 0;
}

constexpr char kDone[] = "done";  // the piece that says that OUT.slabs.part is whole

/// Folders of work that is not done yet: the slabs that are, and scratch.
class WorkPlace {
 public:
  explicit WorkPlace(const SegmentArguments& o) : out_(o.out), part_(o.out + ".part") {
    checkSlabFolder(out_);
    const std::string scratch = o.scratch.empty() ? o.out + ".scratch" : o.scratch;
    if (isWithin(out_, scratch) || isWithin(scratch, out_) || isWithin(scratch, part_))
      throw IoError("scratch data cannot be in " + scratch + ", for " + out_ +
                    ": choose another folder");
    std::error_code error;
    const bool isNew = fs::create_directory(part_, error);
    if (error)
      throw IoError("cannot make " + part_ + ": " + error.message() +
                    "; make its folder first, or remove what is there");
    if (!isNew && !o.resume && !fs::is_empty(part_, error))
      throw IoError(part_ +
                    ": is what a run left that did not end: give --resume to go on, or remove it");
    try {
      scratch_.emplace(scratch, workOf(o), o.resume);
    } catch (...) {
      if (isNew) fs::remove(part_, error);
      throw;
    }
    if (!hasSlabs(*scratch_)) clear();
  }

  FolderScratch& scratch() { return *scratch_; }
  std::string file(const std::string& name) const { return (fs::path(part_) / name).string(); }

  /// @throw IoError if slabs are missing that a run before wrote
  void checkSlabs(size_t count) const {
    std::error_code ignored;
    for (size_t s = 0; s < count; ++s)
      if (isSlabPut(*scratch_, s) && !fs::exists(file(slabFileName(s)), ignored))
        throw IoError(file(slabFileName(s)) + ": is missing; remove " + part_ + " and " +
                      scratch_->path() + ", and begin anew");
  }

  bool isDone() const { return scratch_->has(kDone); }
  /// Puts the folder in the place of OUT, and removes scratch.
  void finish() {
    std::error_code ignored;
    scratch_->write(kDone, {});
    if (fs::exists(file(kSlabIndex), ignored)) commitSlabFolder(part_, out_);
    fs::remove(part_, ignored);  // of a run that was killed in what follows
    scratch_->removeAll();
  }
  void discard() {
    std::error_code ignored;
    clear();
    fs::remove(part_, ignored);
    scratch_->removeAll();
  }
  std::string whatIsKept() const {
    return "what was done so far is kept in " + part_ + " and " + scratch_->path() +
           ": give --resume to go on, or remove both";
  }

 private:
  void clear() {
    std::error_code error;
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(part_, error)) files.push_back(entry.path());
    for (const fs::path& path : files) fs::remove(path, error);
  }

  std::string out_, part_;
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

}  // namespace

bool hasSlabsEnding(const std::string& path) {
  return fileEnding(path) == ".slabs";
}

std::string withoutSlash(std::string path) {
  const std::string ending = ".slabs/";
  while (path.size() > ending.size() &&
         path.compare(path.size() - ending.size(), ending.size(), ending) == 0)
    path.pop_back();
  return path;
}

void addSlabCosts(const SlabObject& object, const SlabSegmentation& s, Json& json) {
  json["slab_count"] = object.slabCount();
  json["exchanges"] = s.exchanges;
  for (const SlabStage& stage : s.stages)
    json["stages"].push_back(
        {{"name", stage.name}, {"seconds", stage.seconds}, {"message_bytes", stage.messageBytes}});
}

void writeSlab(const std::string& path, const SlabGrids& grids, size_t slab, size_t count,
               Progress* progress) {
  std::vector<openvdb::GridBase::ConstPtr> written;
  for (const Int32Grid::Ptr& grid : {grids.grain, grids.manifold}) {
    if (!grid) continue;
    markSlab(*grid, slab, count);
    written.push_back(grid);
  }
  writeVdb(path, written, progress);
}

Json slabIndex(const SegmentArguments& o, const SlabObject& object, const Json& summary) {
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
        key != "threads" && key != "stages" && key != "exchanges" && key != "ranks" &&
        key != "output" && key != "hints" && key != "input")
      index[key] = value;
  index["input"] = fs::path(o.input.path).filename().string();
  return index;
}

void checkSlabArguments(const SegmentArguments& o) {
  const bool isSlabs = hasSlabsEnding(o.out);
  if (!isSlabs && (o.slabHeight > 0 || !o.scratch.empty() || o.resume))
    throw WrongUsage("--slab-height, --scratch and --resume are for an output like OUT.slabs");
  if (!isSlabs) return;
  const SegmentOptions& keep = o.segment;
  if (keep.keepDistance || keep.keepPower || keep.keepBalls || !o.tables.empty() || o.dryRun)
    throw WrongUsage(o.out +
                     ": slabs get labels and --keep manifold alone: leave other grids, --tables "
                     "and --dry-run out");
}

void runInSlabs(const SegmentArguments& o, const Common& common) {
  const Clock::time_point start = Clock::now();
  SegmentTiming timing;
  JsonFile jsonFile(o.json);
  WorkPlace place(o);
  if (place.isDone()) {
    place.finish();
    common.progress->note(o.out + ": was whole already");
    return;
  }
  try {
    common.progress->start("read");
    const MaskGrid::Ptr about = readSlabs(o, common, place);
    timing.read = secondsSince(start);
    SegmentOptions options = o.segment;
    options.boundary = boundaryOf(o.boundary, o.input, *about);
    options.maxMemory = 0;
    const SlabObject object = storedSlabs(place.scratch(), about);
    place.checkSlabs(object.slabCount());

    common.progress->start("segment");
    const SlabSegmentation s = withFileName(o.input.path, [&] {
      return segmentSlabs(
          object, options, place.scratch(),
          [&](size_t slab, const SlabGrids& grids) {
            const Clock::time_point startWrite = Clock::now();
            writeSlab(place.file(slabFileName(slab)), grids, slab, object.slabCount(),
                      common.progress);
            timing.write += secondsSince(startWrite);
          },
          common.progress);
    });
    timing.total = secondsSince(start);
    common.progress->end();
    const SegmentSummary summary = summarize(o, common, s, *about, timing);
    Json json = toJson(o, summary);
    addSlabCosts(object, s, json);
    addNotes(json, *common.progress);
    JsonFile(place.file(kSlabIndex)).write(slabIndex(o, object, json));
    place.finish();
    jsonFile.write(json);
    if (common.quiet || jsonFile.isStandardOutput()) return;
    print(o, common, summary);
    std::printf("  slabs            %zu%s\n", object.slabCount(),
                o.fileOfSlabs.empty() ? ", each a .vdb; convert makes one of them" : "");
  } catch (const InvalidInput&) {  // it would be the same again
    common.progress->end();
    place.discard();
    throw;
  } catch (...) {
    common.progress->end();
    if (!hasSlabs(place.scratch()))
      place.discard();
    else
      common.progress->note(place.whatIsKept());
    throw;
  }
}

}  // namespace vdb_madf::tools
