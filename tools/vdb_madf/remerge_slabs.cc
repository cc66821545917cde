// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "remerge_slabs.h"

#include <filesystem>
#include <iostream>
#include <optional>
#include <utility>

#include "json_file.h"
#include "segment_summary.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/measure/grain_sizes.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"
#include "vdb_madf/slabs/remerge_slabs.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "vdb_madf/vdb/slab_folder_writer.h"

namespace vdb_madf::tools {

namespace {

/// What index.json of a folder says, brought up to date. openSlabFolder() has read it before.
Json newIndex(const std::string& folder, const MergeOptions& merge, int tidy,
              const std::vector<int64_t>& grainVoxels) {
  constexpr uint64_t kMostBytes = uint64_t(1) << 28;
  const Json before =
      Json::parse(readText((std::filesystem::path(folder) / kSlabIndex).string(), kMostBytes));
  Json index = Json::object();
  for (const auto& [key, value] : before.items())
    if (key == "merge")
      addMerging(index, merge);
    else if (key != "strictness" && key != "theta" && key != "delta" && key != "adjacency" &&
             key != "min_grain")
      index[key] = value;
  const GrainSizes sizes = grainSizes(grainVoxels);
  index["grains"] = grainVoxels.size();
  index["grains_under_100_voxels"] = sizes.dustGrains;
  index["voxels_in_grains_under_100_voxels"] = sizes.dustVoxels;
  index["grain_diameter_d10_voxels"] = sizes.d10;
  index["grain_diameter_d50_voxels"] = sizes.d50;
  index["grain_diameter_d90_voxels"] = sizes.d90;
  index["tidy"] = tidy;
  return index;
}

}  // namespace

VdbReadOptions manifoldsAlone() {
  VdbReadOptions reading;
  reading.wanted = [](const openvdb::GridBase& grid) { return grid.getName() == kManifoldGrid; };
  reading.anyVoxelShape = true;
  return reading;
}

Int32Grid::Ptr manifoldsAmong(const std::vector<openvdb::GridBase::Ptr>& grids) {
  for (const auto& grid : grids)
    if (grid->getName() == kManifoldGrid && grid->isType<Int32Grid>())
      return openvdb::gridPtrCast<Int32Grid>(grid);
  return nullptr;
}

Int32Grid::Ptr requiredManifolds(const std::vector<openvdb::GridBase::Ptr>& grids,
                                 const std::string& path) {
  const Int32Grid::Ptr manifolds = manifoldsAmong(grids);
  if (!manifolds)
    throw InvalidInput(path + ": holds no manifolds: segment again with --keep manifold");
  return manifolds;
}

namespace {

constexpr char kWork[] = "merging of manifolds";  // in scratch

const std::string& withoutLeftovers(const std::string& path) {
  FolderScratch(path, kWork, true).removeAll();
  return path;
}

}  // namespace

ScratchFolder::ScratchFolder(const std::string& path)
    : scratch_(withoutLeftovers(path), kWork, false) {
  scratch_.serveThisRun();
}

ScratchFolder::~ScratchFolder() {
  scratch_.removeAll();
}

LabelSlabs openManifoldSlabs(const InputOptions& input, Progress* progress) {
  requiredManifolds(readVdbHeaders(input.path, progress), input.path);
  InputOptions manifolds = input;
  manifolds.gridName = kManifoldGrid;
  return openLabelSlabs(manifolds, "--grid", progress);
}

ManifoldGraph keptGraph(const InputOptions& input, Progress* progress) {
  if (isInSlabs(input))
    return storedGraph(openManifoldSlabs(input, progress), progress).value_or(ManifoldGraph());
  const Int32Grid::Ptr header =
      requiredManifolds(readVdbHeaders(input.path, progress, /*verified=*/true), input.path);
  if (regionName(*header).empty()) return requiredGraph(*header);
  // A region is voxels, which decide what reaches out of the domain.
  return requiredGraph(
      *requiredManifolds(readVdb(input.path, manifoldsAlone(), progress), input.path));
}

void remergeInSlabs(const InputOptions& input, const std::string& out, const MergeOptions& merge,
                    int tidy, const Common& common) {
  common.progress->start("read");
  const LabelSlabs manifolds = openManifoldSlabs(input, common.progress);
  const SlabFolderWriter folder(out, manifolds.cuts);
  std::optional<ScratchFolder> scratch(std::in_place, folder.file("scratch"));
  const std::vector<int64_t> voxels = withFileName(input.path, [&] {
    return remergeSlabs(
        manifolds, merge, tidy, scratch->scratch(),
        [&](size_t slab, const Int32Grid::Ptr& grain) {
          const Int32Grid::Ptr manifold = manifolds.read(slab, common.progress);
          describeMerging(*manifold, merge, tidy, *grainCount(*grain));
          folder.write(slab, {grain, manifold}, common.progress);
        },
        common.progress);
  });
  scratch.reset();
  folder.commit(newIndex(input.path, merge, tidy, voxels).dump());
  common.progress->end();
  if (!common.quiet)
    std::cout << out << ": " << counted(int64_t(voxels.size()), "grain") << " in "
              << counted(int64_t(manifolds.slabCount()), "slab") << "\n";
}

}  // namespace vdb_madf::tools
