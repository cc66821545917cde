// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/slab_folder_writer.h"

#include <fmt/core.h>
#include <openvdb/Metadata.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/files/detail/content_digest.h"
#include "vdb_madf/files/detail/output_place.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf {

namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

/// The number of the process that put a folder out of its place follows.
constexpr char kReplaced[] = ".replaced-";

/// Puts what a killed run has moved out of the place of its output back there if that is empty,
/// else away.
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
        detail::isGone(std::stoi(number)) && hasSlabIndex(entry.path().string()))
      left.push_back(entry.path());
  }
  for (const fs::path& old : left)
    if (fs::exists(path, error))
      fs::remove_all(old, error);
    else
      fs::rename(old, path, error);
}

/// False of a file that somebody put among the slabs (not of hidden ones: no one would miss them).
bool isOfSlabs(const std::string& name) {
  return name == kSlabIndex || name[0] == '.' ||
         (name.compare(0, 5, "slab-") == 0 && fs::path(name).extension() == ".vdb");
}

}  // namespace

SlabFolderWriter::SlabFolderWriter(const std::string& path, std::vector<int> cuts)
    : path_(path), part_(path + ".part"), cuts_(std::move(cuts)) {
  bool isCut = cuts_.size() > 1;
  for (size_t i = 0; i < cuts_.size(); ++i)
    isCut = isCut && cuts_[i] % 8 == 0 && (i == 0 || cuts_[i - 1] < cuts_[i]);
  if (!isCut) throw InvalidInput(path + ": slabs are cut at multiples of 8, in ascending order");
  checkSlabFolder(path_);
  std::error_code error;
  if (!fs::create_directory(part_, error))
    throw IoError(fmt::format("cannot make {}: {}", part_,
                              error ? error.message() + "; make its folder first"
                                    : "it is there; remove it, or choose another name"));
}

SlabFolderWriter::~SlabFolderWriter() {
  std::error_code ignored;
  fs::remove_all(part_, ignored);
}

std::string SlabFolderWriter::file(const std::string& name) const {
  return (fs::path(part_) / name).string();
}

void SlabFolderWriter::write(size_t slab, const std::vector<openvdb::GridBase::ConstPtr>& grids,
                             Interrupter* interrupter) const {
  writeSlab(part_, slab, slabCount(), grids, interrupter);
}

void SlabFolderWriter::commit(const std::string& about) const {
  writeSlabIndex(part_, cuts_, about);
  commitSlabFolder(part_, path_);
}

void writeSlab(const std::string& folder, size_t slab, size_t count,
               const std::vector<openvdb::GridBase::ConstPtr>& grids, Interrupter* interrupter) {
  std::vector<openvdb::GridBase::ConstPtr> marked;
  for (const auto& grid : grids) {
    openvdb::MetaMap metadata(*grid);
    metadata.insertMeta(kSlabKey, openvdb::Int64Metadata(int64_t(slab)));
    metadata.insertMeta(kSlabsKey, openvdb::Int64Metadata(int64_t(count)));
    marked.push_back(grid->copyGridReplacingMetadata(metadata));
  }
  writeVdb((fs::path(folder) / slabFileName(slab)).string(), marked, interrupter);
}

void writeSlabIndex(const std::string& folder, const std::vector<int>& cuts,
                    const std::string& about) {
  const OrderedJson more = OrderedJson::parse(about, nullptr, false);
  if (!more.is_object()) throw InvalidInput("what is said of slabs must be a JSON object");
  OrderedJson index{{"format", "vdb_madf slabs"}, {"format_version", 1}, {"version", kVersion}};
  index["slabs"] = OrderedJson::array();
  for (size_t s = 0; s + 1 < cuts.size(); ++s)
    index["slabs"].push_back(
        {{"file", slabFileName(s)}, {"z_first", cuts[s]}, {"z_last", cuts[s + 1] - 1}});
  index.insert(more.begin(), more.end());  // where a name is taken, nothing changes
  index.erase(detail::kDigestKey);
  // Of members in the order of their names.
  index[detail::kDigestKey] = detail::digestOf(nlohmann::json(index).dump());
  detail::OutputStream file((fs::path(folder) / kSlabIndex).string());
  file.text(index.dump(2) + "\n");
  file.commit();
}

void checkSlabFolder(const std::string& path) {
  std::error_code ignored;
  if (fs::is_symlink(path, ignored))
    throw IoError("cannot write " + path + ": it is a link; give the path that it leads to");
  settleReplaced(path);
  if (!fs::exists(path, ignored)) return;
  if (!hasSlabIndex(path))
    throw IoError("cannot write " + path +
                  ": it is there, and no folder of slabs; choose another name");
  for (const auto& entry : fs::directory_iterator(path, ignored))
    if (const std::string name = entry.path().filename().string(); !isOfSlabs(name))
      throw IoError("cannot replace " + path + ": it holds " + name +
                    ", too; move that away, or choose another name");
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
      throw IoError(
          fmt::format("cannot replace {}: {}; the new one is {}", path, error.message(), made));
  if (const auto error = rename(made, path)) {
    if (replaces) rename(old, path);
    throw IoError(
        fmt::format("cannot write {}: {}; it is complete in {}", path, error.message(), made));
  }
  if (replaces) fs::remove_all(old, ignored);
}

}  // namespace vdb_madf
