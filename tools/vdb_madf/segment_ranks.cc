// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "segment_ranks.h"

#include <cstdio>
#include <filesystem>
#include <utility>

#include "segment_slabs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/cavities.h"
#include "vdb_madf/slabs/deal_slabs.h"
#include "vdb_madf/vdb/slab_folder.h"

namespace vdb_madf::tools {

namespace {

namespace fs = std::filesystem;

/// OUT.slabs.part, which all ranks see. It is made by rank 0, and removed by whoever fails.
class SharedPart {
 public:
  SharedPart(const std::string& out, Ranks& ranks) : out_(out), part_(out + ".part") {
    if (ranks.rank() != 0) return;
    checkSlabFolder(out_);
    std::error_code error;
    if (!fs::create_directory(part_, error))
      throw IoError("cannot make " + part_ + ": " +
                    (error ? error.message() : "it is there already; remove it"));
    isMine_ = true;
  }
  ~SharedPart() {
    std::error_code ignored;
    if (isMine_) fs::remove_all(part_, ignored);
  }
  SharedPart(const SharedPart&) = delete;
  SharedPart& operator=(const SharedPart&) = delete;

  /// From now on whoever fails removes it.
  void share() { isMine_ = true; }
  std::string file(const std::string& name) const { return (fs::path(part_) / name).string(); }
  void commit() { commitSlabFolder(part_, out_); }
  void leave() { isMine_ = false; }

 private:
  std::string out_, part_;
  bool isMine_ = false;
};

/// Voxels of the object in a slab at most: a rank works on one of its slabs at a time.
constexpr int64_t kSlabVoxels = int64_t(1) << 28;

SlabObject readShare(const SegmentArguments& o, const Common& common, Scratch& scratch) {
  Ranks& ranks = *common.ranks;
  std::vector<LeafIndex::LeafVoxels> leaves;
  VolumeOptions volume = o.input.volume(common.progress);
  volume.share = {ranks.rank(), ranks.count()};
  volume.takeLayer = [&](const MaskTree& layer) { addLeaves(layer, leaves); };
  const MaskGrid::Ptr about = loadObject(o.input, volume, common.progress);
  const auto domain = storedDomain(*about);
  SlabLimits limits;
  limits.voxels = kSlabVoxels;
  limits.height = o.slabHeight;
  limits.leastHeight = o.segment.tidy;
  return dealSlabs(std::move(leaves), limits,
                   o.segment.fillHoles.value_or(defaultFillHoles(domain)), domain, about, ranks,
                   scratch);
}

}  // namespace

void checkRankArguments(const SegmentArguments& o) {
  if (!hasSlabsEnding(o.out))
    throw WrongUsage("vdb_madf_mpi writes a folder of slabs: choose an output like OUT.slabs");
  if (!o.scratch.empty() || o.resume || !o.maxMemory.empty())
    throw WrongUsage(
        "vdb_madf_mpi keeps all slabs in the memory of its processes: leave --scratch, --resume "
        "and "
        "--max-memory out");
}

void runInRanks(const SegmentArguments& o, const Common& common) {
  const Clock::time_point start = Clock::now();
  Ranks& ranks = *common.ranks;
  const bool isRoot = ranks.rank() == 0;
  SegmentTiming timing;
  std::optional<JsonFile> jsonFile;
  if (isRoot) jsonFile.emplace(o.json);
  SharedPart part(o.out, ranks);
  MemoryScratch scratch;
  ranks.exchange(scratch);  // the folder is there
  part.share();

  common.progress->start("read");
  const SlabObject object = readShare(o, common, scratch);
  timing.read = secondsSince(start);
  SegmentOptions options = o.segment;
  options.boundary = boundaryOf(o.boundary, o.input, *object.about);
  options.maxMemory = 0;

  common.progress->start("segment");
  const SlabSegmentation s = withFileName(o.input.path, [&] {
    return segmentSlabs(
        object, options, scratch, ranks,
        [&](size_t slab, const SlabGrids& grids) {
          writeSlab(part.file(slabFileName(slab)), grids, slab, object.slabCount(),
                    common.progress);
        },
        common.progress);
  });
  common.progress->end();
  if (isRoot) {
    timing.total = secondsSince(start);
    const SegmentSummary summary = summarize(o, common, s, *object.about, timing);
    Json json = toJson(o, summary);
    addSlabCosts(object, s, json);
    json["ranks"] = ranks.count();
    addNotes(json, *common.progress);
    JsonFile(part.file(kSlabIndex)).write(slabIndex(o, object, json));
    part.commit();
    jsonFile->write(json);
    if (!common.quiet && !jsonFile->isStandardOutput()) {
      print(o, common, summary);
      std::printf("  slabs            %zu, by %d processes\n", object.slabCount(), ranks.count());
    }
  }
  part.leave();
}

}  // namespace vdb_madf::tools
