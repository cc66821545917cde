// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "work_place.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>
#include <vector>

#include "member_failure.h"
#include "outputs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/slabs/slab_builder.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "vdb_madf/vdb/slab_folder_writer.h"

namespace vdb_madf::tools {

namespace {

namespace fs = std::filesystem;

using NamedText = std::pair<const char*, std::string>;

/// What was typed, mostly of how IN is read, of which the summary of a segmentation says nothing
/// else; of boundary and cavities it says what became of them.
std::vector<NamedText> readingOptions(const SegmentArguments& o) {
  const InputOptions& in = o.input;
  return {{"dataset", in.dataset},
          {"dims", in.dims},
          {"type", in.type},
          {"skip", in.skip},
          {"big_endian", in.bigEndian ? "yes" : ""},
          {"median", in.median},
          {"smooth", in.smooth},
          {"despeckle", in.despeckle},
          {"voxel_size", in.voxelSizeText},
          {"domain", in.domainText},
          {"roi", in.roi},
          {"crop", in.cropText},
          {"boundary", o.boundary == "auto" ? "" : o.boundary},
          {"fill_holes", o.fillHoles}};
}

/// What was typed that the summary says, too.
std::vector<NamedText> choiceOptions(const SegmentArguments& o) {
  const InputOptions& in = o.input;
  return {{"grid", in.gridName},
          {"phase", in.phase},
          {"threshold", in.threshold},
          {"range", in.range},
          {"keep", o.keep}};
}

/// What tells, without reading it, whether an input is as it was.
struct Stamp {
  uintmax_t bytes = 0;
  fs::file_time_type changed = fs::file_time_type::min();  ///< when the last of its files was

  std::string text() const {
    return fmt::format("{} {}", bytes, changed.time_since_epoch().count());
  }
};

/// The files that a volume is read from: those that a header names, too. The path alone, if it
/// cannot be opened.
std::vector<std::string> sourcesOf(const std::string& path, VolumeOptions options) {
  options.note = nullptr;
  std::error_code error;
  if (!fs::is_regular_file(path, error) || hasVdbEnding(path)) return {path};
  try {
    return openVolumeImage(path, options)->files();
  } catch (const HintedError&) {  // IoError or InvalidInput
    return {path};
  }
}

/// Of these files and of all that lies in those that are folders.
Stamp stampOf(const std::vector<std::string>& sources) {
  Stamp stamp;
  const auto add = [&](const fs::path& file) {
    std::error_code error;
    if (const auto size = fs::file_size(file, error); !error) stamp.bytes += size;
    if (const auto time = fs::last_write_time(file, error); !error)
      stamp.changed = std::max(stamp.changed, time);
  };
  for (const std::string& path : std::set(sources.begin(), sources.end())) {
    std::error_code error;
    if (!fs::is_directory(path, error)) add(path);
    fs::recursive_directory_iterator entry(path, error);
    for (; entry != fs::recursive_directory_iterator(); entry.increment(error))
      if (entry->is_regular_file(error)) add(entry->path());
  }
  return stamp;
}

Stamp stampOf(const InputOptions& in) {
  return stampOf(sourcesOf(in.path, in.volume(nullptr)));
}

Stamp stampOf(const RegionOptions& region) {
  return stampOf(sourcesOf(region.mask, {}));
}

Json originOf(const SegmentArguments& o, const Stamp& input) {
  Json origin{{"input", lastPart(o.input.path)}, {"input_bytes", input.bytes}};
  for (const auto& [name, text] : readingOptions(o))
    if (!text.empty()) origin["reading"][name] = text;
  return origin;
}

/// The options that slabs depend on. --max-memory only says where to cut, which is done once.
std::string choicesOf(const SegmentArguments& o) {
  std::string work = kVersion;
  for (const auto& option : readingOptions(o)) work += "\n" + option.second;
  for (const auto& option : choiceOptions(o)) work += "\n" + option.second;
  for (const std::string& text :
       {o.gamma, o.tidy, o.merge.strictness, o.merge.mode, o.merge.theta, o.merge.delta,
        o.merge.adjacency, o.merge.minGrain, std::to_string(o.slabHeight)})
    work += "\n" + text;
  for (const bool flag : {o.input.invert, o.paper}) work += flag ? "\nyes" : "\nno";
  return work;
}

/// What the slabs in scratch depend on.
std::string workOf(const SegmentArguments& o) {
  const std::string& in = o.input.path;
  std::error_code ignored;
  return fmt::format("{}\n{} {} {}\n{}", fs::absolute(o.out, ignored).string(),
                     fs::absolute(in, ignored).string(), stampOf(o.input).text(),
                     stampOf(o.input.region).text(), choicesOf(o));
}

/// True if an index says of the labels what they would be of these arguments.
bool isOf(const Json& index, const SegmentArguments& o, const Stamp& input) {
  Json wanted = originOf(o, input);
  wanted["version"] = kVersion;
  wanted["gamma"] = o.segment.gamma;
  wanted["tidy"] = o.segment.tidy;
  addMerging(wanted, o.segment.merge);
  for (const auto& [key, value] : wanted.items())
    if (!index.contains(key) || index.at(key) != value) return false;
  for (const auto& [key, text] : choiceOptions(o))
    if (index.value(key, "") != text) return false;
  return index.value("invert", false) == o.input.invert &&
         index.value("min_grain", int64_t(0)) == int64_t(o.segment.merge.minGrain) &&
         index.contains("reading") == wanted.contains("reading");
}

std::string scratchOf(const SegmentArguments& o) {
  return o.scratch.empty() ? o.out + ".scratch" : o.scratch;
}

constexpr char kWhole[] = "done";  // the piece that says that OUT.slabs.part is whole

/// Whether a file in OUT.slabs.part may be of a run, by its name; temporary ones begin with a dot.
bool isOfRun(std::string name) {
  if (name[0] == '.') name.erase(0, 1);
  return name.compare(0, 5, "slab-") == 0 ||
         name.compare(0, sizeof kSlabIndex - 1, kSlabIndex) == 0;
}

}  // namespace

Json originOf(const SegmentArguments& o) {
  return originOf(o, stampOf(o.input));
}

void checkAlike(const SegmentArguments& o, Team& team) {
  if (team.count() == 1) return;
  const std::string own = fmt::format("{}\n{}\n{}", choicesOf(o), stampOf(o.input).bytes,
                                      stampOf(o.input.region).bytes);
  Bytes first(own.begin(), own.end());
  team.broadcast(first);
  inAllMembers(team, [&] {
    if (!std::equal(first.begin(), first.end(), own.begin(), own.end()))
      throw InvalidInput(o.input.path +
                         ": is of another size, or has other options, for another process of the "
                         "job: give all the same");
  });
}

bool isFinished(const SegmentArguments& o) {
  std::error_code ignored;
  if (!hasSlabIndex(o.out) || fs::exists(o.out + ".part", ignored) ||
      fs::exists(scratchOf(o), ignored))
    return false;
  openSlabFolder(o.out);
  const std::string path = (fs::path(o.out) / kSlabIndex).string();
  std::ifstream file(path);
  const Json index = Json::parse(file, nullptr, false);
  const Stamp input = stampOf(o.input);
  const auto read = std::max(input.changed, stampOf(o.input.region).changed);
  if (!isOf(index, o, input) || read > fs::last_write_time(path, ignored))
    throw InvalidInput(o.out +
                       ": is finished, and was made of another input or with other options: leave "
                       "--resume out to make it anew");
  return true;
}

WorkPlace::WorkPlace(const SegmentArguments& o, const Common& common, Team& team)
    : team_(team), progress_(common.progress), out_(o.out), part_(o.out + ".part") {
  const bool inMemory = common.team && o.scratch.empty() && !o.resume && o.maxMemory.empty();
  const bool isRoot = team.member() == 0;
  inAllMembers(team, [&] {
    if (!isRoot) return;
    checkSlabFolder(out_);
    if (inMemory)
      makePart(false);  // nothing else keeps two runs apart
    else
      makeFolders(o);
  });
  if (inMemory) return;
  try {
    inAllMembers(team, [&] {
      if (!isRoot) folder_ = std::make_unique<FolderScratch>(scratchOf(o));
      isDone_ = folder_->has(kWhole);
    });
  } catch (...) {
    if (isRoot) abandon(false);
    throw;
  }
}

/// @param mayBeThere whether what a run left, or nothing, may be in it
/// @return whether it was not there
bool WorkPlace::makePart(bool mayBeThere) {
  std::error_code error;
  const bool isNew = fs::create_directory(part_, error);
  if (error)
    throw IoError("cannot make " + part_ + ": " + error.message() +
                  "; make its folder first, or remove what is there");
  if (isNew) return true;
  for (const auto& entry : fs::directory_iterator(part_, error))
    if (!isOfRun(entry.path().filename().string()))
      throw IoError(part_ + ": holds " + entry.path().filename().string() +
                    ", which is of no run in slabs: move it away");
  if (!mayBeThere)
    throw IoError(
        part_ +
        ": is that of another run, or what one left that did not end: remove it when none "
        "works there");
  return false;
}

void WorkPlace::makeFolders(const SegmentArguments& o) {
  const std::string scratch = scratchOf(o);
  if (isWithin(out_, scratch) || isWithin(scratch, out_) || isWithin(scratch, part_))
    throw IoError(
        fmt::format("scratch data cannot be in {}, for {}: choose another folder", scratch, out_));
  std::error_code ignored;
  const bool isNew = makePart(true);
  if (!isNew && !o.resume && !fs::is_empty(part_, ignored))
    throw IoError(part_ +
                  ": is what a run left that did not end: give --resume to go on, or remove it");
  try {
    folder_ = std::make_unique<FolderScratch>(scratch, workOf(o), o.resume);
    if (team_.count() > 1) folder_->share();
  } catch (...) {
    if (isNew) fs::remove(part_, ignored);
    throw;
  }
  clearPart(holdsSlabs());
}

bool WorkPlace::holdsSlabs() const {
  return folder_ && hasSlabs(*folder_);
}

std::string WorkPlace::file(const std::string& name) const {
  return (fs::path(part_) / name).string();
}

void WorkPlace::checkSlabs(size_t count) const {
  std::error_code ignored;
  for (size_t s = 0; folder_ && s < count; ++s)
    if (isSlabPut(*folder_, s) && !fs::exists(file(slabFileName(s)), ignored))
      throw IoError(fmt::format("{}: is missing; remove {} and {}, and begin anew",
                                file(slabFileName(s)), part_, folder_->path()));
}

void WorkPlace::finish() {
  if (team_.member() != 0) return;
  std::error_code ignored;
  if (folder_) folder_->write(kWhole, {});
  if (fs::exists(file(kSlabIndex), ignored)) commitSlabFolder(part_, out_);
  fs::remove(part_, ignored);  // of a run that was killed in what follows
  if (folder_) folder_->removeAll();
}

void WorkPlace::abandon(bool isHopeless) {
  // The others may still be at work, and need the folders until member 0 ends them.
  if (!folder_ || (team_.member() == 0 && (isHopeless || !holdsSlabs())))
    discard();
  else
    progress_->note(fmt::format(
        "what was done so far is kept in {} and {}: give --resume to go on, or remove both", part_,
        folder_->path()));
}

void WorkPlace::discard() {
  std::error_code ignored;
  clearPart(false);
  fs::remove(part_, ignored);
  if (folder_) folder_->removeAll();
}

/// @param butSlabs leave those that are whole
void WorkPlace::clearPart(bool butSlabs) {
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(part_, error))
    if (!butSlabs || entry.path().filename().string()[0] == '.') files.push_back(entry.path());
  for (const fs::path& path : files) fs::remove(path, error);
}

}  // namespace vdb_madf::tools
