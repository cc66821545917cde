// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "grid_image.h"

#include <fmt/core.h>

#include <iostream>
#include <memory>
#include <vector>

#include "member_failure.h"
#include "outputs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/word_list.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/volumes/image_losses.h"
#include "vdb_madf/volumes/label_type.h"
#include "vdb_madf/volumes/write_image.h"

namespace vdb_madf::tools {

namespace {

/// Programs that look at TIFF take signed samples for something else than labels, if they take them
/// at all.
SampleType naturalType(const openvdb::GridBase& grid, const std::string& path) {
  if (grid.isType<Int32Grid>() && hasTiffEnding(path))
    return labelType(static_cast<const Int32Grid&>(grid));
  const std::string type = grid.valueType();
  if (grid.isType<MaskGrid>() || type == "bool") return SampleType::uint8;
  if (type == "float") return SampleType::float32;
  if (type == "double") return SampleType::float64;
  return SampleType::int32;
}

[[noreturn]] void refuseEmpty(const openvdb::GridBase& grid, const std::string& source) {
  throw InvalidInput(source + ": grid '" + grid.getName() +
                     "' is empty and has no domain: there is nothing to write; give --domain");
}

/// That no domain tells which box is written.
void tellBox(const std::string& path, const CoordBBox& box, const Common& common) {
  if (!common.quiet)
    std::cout << path << ": no known domain, so the active bounding box is written; its origin is "
              << box.min() << "\n";
}

void report(const std::string& path, const openvdb::GridBase& grid, const CoordBBox& box,
            SampleType type, const Common& common) {
  note(lossesOf(path, grid), common);
  reportImage(path, "grid '" + grid.getName() + "'", box.dim(), type, common);
}

/// Around the boxes of all members.
CoordBBox unitedBox(Team& team, const CoordBBox& box) {
  std::vector<int64_t> ends;  // maxima: the lower ones negative
  for (int axis = 0; axis < 3; ++axis) {
    ends.push_back(-int64_t(box.min()[axis]));
    ends.push_back(box.max()[axis]);
  }
  team.max(ends);
  CoordBBox all;
  for (int axis = 0; axis < 3; ++axis) {
    all.min()[axis] = int(-ends[size_t(2 * axis)]);
    all.max()[axis] = int(ends[size_t(2 * axis + 1)]);
  }
  return all;
}

/// Member 0 makes the file and puts it in its place; all write their slabs.
void writeByMembers(const std::string& path, const LabelSlabs& labels, size_t begin, size_t end,
                    const CoordBBox& box, SampleType type, const Common& common) {
  Team& team = *common.team;
  std::unique_ptr<ImageWriter> image;
  SharedImage shared;
  inAllMembers(team, [&] {
    if (team.member() != 0) return;
    image = createSharedImage(path, labels, box, type);
    const auto made = image->share();
    if (!made)
      throw InvalidInput(path +
                         ": several processes write .raw, .npy, .nrrd, .mha or .mhd; vdb_madf "
                         "convert writes other images");
    shared = *made;
  });
  Bytes name(shared.temporary.begin(), shared.temporary.end());
  team.broadcast(name);
  shared.temporary.assign(name.begin(), name.end());
  std::vector<int64_t> offset{int64_t(shared.offset)};
  team.max(offset);
  shared.offset = uint64_t(offset[0]);
  inAllMembers(
      team, [&] { writeImagePart(path, shared, labels, begin, end, box, type, common.progress); });
  inAllMembers(team, [&] {
    if (image) image->finish();
  });
}

}  // namespace

void checkVolumeEnding(const std::string& path) {
  if (path == "-") throw WrongUsage("-: say in which format: raw:-, npy:- or nrrd:-");
  if (!hasVdbEnding(path) && !isImageEnding(path))
    throw WrongUsage(path + ": the ending must be .vdb, " + wordList(writtenEndings()));
}

void writeGridAsImage(const std::string& path, const openvdb::GridBase& grid,
                      const std::optional<SampleType>& type, const std::string& source,
                      const Common& common) {
  const CoordBBox box = writtenBox(grid);
  if (!storedDomain(grid)) {
    if (grid.activeVoxelCount() == 0) refuseEmpty(grid, source);
    tellBox(path, box, common);
  }
  const SampleType chosen = type.value_or(naturalType(grid, path));
  writeImage(path, grid, box, chosen, common.progress);
  report(path, grid, box, chosen, common);
}

void writeSlabsAsImage(const std::string& path, const LabelSlabs& labels,
                       const std::optional<SampleType>& type, const std::string& source,
                       const Common& common) {
  Team alone;
  Team& team = common.team ? *common.team : alone;
  const size_t begin = team.firstSlab(team.member(), labels.slabCount()),
               end = team.firstSlab(team.member() + 1, labels.slabCount());
  const auto domain = storedDomain(*labels.about);
  CoordBBox box = domain ? domain->box() : CoordBBox();
  SampleType chosen = type.value_or(naturalType(*labels.about, path));
  if (!domain || (!type && hasTiffEnding(path))) {
    inAllMembers(team, [&] {
      for (size_t s = begin; s < end; ++s) {
        const Int32Grid::Ptr slab = labels.read(s, common.progress);
        if (!domain && slab->activeVoxelCount() > 0) box.expand(slab->evalActiveVoxelBoundingBox());
        // From uint16, what labels have if need be, to uint32 and int32.
        const SampleType own = naturalType(*slab, path);
        if (!type && chosen != SampleType::int32 && own != SampleType::uint16) chosen = own;
      }
    });
    box = unitedBox(team, box);
    if (box.empty()) refuseEmpty(*labels.about, source);
    if (!domain) tellBox(path, box, common);
  }
  if (common.team)
    writeByMembers(path, labels, begin, end, box, chosen, common);
  else
    writeImage(path, labels, box, chosen, common.progress);
  report(path, *labels.about, box, chosen, common);
}

void note(const std::vector<std::string>& notes, const Common& common) {
  for (const std::string& text : notes)
    if (!text.empty()) common.progress->note(text);
}

void reportImage(const std::string& path, const std::string& what, const Coord& size,
                 SampleType type, const Common& common) {
  common.progress->end();
  if (common.quiet) return;
  std::cout << path << ": " << what << ", " << size.x() << "x" << size.y() << "x" << size.z()
            << " voxels of type " << sampleTypeName(type) << "\n";
}

}  // namespace vdb_madf::tools
