// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/image_losses.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "vdb_madf/files/file_name.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/boundary.h"

namespace vdb_madf {

namespace {

/// Those that are not empty.
std::vector<std::string> presentOf(std::vector<std::string> losses) {
  losses.erase(std::remove(losses.begin(), losses.end(), ""), losses.end());
  return losses;
}

}  // namespace

std::string lostEdges(const std::string& path, bool areCubes,
                      const std::optional<VoxelSize>& size) {
  const std::string ending = fileEnding(path);
  if ((ending == ".mha" || ending == ".mhd") && size && size->isCube() && size->edge() == 1e-3)
    return path +
           ": voxels of 1 mm are read as of unknown size: give it again where it is read "
           "(--voxel-size)";
  if (areCubes || (size && ending != ".raw" && ending != ".npy")) return "";
  return path +
         ": does not say that its voxels are no cubes: give their edges again where it is read "
         "(--voxel-size)";
}

std::string lostRegion(const std::string& path, const openvdb::GridBase& grid) {
  const auto domain = storedDomain(grid);
  if (!domain || domain->isBox()) return "";
  return path +
         ": does not say where the region ends: outside of it there is 0, as in pores (a .vdb says "
         "it)";
}

std::string lostBoundary(const std::string& path, const openvdb::GridBase& grid) {
  if (storedBoundary(grid) != Boundary::closed) return "";
  return path +
         ": does not say that the boundary is closed: give that again where it is read "
         "(--boundary closed; a .vdb says it)";
}

std::string lostPlace(const std::string& path, const openvdb::GridBase& grid) {
  const std::string ending = fileEnding(path);
  for (const char* hasPlace : {".mha", ".mhd", ".nrrd", ".nhdr"})
    if (ending == hasPlace) return "";
  const auto domain = storedDomain(grid);
  const Coord first = domain ? domain->box().min() : Coord(0);
  if (first != Coord(0))
    return fmt::format(
        "{}: begins at voxel {},{},{} of the scan, and where it is read its first one is 0,0,0 (a "
        ".vdb keeps the place)",
        path, first.x(), first.y(), first.z());
  const openvdb::Vec3d center = grid.indexToWorld(first);
  const auto size = storedVoxelSize(grid);
  if (!size || center == openvdb::Vec3d(0)) return "";
  return fmt::format(
      "{}: the center of its first voxel is at {:.6g},{:.6g},{:.6g} {}, and where it is read at 0 "
      "(a .vdb keeps the place)",
      path, center[0], center[1], center[2], size->unit());
}

std::vector<std::string> zarrLossesOf(const std::string& path, const openvdb::GridBase& labels) {
  std::vector<std::string> losses{lostRegion(path, labels), lostBoundary(path, labels)};
  if (!hasCubicVoxels(labels) && !storedVoxelSize(labels))
    losses.push_back(path +
                     ": its voxels are no cubes, and of unknown size, so that it is not read as a "
                     "volume again: give their edges (--voxel-size)");
  if (const CoordBBox box = boxOf(labels); !box.empty() && box.min() != Coord(0))
    losses.push_back(fmt::format(
        "{}: begins at voxel {},{},{} of the scan, and boxes of grains among its measures count "
        "from the voxel 0,0,0 of that",
        path, box.min().x(), box.min().y(), box.min().z()));
  return presentOf(std::move(losses));
}

std::vector<std::string> lossesOf(const std::string& path, const openvdb::GridBase& grid) {
  return presentOf({lostEdges(path, hasCubicVoxels(grid), storedVoxelSize(grid)),
                    lostRegion(path, grid), lostBoundary(path, grid), lostPlace(path, grid)});
}

}  // namespace vdb_madf
