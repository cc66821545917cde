// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/volume.h"

#include <algorithm>

#include "vdb_madf/base/counted.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/files/same_file.h"
#include "vdb_madf/grids/detail/region_metadata.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/scans/detail/field_of_view.h"
#include "vdb_madf/scans/detail/scan_part.h"
#include "vdb_madf/scans/histogram.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "vdb_madf/volumes/detail/chosen_part.h"
#include "vdb_madf/volumes/read_labels.h"

namespace vdb_madf {

namespace {

bool isUsable(const openvdb::GridBase& grid, GridUse use) {
  if (use == GridUse::labels) return grid.isType<Int32Grid>();
  const std::string type = grid.valueType();
  return grid.isType<MaskGrid>() || type == "bool" || type == "int32" || type == "int64" ||
         type == "float" || type == "double";
}

std::vector<const char*> preferredNames(GridUse use) {
  switch (use) {
    case GridUse::object:
      return {"object"};
    case GridUse::labels:
      return {"grain", "truth"};
    case GridUse::values:
      break;
  }
  return {"grain", "truth", "object"};
}

/// @throw InvalidInput if the options name a part that only other files have
bool isReadAsVdb(const std::string& path, const VolumeOptions& options) {
  const bool isVdb = !options.raw && isVdbFile(path);
  if (isVdb && !options.dataset.empty())
    throw InvalidInput(path + ": a dataset is named, and this is a VDB file: name a grid");
  if (!isVdb && !options.grid.empty())
    throw InvalidInput(path + ": a grid is named, and this is no VDB file");
  return isVdb;
}

/// Not the other grids of the file.
VdbReadOptions readingAlone(const openvdb::GridBase& chosen) {
  VdbReadOptions reading;
  reading.wanted = [name = chosen.getName(), type = chosen.type()](const auto& grid) {
    return grid.getName() == name && grid.type() == type;
  };
  return reading;
}

/// Chooses by name and type first: the other grids of the file are not loaded.
openvdb::GridBase::Ptr readGrid(const std::string& path, GridUse use, const VolumeOptions& options,
                                Interrupter* interrupter) {
  const auto chosen = chooseGrid(readVdbHeaders(path, interrupter), path, use, options.grid);
  return readVdb(path, readingAlone(*chosen), interrupter).at(0);
}

/// Runs `work`; what is wrong with the data then names the file, too, unless it names a mask.
template <typename Work>
auto naming(const std::string& path, const std::string& mask, const Work& work)
    -> decltype(work()) {
  try {
    return work();
  } catch (const SelectionNeeded&) {
    throw;
  } catch (const AmbiguousGrid&) {
    throw;
  } catch (const InvalidInput& error) {
    const std::string what = error.what();
    if (what.find(path) == 0 || (!mask.empty() && what.find(mask) == 0)) throw;
    throw InvalidInput(path + ": " + what, error.hint());
  }
}

/// "8.5 um", "0.5 x 0.5 x 1.2 um"
std::string text(const VoxelSize& size) {
  const double longest = *std::max_element(size.edges().begin(), size.edges().end());
  const auto [unit, perMetre] = longest < 1e-6   ? std::pair("nm", 1e9)
                                : longest < 1e-3 ? std::pair("um", 1e6)
                                                 : std::pair("mm", 1e3);
  std::string text;
  for (size_t axis = 0; axis < (size.isCube() ? 1 : 3); ++axis) {
    if (axis > 0) text += " x ";
    text += detail::generalDecimal(size.edges()[axis] * perMetre, 4);
  }
  return text + " " + unit;
}

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
  return detail::generalDecimal(factor, 4) + " times as " + (ratio > 1 ? "long" : "short");
}

/// Mostly a slip of the unit, or another sample's size.
void noteVoxelSize(const std::string& path, const std::optional<VoxelSize>& ofFile,
                   const VolumeOptions& options) {
  if (!options.note || !options.voxelSize || !ofFile) return;
  const std::string times = difference(*options.voxelSize, *ofFile);
  if (times.empty()) return;
  options.note(path + ": the file says that a voxel is " + text(*ofFile) + " long; " +
                   text(*options.voxelSize) + ", " + times + ", was given and is taken",
               NoteAbout::voxelSize);
}

/// A gray scan would have millions of grains: it has many values, and hardly two voxels side by side
/// have the same.
void checkLabels(ImageReader& image, Interrupter* interrupter) {
  constexpr double kNoise = 1.5;
  constexpr size_t kFewValues = 100;
  const Histogram values = histogramOf(image, interrupter);
  if (values.counts.size() > kFewValues && kindOf(values) == ImageKind::gray &&
      meanRun(values) < kNoise)
    throw InvalidInput(image.path() + ": is a gray image, with values from " +
                       detail::shortestDecimal(values.min) + " to " +
                       detail::shortestDecimal(values.max) + ", not labels: segment it first");
}

/// The part of a grid that the options choose, whose domain it then has.
std::optional<ScanPart> partOf(openvdb::GridBase& grid, const std::string& path,
                               const VolumeOptions& options, Interrupter* interrupter) {
  if (!options.region.any()) return std::nullopt;
  detail::ScanExtent extent;
  extent.domain = storedDomain(grid);
  const auto& cylinder = options.region.cylinder;
  if (cylinder && !(cylinder->radius && extent.domain)) {  // else nothing depends on its voxels
    const MaskGrid::Ptr voxels = objectMask(grid);
    extent.box = voxels->evalActiveVoxelBoundingBox();
    extent.farthestFromAxis = [voxels](const detail::CylinderAxis& axis) {
      return detail::farthestFromAxis(voxels->tree(), axis);
    };
  }
  const ScanPart part = detail::chosenPart(path, options, extent, interrupter);
  setDomain(grid, part.domain);
  return part;
}

std::optional<ScanPart> partOfImage(const ImageOpener& open, const VolumeOptions& options,
                                    Interrupter* interrupter) {
  if (!options.region.any()) return std::nullopt;
  const auto image = open();
  const CoordBBox box = imageBox(image->info().size);
  detail::ScanExtent extent{Domain(options.domain.value_or(box)), box,
                            [&](const detail::CylinderAxis& axis) {
                              return detail::farthestFromAxis(*image, axis, interrupter);
                            }};
  return detail::chosenPart(image->path(), options, extent, interrupter);
}

void noteLeftOut(const std::string& path, int64_t voxels, const char* kind,
                 const VolumeOptions& options) {
  if (voxels > 0 && options.note)
    options.note(path + ": outside of the region, " + counted(voxels, kind) + " left out",
                 NoteAbout::file);
}

MaskGrid::Ptr objectOfGrid(const std::string& path, const VolumeOptions& options,
                           Interrupter* interrupter) {
  if (readsGray(options.gray))
    throw InvalidInput(path +
                       ": smoothing, hysteresis and automatic thresholds are for images, and this "
                       "is a VDB file: leave them out");
  const auto grid = readGrid(path, GridUse::object, options, interrupter);
  if (options.domain) setDomain(*grid, *options.domain);  // an inversion needs it
  const auto part = partOf(*grid, path, options, interrupter);
  const MaskGrid::Ptr object = objectMask(*grid, options.selection);
  if (part) noteLeftOut(path, detail::cutTo(*part, *object), "object voxel", options);
  noteVoxelSize(path, storedVoxelSize(*object), options);
  despeckleObject(*object, options.gray.despeckle, interrupter);
  if (options.takeLayer)
    takeLayers(object->tree(), [&](MaskTree& layer) {
      const auto leaf = layer.cbeginLeaf();
      const int parts = options.share.parts;
      if (leaf && ((leaf->origin().z() >> 3) % parts + parts) % parts == options.share.part)
        options.takeLayer(layer);
    });
  return object;
}

/// The slices of a share of a box, by layers of leaf nodes; there may be none.
CoordBBox shareOf(CoordBBox box, const VolumeOptions::Share& share) {
  if (box.empty()) return box;
  const int lowest = box.min().z() >> 3;
  const int64_t layers = (box.max().z() >> 3) - lowest + 1;
  const auto first = [&](int part) { return (lowest + int(layers * part / share.parts)) * 8; };
  box.min().z() = std::max(box.min().z(), first(share.part));
  box.max().z() = std::min(box.max().z(), first(share.part + 1) - 1);
  return box;
}

MaskGrid::Ptr shareOfImage(const std::string& path, const ImageOpener& open,
                           const VolumeOptions& options, Interrupter* interrupter) {
  const GrayOptions& gray = options.gray;
  if (!options.selection || gray.automatic != AutomaticThreshold::none || gray.low ||
      gray.despeckle > 1)
    throw InvalidInput(path +
                       ": several read a part of it each: say by value which voxels are object, "
                       "without hysteresis and despeckling (convert makes a mask of it)");
  const auto chosen = partOfImage(open, options, interrupter);
  // Opened once, for some formats look at all slices then.
  std::unique_ptr<ImageReader> image = open();
  const CoordBBox whole = imageBox(image->info().size);
  const ImageOpener opened = [&] { return image ? std::move(image) : open(); };
  ScanPart part = chosen.value_or(ScanPart{whole, Domain(whole)});
  part.box.intersect(whole);
  const CoordBBox share = shareOf(part.box, options.share);
  if (!part.box.empty())  // a share of nothing: one voxel, for what is said of the object
    part.box = share.empty() ? CoordBBox(part.box.min(), part.box.min()) : share;
  const MaskGrid::Ptr object = imageObject(opened, options.selection, gray, part, interrupter,
                                           share.empty() ? [](MaskTree&) {} : options.takeLayer)
                                   .mask;
  if (options.domain && !chosen) setDomain(*object, *options.domain);
  return object;
}

/// Of a folder of slabs, whose voxels are taken slab by slab.
MaskGrid::Ptr objectOfSlabs(const std::string& path, const VolumeOptions& options,
                            Interrupter* interrupter) {
  const SlabFolder folder = openSlabFolder(path);
  const auto chosen =
      chooseGrid(readVdbHeaders(path, interrupter), path, GridUse::object, options.grid);
  if (options.domain) setDomain(*chosen, *options.domain);
  const auto part = partOf(*chosen, path, options, interrupter);
  const MaskGrid::Ptr object = objectMask(*chosen);
  int64_t leftOut = 0;
  const auto parts = size_t(options.share.parts);
  for (size_t s = 0; s < folder.slabCount(); ++s) {
    if (s * parts / folder.slabCount() != size_t(options.share.part)) continue;
    const auto grid = readVdbSlab(folder, s, readingAlone(*chosen), interrupter).at(0);
    const MaskGrid::Ptr slab = objectMask(*grid, options.selection);
    if (part) leftOut += detail::cutTo(*part, *slab);
    takeLayers(slab->tree(), options.takeLayer);
  }
  if (parts == 1) noteLeftOut(path, leftOut, "object voxel", options);
  noteVoxelSize(path, storedVoxelSize(*object), options);
  return object;
}

/// Can the slabs of a folder become an object one by one?
bool isSlabwise(const std::string& path, const VolumeOptions& options) {
  return options.takeLayer && isSlabFolder(path) && !readsGray(options.gray) &&
         options.gray.despeckle <= 1 && !options.region.cylinder && options.region.mask.empty() &&
         !(options.selection && options.selection->invert);
}

MaskGrid::Ptr objectOfImage(const std::string& path, const ImageOpener& open,
                            const VolumeOptions& options, Interrupter* interrupter) {
  if (options.share.parts > 1) return shareOfImage(path, open, options, interrupter);
  const auto part = partOfImage(open, options, interrupter);
  const ImageObject found =
      imageObject(open, options.selection, options.gray, part, interrupter, options.takeLayer);
  if (found.fromLabels && options.note)
    options.note(path + ": it has several values besides 0, and all of them become one mask",
                 NoteAbout::labels);
  noteLeftOut(path, found.leftOut, "object voxel", options);
  if (options.domain && !part) setDomain(*found.mask, *options.domain);
  return found.mask;
}

Int32Grid::Ptr labelsOfGrid(const std::string& path, const VolumeOptions& options,
                            Interrupter* interrupter) {
  const auto labels =
      openvdb::gridPtrCast<Int32Grid>(readGrid(path, GridUse::labels, options, interrupter));
  if (options.domain) setDomain(*labels, *options.domain);
  if (const auto part = partOf(*labels, path, options, interrupter))
    noteLeftOut(path, detail::cutTo(*part, *labels), "labelled voxel", options);
  noteVoxelSize(path, storedVoxelSize(*labels), options);
  return labels;
}

Int32Grid::Ptr labelsOfImage(const std::string& path, const ImageOpener& open,
                             const VolumeOptions& options, Interrupter* interrupter) {
  checkLabels(*open(), interrupter);
  const auto part = partOfImage(open, options, interrupter);
  const auto image = open();
  if (!part) {
    const Int32Grid::Ptr labels = readLabels(*image, interrupter);
    if (options.domain) setDomain(*labels, *options.domain);
    return labels;
  }
  const Int32Grid::Ptr labels =
      readLabels(*image, interrupter, detail::boxOf(*part, image->info().size));
  noteLeftOut(path, detail::cutTo(*part, *labels), "labelled voxel", options);
  return labels;
}

/// Checks an image against the options, and says what a user should know of it.
std::unique_ptr<ImageReader> checkedImage(std::unique_ptr<ImageReader> image,
                                          const VolumeOptions& options) {
  const std::string& path = image->path();
  CoordBBox box = imageBox(image->info().size);
  if (options.region.crop) box.intersect(*options.region.crop);
  for (int axis = 0; axis < 3; ++axis)
    if (options.longestSide > 0 && box.dim()[axis] > options.longestSide)
      throw InvalidInput(path + ": is " + std::to_string(box.dim()[axis]) +
                         " voxels long, and at most " + std::to_string(options.longestSide) +
                         " can be worked with here: crop or coarsen it");
  if (options.note)
    for (const std::string& note : image->notes()) options.note(note, NoteAbout::file);
  noteVoxelSize(path, image->info().voxelSize, options);
  return image;
}

MaskGrid::Ptr finishedObject(MaskGrid::Ptr object, const VolumeOptions& options) {
  if (options.voxelSize) setVoxelSize(*object, options.voxelSize);
  object->setName("object");
  return object;
}

}  // namespace

AmbiguousGrid::AmbiguousGrid(const std::string& path, const std::string& grids)
    : InvalidInput(path + ": choose a grid by its name; the file holds " + grids), grids_(grids) {}

bool isVdbFile(const std::string& path) {
  if (isSlabFolder(path)) return true;
  try {
    // OpenVDB's magic number: ' BDV' as a little-endian 64-bit integer.
    if (detail::InputFile(path).head(8) == std::string(" BDV\0\0\0\0", 8)) return true;
  } catch (const IoError&) {  // nothing there to look at
  }
  return fileEnding(path) == ".vdb" && !looksLikeImage(path);
}

openvdb::GridBase::Ptr chooseGrid(const std::vector<openvdb::GridBase::Ptr>& grids,
                                  const std::string& path, GridUse use, const std::string& name) {
  std::string list;
  std::vector<openvdb::GridBase::Ptr> usable;
  for (const auto& grid : grids) {
    list += (list.empty() ? "" : ", ") + grid->getName() + " (" + grid->valueType() + ")";
    if (isUsable(*grid, use) && !isRegion(*grid, grids)) usable.push_back(grid);
  }
  if (list.empty()) throw InvalidInput(path + ": the file holds no grid");
  if (!name.empty()) {
    for (const auto& grid : grids) {
      if (grid->getName() != name) continue;
      if (isUsable(*grid, use)) return grid;
      throw InvalidInput(path + ": grid '" + name + "' holds " + grid->valueType() +
                         " values, which this command cannot use");
    }
    throw InvalidInput(path + ": there is no grid '" + name + "'; the file holds " + list);
  }
  for (const char* preferred : preferredNames(use))
    for (const auto& grid : usable)
      if (grid->getName() == preferred) return grid;
  if (usable.size() == 1) return usable[0];
  if (!usable.empty()) throw AmbiguousGrid(path, list);
  throw InvalidInput(path +
                     (use == GridUse::labels
                          ? ": there is no grid of labels (int32), such as segment writes"
                          : ": there is no grid of a mask or numbers") +
                     "; the file holds " + list);
}

void overrideFile(openvdb::GridBase& grid, const std::string& path, const VolumeOptions& options) {
  noteVoxelSize(path, storedVoxelSize(grid), options);
  if (options.domain) setDomain(grid, *options.domain);
  if (options.voxelSize) setVoxelSize(grid, options.voxelSize);
}

std::unique_ptr<ImageReader> openVolumeImage(const std::string& path,
                                             const VolumeOptions& options) {
  auto image = openImage(path, options.raw, options.dataset);
  for (const std::string& output : options.outputs)
    for (const std::string& file : image->files())
      if (isSameFile(file, output))
        throw InvalidInput(output + ": holds samples of " + path +
                           ", which the output would overwrite; choose another name");
  return checkedImage(std::move(image), options);
}

MaskGrid::Ptr loadObject(const std::string& path, const VolumeOptions& options,
                         Interrupter* interrupter) {
  const MaskGrid::Ptr object = naming(path, options.region.mask, [&] {
    const bool isVdb = isReadAsVdb(path, options);
    if (isVdb && isSlabwise(path, options)) return objectOfSlabs(path, options, interrupter);
    return isVdb ? objectOfGrid(path, options, interrupter)
                 : objectOfImage(
                       path, [&] { return openVolumeImage(path, options); }, options, interrupter);
  });
  return finishedObject(object, options);
}

MaskGrid::Ptr loadObject(const ImageOpener& open, const VolumeOptions& options,
                         Interrupter* interrupter) {
  const ImageOpener checked = [&] { return checkedImage(open(), options); };
  const std::string path = open()->path();
  const MaskGrid::Ptr object = naming(path, options.region.mask, [&] {
    return objectOfImage(path, checked, options, interrupter);
  });
  return finishedObject(object, options);
}

Int32Grid::Ptr loadLabels(const std::string& path, const VolumeOptions& options,
                          Interrupter* interrupter) {
  const Int32Grid::Ptr labels = naming(path, options.region.mask, [&] {
    return isReadAsVdb(path, options)
               ? labelsOfGrid(path, options, interrupter)
               : labelsOfImage(
                     path, [&] { return openVolumeImage(path, options); }, options, interrupter);
  });
  if (options.voxelSize) setVoxelSize(*labels, options.voxelSize);
  return labels;
}

LabelSlabs openLabelSlabs(const std::string& path, const VolumeOptions& options,
                          Interrupter* interrupter) {
  const SlabFolder folder = openSlabFolder(path);
  auto chosen = chooseGrid(readVdbHeaders(path, interrupter), path, GridUse::labels, options.grid);
  if ((*chosen)[detail::kRegionKey])  // headers do not hold a region's voxels
    chosen =
        readVdbSlab(folder, 0, readingAlone(*chosen), interrupter).at(0)->copyGridWithNewTree();
  LabelSlabs slabs;
  slabs.cuts = folder.cuts;
  slabs.read = [folder, reading = readingAlone(*chosen)](size_t slab, Interrupter* of) {
    return openvdb::gridPtrCast<Int32Grid>(readVdbSlab(folder, slab, reading, of).at(0));
  };
  overrideFile(*chosen, path, options);
  slabs.about = openvdb::gridPtrCast<Int32Grid>(chosen);
  return slabs;
}

Int32Grid::Ptr loadLabels(const ImageOpener& open, const VolumeOptions& options,
                          Interrupter* interrupter) {
  const ImageOpener checked = [&] { return checkedImage(open(), options); };
  const std::string path = open()->path();
  const Int32Grid::Ptr labels = naming(path, options.region.mask, [&] {
    return labelsOfImage(path, checked, options, interrupter);
  });
  if (options.voxelSize) setVoxelSize(*labels, options.voxelSize);
  return labels;
}

}  // namespace vdb_madf
