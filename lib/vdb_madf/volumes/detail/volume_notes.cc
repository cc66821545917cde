// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/detail/volume_notes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

#include "vdb_madf/base/counted.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/method/boundary.h"

namespace vdb_madf::detail {

namespace {

/// "2.5 times as long"; empty if they differ by no more than 1 %.
std::string difference(const VoxelSize& given, const VoxelSize& ofFile) {
  constexpr double kTolerance = 1.01;
  double ratio = 1, factor = 1;
  for (size_t axis = 0; axis < 3; ++axis) {
    const double here = given.edges()[axis] / ofFile.edges()[axis];
    if (std::max(here, 1 / here) <= factor) continue;
    ratio = here;
    factor = std::max(here, 1 / here);
  }
  if (factor <= kTolerance) return "";
  if (!given.isCube() || !ofFile.isCube()) return "which differs";
  return generalDecimal(factor, 4) + " times as " + (ratio > 1 ? "long" : "short");
}

}  // namespace

bool haveOtherEdges(const VoxelSize& a, const VoxelSize& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const double p = a.edges()[axis], q = b.edges()[axis];
    if (std::max(p, q) > std::min(p, q) * kMaxEdgeRatio) return true;
  }
  return false;
}

std::string voxelText(const VoxelSize& size) {
  const double longest = *std::max_element(size.edges().begin(), size.edges().end());
  const auto [unit, perMeter] = longest < 1e-6   ? std::pair("nm", 1e9)
                                : longest < 1e-3 ? std::pair("um", 1e6)
                                                 : std::pair("mm", 1e3);
  std::string text;
  for (size_t axis = 0; axis < (size.isCube() ? 1 : 3); ++axis) {
    if (axis > 0) text += " x ";
    text += generalDecimal(size.edges()[axis] * perMeter, 4);
  }
  return text + " " + unit;
}

void noteVoxelSize(const std::string& path, const std::optional<VoxelSize>& ofFile,
                   const VolumeOptions& options) {
  if (!options.note || !options.voxelSize || !ofFile) return;
  const std::string times = difference(*options.voxelSize, *ofFile);
  if (times.empty()) return;
  options.note(
      fmt::format("{}: the file says that a voxel is {} long; {}, {}, was given and is taken", path,
                  voxelText(*ofFile), voxelText(*options.voxelSize), times),
      NoteAbout::voxelSize);
}

namespace {

bool haveProportions(const VoxelSize& size, const std::array<double, 3>& edges) {
  std::array<double, 3> ratios;
  for (size_t axis = 0; axis < 3; ++axis) ratios[axis] = size.edges()[axis] / edges[axis];
  return areEdgesOfCube(ratios);
}

}  // namespace

void noteProportions(const std::string& path, const std::array<double, 3>& edges,
                     const VolumeOptions& options) {
  if (!options.note || !options.voxelSize || areEdgesOfCube(edges) ||
      haveProportions(*options.voxelSize, edges))
    return;
  const double least = *std::min_element(edges.begin(), edges.end());
  options.note(
      fmt::format("{}: the file says that the edges of a voxel are as {} to {} to {}; {} "
                  "was given and is taken",
                  path, generalDecimal(edges[0] / least, 4), generalDecimal(edges[1] / least, 4),
                  generalDecimal(edges[2] / least, 4), voxelText(*options.voxelSize)),
      NoteAbout::voxelSize);
}

void noteVoxelSize(const std::string& path, const openvdb::GridBase& grid,
                   const VolumeOptions& options) {
  if (!options.note || !options.voxelSize) return;
  const auto own = storedVoxelSize(grid);
  noteVoxelSize(path, own, options);
  const openvdb::Vec3d size = grid.voxelSize();
  const std::array<double, 3> edges{size[0], size[1], size[2]};
  if (!grid["madf_gamma"]) {
    if (!own) noteProportions(path, edges, options);
  } else if (!haveProportions(*options.voxelSize, edges)) {
    options.note(path +
                     ": was segmented in voxels of other proportions, which give other grains: "
                     "segment the object anew",
                 NoteAbout::voxelSize);
  }
}

void noteBeyond(const std::string& path, const std::string& what, const CoordBBox& box,
                const CoordBBox& scan, const std::string& meaning, const VolumeOptions& options) {
  std::string axes;
  for (int axis = 0; axis < 3; ++axis) {
    const int low = box.min()[axis], high = box.max()[axis];
    const bool isBeyond = (low < scan.min()[axis] && low > -kMaxImageSide) ||
                          (high > scan.max()[axis] && high < kMaxImageSide - 1);
    if (isBeyond)
      axes += fmt::format("{}{} to {} along {}", axes.empty() ? "" : ", ", scan.min()[axis],
                          scan.max()[axis], "xyz"[axis]);
  }
  if (!axes.empty() && options.note)
    options.note(fmt::format("{}: the {} reaches beyond the scan, which goes from {}: what lies "
                             "outside {}",
                             path, what, axes, meaning),
                 NoteAbout::file);
}

void checkWithinDomain(const openvdb::GridBase& grid, const Domain& domain) {
  if (!grid.isType<Int32Grid>() && !grid.isType<BoolGrid>() && !grid.isType<MaskGrid>()) return;
  const CoordBBox active = grid.evalActiveVoxelBoundingBox();
  if (!active.empty() && !domain.box().isInside(active))
    checkWithin(objectMask(grid)->evalActiveVoxelBoundingBox(), domain);
}

void giveDomain(openvdb::GridBase& grid, const std::string& path, const VolumeOptions& options) {
  if (!options.domain) return;
  const auto own = storedDomain(grid);
  if (!regionName(grid).empty()) {
    if (options.note)
      options.note(path +
                       ": a domain was given and takes the place of the file's region: what of it "
                       "lies outside of the region counts as scanned, without an object",
                   NoteAbout::file);
  } else if (own) {
    noteBeyond(path, "domain", *options.domain, own->box(), "counts as scanned", options);
  }
  if (!options.region.any()) checkWithinDomain(grid, *options.domain);
  setDomain(grid, *options.domain);
}

void giveVoxelSize(openvdb::GridBase& grid, const VolumeOptions& options) {
  if (!options.voxelSize) return;
  const openvdb::Vec3d place = -grid.worldToIndex(openvdb::Vec3d(0));
  setVoxelSize(grid, options.voxelSize);
  if (place != openvdb::Vec3d(0)) grid.transform().preTranslate(place);
}

void noteLeftOut(const std::string& path, int64_t voxels, const char* kind,
                 const VolumeOptions& options) {
  if (voxels > 0 && options.note)
    options.note(fmt::format("{}: outside of the region, {} left out", path, counted(voxels, kind)),
                 NoteAbout::file);
}

}  // namespace vdb_madf::detail
