// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/slab_folder.h"

#include <openvdb/Metadata.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/input_file.h"

namespace vdb_madf {

namespace {

namespace fs = std::filesystem;

constexpr char kSlab[] = "madf_slab";
constexpr char kSlabs[] = "madf_slabs";

template <typename Grid>
bool mergeAs(openvdb::GridBase& grid, openvdb::GridBase& next) {
  if (!grid.isType<Grid>() || !next.isType<Grid>()) return false;
  static_cast<Grid&>(grid).tree().merge(static_cast<Grid&>(next).tree());
  return true;
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
  const std::string index = (fs::path(path) / kSlabIndex).string();
  return fs::is_regular_file(index, ignored) &&
         detail::InputFile(index).head(100).find("\"vdb_madf slabs\"") != std::string::npos;
}

std::vector<std::string> slabFiles(const std::string& path) {
  size_t count = 0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    const std::string name = entry.path().filename().string();
    count += name.rfind("slab-", 0) == 0 && entry.path().extension() == ".vdb";
  }
  if (error) throw IoError(path + ": " + error.message());
  if (count == 0) throw IoError(path + ": its slabs, " + slabFileName(0) + " and on, are missing");
  std::vector<std::string> files;
  for (size_t slab = 0; slab < count; ++slab) {
    files.push_back((fs::path(path) / slabFileName(slab)).string());
    if (!fs::exists(files.back(), error))
      throw IoError(files.back() + ": is missing in a folder of " + std::to_string(count) +
                    " slabs");
  }
  return files;
}

void checkSlabFolder(const std::string& path) {
  std::error_code ignored;
  if (fs::exists(path, ignored) && !isSlabFolder(path))
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
  const std::string old = path + ".replaced-" + std::to_string(::getpid());
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

void unmarkSlab(const std::vector<openvdb::GridBase::Ptr>& grids, size_t slab, size_t count,
                const std::string& path) {
  for (const auto& grid : grids) {
    const auto number = grid->getMetadata<openvdb::Int64Metadata>(kSlab),
               all = grid->getMetadata<openvdb::Int64Metadata>(kSlabs);
    if (!number || !all || number->value() != int64_t(slab) || all->value() != int64_t(count))
      throw IoError(path + ": is not slab " + std::to_string(slab + 1) + " of " +
                    std::to_string(count) + ": files are missing in its folder, or of another");
    grid->removeMeta(kSlab);
    grid->removeMeta(kSlabs);
  }
}

void addSlab(std::vector<openvdb::GridBase::Ptr>& grids,
             const std::vector<openvdb::GridBase::Ptr>& next, const std::string& path) {
  if (grids.empty()) {
    grids = next;
    return;
  }
  bool fits = grids.size() == next.size();
  for (size_t i = 0; fits && i < grids.size(); ++i)
    fits = grids[i]->getName() == next[i]->getName() &&
           grids[i]->transform() == next[i]->transform() && mergeAs<Int32Grid>(*grids[i], *next[i]);
  if (!fits) throw IoError(path + ": does not fit the slabs below it");
}

}  // namespace vdb_madf
