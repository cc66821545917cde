// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/slab_folder.h"

#include <openvdb/Metadata.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/detail/output_place.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/grids/detail/region_metadata.h"
#include "vdb_madf/segmentation/graph_metadata.h"

namespace vdb_madf {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr char kSlab[] = "madf_slab";
constexpr char kSlabs[] = "madf_slabs";

template <typename Grid>
bool mergeAs(openvdb::GridBase& grid, openvdb::GridBase& next) {
  if (!grid.isType<Grid>() || !next.isType<Grid>()) return false;
  static_cast<Grid&>(grid).tree().merge(static_cast<Grid&>(next).tree());
  return true;
}

/// Is there an index that says that it is one? It is written last.
bool hasIndex(const std::string& folder) {
  std::error_code ignored;
  const std::string index = (fs::path(folder) / kSlabIndex).string();
  return fs::is_regular_file(index, ignored) &&
         detail::InputFile(index).head(100).find("\"vdb_madf slabs\"") != std::string::npos;
}

[[noreturn]] void refuseIndex(const std::string& path) {
  throw IoError(path + ": is damaged, so that it is unknown where the slabs are: make them again");
}

/// The list of slabs.
Json slabsOf(const std::string& index) {
  constexpr uint64_t kMostBytes = uint64_t(1) << 28;
  std::error_code ignored;
  if (!fs::exists(index, ignored))
    throw IoError(index + ": is missing, so this folder of slabs is not whole: make it again");
  const Json json = Json::parse(readText(index, kMostBytes), nullptr, false);
  if (!json.is_object() || !json.contains("slabs")) refuseIndex(index);
  const Json& slabs = json["slabs"];
  if (!slabs.is_array() || slabs.empty()) refuseIndex(index);
  for (const Json& slab : slabs)
    if (!slab.is_object()) refuseIndex(index);
  return slabs;
}

std::optional<int> numberOf(const Json& json, const char* key) {
  const Json value = json.value(key, Json());
  if (!value.is_number_integer()) return std::nullopt;
  const auto number = value.get<int64_t>();
  if (number < -kMaxCoordinate || number > kMaxCoordinate) return std::nullopt;
  return int(number);
}

/// What is the same in all slabs: not the parts of a graph.
std::map<std::string, std::string> ownMetadata(const openvdb::GridBase& grid) {
  std::map<std::string, std::string> texts;
  for (auto meta = grid.beginMeta(); meta != grid.endMeta(); ++meta)
    if (meta->first.rfind("madf_", 0) == 0 && meta->first != kSlab && meta->first != kSlabs &&
        meta->first != kGraphMetadata)
      texts[meta->first] = meta->second->typeName() + " " + meta->second->str();
  return texts;
}

/// The number of the process that put a folder out of its place follows.
constexpr char kReplaced[] = ".replaced-";

/// What a run that was killed has put out of the place of its output goes back there if that is empty, else
/// away.
void settleReplaced(const std::string& path) {
  const detail::OutputPlace place = detail::outputPlaceOf(path);
  const std::string stem = place.name + kReplaced;
  std::error_code error;
  std::vector<fs::path> left;
  for (const auto& entry : fs::directory_iterator(place.folder, error)) {
    const std::string name = entry.path().filename().string();
    const std::string number = name.substr(std::min(stem.size(), name.size()));
    if (name.compare(0, stem.size(), stem) == 0 && !number.empty() && number.size() < 10 &&
        number.find_first_not_of("0123456789") == std::string::npos &&
        detail::isGone(std::stoi(number)) && hasIndex(entry.path().string()))
      left.push_back(entry.path());
  }
  for (const fs::path& old : left)
    if (fs::exists(path, error))
      fs::remove_all(old, error);
    else
      fs::rename(old, path, error);
}

/// All slabs have the whole region of their domain beside them.
bool holdsRegion(const openvdb::GridBase& grid) {
  return grid.getName() == detail::kRegionGrid && grid.isType<BoolGrid>();
}

}  // namespace

std::string slabFileName(size_t slab) {
  char name[40];
  std::snprintf(name, sizeof name, "slab-%04zu.vdb", slab);
  return name;
}

void markSlab(openvdb::GridBase& grid, size_t slab, size_t count) {
  grid.insertMeta(kSlab, openvdb::Int64Metadata(int64_t(slab)));
  grid.insertMeta(kSlabs, openvdb::Int64Metadata(int64_t(count)));
}

bool isSlabFolder(const std::string& path) {
  std::error_code ignored;
  return hasIndex(path) || fs::is_regular_file(fs::path(path) / slabFileName(0), ignored);
}

SlabFolder openSlabFolder(const std::string& path) {
  const std::string index = (fs::path(path) / kSlabIndex).string();
  const Json slabs = slabsOf(index);
  SlabFolder folder;
  for (size_t s = 0; s < slabs.size(); ++s) {
    const auto first = numberOf(slabs[s], "z_first"), last = numberOf(slabs[s], "z_last");
    if (!first || !last || *first > *last || (s > 0 && *first != folder.cuts.back()) ||
        slabs[s].value("file", Json()) != slabFileName(s))
      refuseIndex(index);
    if (s == 0) folder.cuts.push_back(*first);
    folder.cuts.push_back(*last + 1);
    folder.files.push_back((fs::path(path) / slabFileName(s)).string());
  }
  for (const int cut : folder.cuts)
    if ((cut & 7) != 0) refuseIndex(index);
  std::error_code ignored;
  for (const std::string& file : folder.files)
    if (!fs::exists(file, ignored))
      throw IoError(file + ": is missing in a folder of " + std::to_string(folder.slabCount()) +
                    " slabs");
  return folder;
}

void checkSlabFolder(const std::string& path) {
  settleReplaced(path);
  std::error_code ignored;
  if (fs::exists(path, ignored) && !hasIndex(path))
    throw IoError("cannot write " + path +
                  ": it is there, and no folder of slabs; choose another name");
}

void commitSlabFolder(const std::string& made, const std::string& path) {
  checkSlabFolder(path);
  const auto rename = [](const std::string& from, const std::string& to) {
    std::error_code error;
    fs::rename(from, to, error);
    return error;
  };
  std::error_code ignored;
  const std::string old = path + kReplaced + std::to_string(::getpid());
  const bool replaces = fs::exists(path, ignored);
  if (replaces)
    if (const auto error = rename(path, old))
      throw IoError("cannot replace " + path + ": " + error.message() + "; the new one is " + made);
  if (const auto error = rename(made, path)) {
    if (replaces) rename(old, path);
    throw IoError("cannot write " + path + ": " + error.message() + "; it is complete in " + made);
  }
  if (replaces) fs::remove_all(old, ignored);
}

void checkSlab(const std::vector<openvdb::GridBase::Ptr>& grids, const SlabFolder& folder,
               size_t slab, const std::vector<openvdb::GridBase::Ptr>& lowest) {
  const std::string& path = folder.files[slab];
  bool fits = grids.size() == lowest.size();
  for (size_t i = 0; fits && i < grids.size(); ++i) {
    openvdb::GridBase& grid = *grids[i];
    if (holdsRegion(grid)) continue;
    const auto number = grid.getMetadata<openvdb::Int64Metadata>(kSlab),
               all = grid.getMetadata<openvdb::Int64Metadata>(kSlabs);
    if (!number || !all || number->value() != int64_t(slab) ||
        all->value() != int64_t(folder.slabCount()))
      throw IoError(path + ": is not slab " + std::to_string(slab + 1) + " of " +
                    std::to_string(folder.slabCount()) + ": it is of another folder");
    grid.removeMeta(kSlab);
    grid.removeMeta(kSlabs);
    const CoordBBox box = grid.evalActiveVoxelBoundingBox();
    if (!grid.empty() && !box.empty() &&
        (box.min().z() < folder.cuts[slab] || box.max().z() >= folder.cuts[slab + 1]))
      throw IoError(path + ": has voxels beyond its cuts in " + kSlabIndex +
                    ": it is of another folder");
    const openvdb::GridBase& first = *lowest[i];
    fits = grid.getName() == first.getName() && grid.type() == first.type() &&
           grid.transform() == first.transform() && ownMetadata(grid) == ownMetadata(first);
  }
  if (!fits)
    throw IoError(path + ": does not fit " + fs::path(folder.files[0]).filename().string() +
                  ": it is of another folder");
}

void addSlab(const std::vector<openvdb::GridBase::Ptr>& grids,
             const std::vector<openvdb::GridBase::Ptr>& next, const std::string& path) {
  for (size_t i = 0; i < grids.size(); ++i)
    if (!holdsRegion(*grids[i]) && !mergeAs<Int32Grid>(*grids[i], *next[i]) &&
        !mergeAs<BoolGrid>(*grids[i], *next[i]) && !mergeAs<MaskGrid>(*grids[i], *next[i]))
      throw IoError(path + ": slabs of grids of type " + next[i]->valueType() +
                    " cannot be put together");
}

}  // namespace vdb_madf
