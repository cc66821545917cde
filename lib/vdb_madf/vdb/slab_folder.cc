// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/slab_folder.h"

#include <fmt/core.h>
#include <openvdb/Metadata.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/files/detail/content_digest.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/detail/json_depth.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/grids/detail/region_metadata.h"
#include "vdb_madf/segmentation/graph_metadata.h"

namespace vdb_madf {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

template <typename Grid>
bool mergeAs(openvdb::GridBase& grid, openvdb::GridBase& next) {
  if (!grid.isType<Grid>() || !next.isType<Grid>()) return false;
  static_cast<Grid&>(grid).tree().merge(static_cast<Grid&>(next).tree());
  return true;
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
  Json json = Json::parse(
      readText(index, kMostBytes),
      [&](int depth, Json::parse_event_t, Json&) {
        if (depth > detail::kMaxJsonDepth) refuseIndex(index);
        return true;
      },
      false);
  if (!json.is_object() || !json.contains("slabs")) refuseIndex(index);
  const Json digest = json.value(detail::kDigestKey, Json(""));
  if (!digest.is_string()) refuseIndex(index);
  json.erase(detail::kDigestKey);
  detail::requireDigest(index, digest.get<std::string>(), detail::digestOf(json.dump()));
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
    if (meta->first.rfind("madf_", 0) == 0 && meta->first != kSlabKey && meta->first != kSlabsKey &&
        meta->first != kGraphMetadata)
      texts[meta->first] = meta->second->typeName() + " " + meta->second->str();
  return texts;
}

/// All slabs have the whole region of their domain beside them.
bool holdsRegion(const openvdb::GridBase& grid) {
  return grid.getName() == detail::kRegionGrid && grid.isType<BoolGrid>();
}

}  // namespace

std::string slabFileName(size_t slab) {
  return fmt::format("slab-{:04}.vdb", slab);
}

bool hasSlabIndex(const std::string& folder) {
  std::error_code ignored;
  const std::string index = (fs::path(folder) / kSlabIndex).string();
  return fs::is_regular_file(index, ignored) &&
         detail::InputFile(index).head(100).find("\"vdb_madf slabs\"") != std::string::npos;
}

bool isSlabFolder(const std::string& path) {
  std::error_code ignored;
  return hasSlabIndex(path) || fs::is_regular_file(fs::path(path) / slabFileName(0), ignored);
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
      throw IoError(
          fmt::format("{}: is missing in a folder of {} slabs", file, folder.slabCount()));
  return folder;
}

void checkSlab(const std::vector<openvdb::GridBase::Ptr>& grids, const SlabFolder& folder,
               size_t slab, const std::vector<openvdb::GridBase::Ptr>& lowest) {
  const std::string& path = folder.files[slab];
  bool fits = grids.size() == lowest.size();
  for (size_t i = 0; fits && i < grids.size(); ++i) {
    openvdb::GridBase& grid = *grids[i];
    if (holdsRegion(grid)) continue;
    const auto number = grid.getMetadata<openvdb::Int64Metadata>(kSlabKey),
               all = grid.getMetadata<openvdb::Int64Metadata>(kSlabsKey);
    if (!number || !all || number->value() != int64_t(slab) ||
        all->value() != int64_t(folder.slabCount()))
      throw IoError(fmt::format("{}: is not slab {} of {}: it is of another folder", path, slab + 1,
                                folder.slabCount()));
    grid.removeMeta(kSlabKey);
    grid.removeMeta(kSlabsKey);
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
