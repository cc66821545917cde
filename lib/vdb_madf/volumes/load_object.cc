// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/load_object.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/base/counted.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/scans/detail/scan_part.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "vdb_madf/volumes/detail/chosen_part.h"
#include "vdb_madf/volumes/detail/reading.h"
#include "vdb_madf/volumes/detail/volume_notes.h"

namespace vdb_madf {

namespace {

MaskGrid::Ptr objectOfGrid(const std::string& path, const VolumeOptions& options,
                           Interrupter* interrupter) {
  if (readsGray(options.gray))
    throw InvalidInput(path +
                       ": smoothing, hysteresis and automatic thresholds are for images, and this "
                       "is a VDB file: leave them out");
  const auto grid = detail::readGrid(path, GridUse::object, options, interrupter);
  detail::giveDomain(*grid, path, options);  // an inversion needs it
  const auto part = detail::partOf(*grid, path, options, interrupter);
  const MaskGrid::Ptr object = objectMask(*grid, options.selection);
  if (part) detail::noteLeftOut(path, detail::cutTo(*part, *object), "object voxel", options);
  detail::noteVoxelSize(path, *object, options);
  despeckleObject(*object, options.gray.despeckle, interrupter);
  return object;
}

/// Every so many layers of an object that is in memory.
void takeShare(MaskTree& object, const TakeLayer& take, const ObjectShare& share) {
  takeLayers(object, [&](MaskTree& layer) {
    const auto leaf = layer.cbeginLeaf();
    if (leaf && ((leaf->origin().z() >> 3) % share.parts + share.parts) % share.parts == share.part)
      take(layer);
  });
}

/// The slices of a share of a box, by layers of leaf nodes; there may be none.
CoordBBox shareOf(CoordBBox box, const ObjectShare& share) {
  if (box.empty()) return box;
  const int lowest = box.min().z() >> 3;
  const int64_t layers = (box.max().z() >> 3) - lowest + 1;
  const auto first = [&](int part) { return (lowest + int(layers * part / share.parts)) * 8; };
  box.min().z() = std::max(box.min().z(), first(share.part));
  box.max().z() = std::min(box.max().z(), first(share.part + 1) - 1);
  return box;
}

MaskGrid::Ptr shareOfImage(const std::string& path, const ImageOpener& open,
                           const VolumeOptions& options, const TakeLayer& take,
                           const ObjectShare& share, Interrupter* interrupter) {
  const GrayOptions& gray = options.gray;
  if (!options.selection || gray.automatic != AutomaticThreshold::none || gray.low ||
      gray.despeckle > 1)
    throw InvalidInput(path +
                       ": several read a part of it each: say by value which voxels are object, "
                       "without hysteresis and despeckling (convert makes a mask of it)");
  const auto chosen = detail::partOfImage(open, options, interrupter);
  // Opened once, for some formats look at all slices then.
  std::unique_ptr<ImageReader> image = open();
  const CoordBBox whole = imageBox(image->info().size);
  const ImageOpener opened = [&] { return image ? std::move(image) : open(); };
  ScanPart part = chosen.value_or(ScanPart{whole, Domain(whole)});
  part.box.intersect(whole);
  const CoordBBox slices = shareOf(part.box, share);
  if (!part.box.empty())  // a share of nothing: one voxel, for what is said of the object
    part.box = slices.empty() ? CoordBBox(part.box.min(), part.box.min()) : slices;
  const MaskGrid::Ptr object = imageObject(opened, options.selection, gray, part, interrupter,
                                           slices.empty() ? [](MaskTree&) {} : take)
                                   .mask;
  if (!chosen) detail::giveDomain(*object, path, options);
  return object;
}

/// Takes the voxels of a folder of slabs, slab by slab.
MaskGrid::Ptr objectOfSlabs(const std::string& path, const VolumeOptions& options,
                            const TakeLayer& take, const ObjectShare& share,
                            Interrupter* interrupter) {
  const SlabFolder folder = openSlabFolder(path);
  const auto chosen =
      chooseGrid(readVdbHeaders(path, interrupter), path, GridUse::object, options.grid);
  detail::giveDomain(*chosen, path, options);
  const auto part = detail::partOf(*chosen, path, options, interrupter);
  const MaskGrid::Ptr object = objectMask(*chosen);
  int64_t leftOut = 0;
  for (size_t s = 0; s < folder.slabCount(); ++s) {
    if (s * size_t(share.parts) / folder.slabCount() != size_t(share.part)) continue;
    const auto grid = readVdbSlab(folder, s, detail::readingAlone(*chosen), interrupter).at(0);
    const MaskGrid::Ptr slab = objectMask(*grid, options.selection);
    if (part) leftOut += detail::cutTo(*part, *slab);
    takeLayers(slab->tree(), take);
  }
  if (share.parts == 1) detail::noteLeftOut(path, leftOut, "object voxel", options);
  detail::noteVoxelSize(path, *object, options);
  return object;
}

/// True if the slabs of a folder become an object one by one.
bool isSlabwise(const std::string& path, const VolumeOptions& options) {
  return isSlabFolder(path) && !readsGray(options.gray) && options.gray.despeckle <= 1 &&
         !options.region.cylinder && options.region.mask.empty() &&
         !(options.selection && options.selection->invert);
}

MaskGrid::Ptr objectOfImage(const std::string& path, const ImageOpener& open,
                            const VolumeOptions& options, Interrupter* interrupter,
                            const TakeLayer& take = nullptr) {
  const auto part = detail::partOfImage(open, options, interrupter);
  const ImageObject found =
      imageObject(open, options.selection, options.gray, part, interrupter, take);
  if (found.fromLabels && options.note)
    options.note(path + ": it has several values besides 0, and all of them become one mask",
                 NoteAbout::labels);
  if (found.corner && options.note)
    options.note(path + ": the corners of all slices have the value " +
                     detail::shortestDecimal(*found.corner) +
                     ", as around a round field of view, and count as scanned: say that the scan "
                     "is a cylinder, if it is one",
                 NoteAbout::cylinder);
  if (found.nans > 0 && options.note) {
    std::string text = path + ": has " + counted(found.nans, "voxel") +
                       " without a number (NaN), taken for scanned background";
    if (!part)
      text += ": if they are around a round field of view, say that the scan is a cylinder";
    options.note(text, part ? NoteAbout::file : NoteAbout::cylinder);
  }
  if (found.infinities > 0 && options.note)
    options.note(path + ": has " + counted(found.infinities, "voxel") +
                     " of infinite value, above or below all numbers: give those without a value "
                     "NaN",
                 NoteAbout::file);
  detail::noteLeftOut(path, found.leftOut, "object voxel", options);
  if (!part) detail::giveDomain(*found.mask, path, options);
  return found.mask;
}

MaskGrid::Ptr finishedObject(MaskGrid::Ptr object, const VolumeOptions& options) {
  detail::giveVoxelSize(*object, options);
  object->setName("object");
  return object;
}

}  // namespace

MaskGrid::Ptr loadObject(const std::string& path, const VolumeOptions& options,
                         Interrupter* interrupter) {
  const MaskGrid::Ptr object = detail::naming(path, options.region.mask, [&] {
    if (detail::isReadAsVdb(path, options)) return objectOfGrid(path, options, interrupter);
    return objectOfImage(
        path, [&] { return openVolumeImage(path, options); }, options, interrupter);
  });
  return finishedObject(object, options);
}

MaskGrid::Ptr loadObject(const ImageOpener& open, const VolumeOptions& options,
                         Interrupter* interrupter) {
  const ImageOpener checked = [&] { return detail::checkedImage(open(), options); };
  const std::string path = open()->path();
  const MaskGrid::Ptr object = detail::naming(path, options.region.mask, [&] {
    return objectOfImage(path, checked, options, interrupter);
  });
  return finishedObject(object, options);
}

MaskGrid::Ptr streamObject(const std::string& path, const VolumeOptions& options,
                           const TakeLayer& take, const ObjectShare& share,
                           Interrupter* interrupter) {
  const ImageOpener open = [&] { return openVolumeImage(path, options); };
  const MaskGrid::Ptr object = detail::naming(path, options.region.mask, [&] {
    const bool isVdb = detail::isReadAsVdb(path, options);
    if (!isVdb && share.parts > 1)
      return shareOfImage(path, open, options, take, share, interrupter);
    if (!isVdb) return objectOfImage(path, open, options, interrupter, take);
    if (isSlabwise(path, options)) return objectOfSlabs(path, options, take, share, interrupter);
    MaskGrid::Ptr whole = objectOfGrid(path, options, interrupter);
    takeShare(whole->tree(), take, share);
    return whole;
  });
  return finishedObject(object, options);
}

}  // namespace vdb_madf
