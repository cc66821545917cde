// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/load_labels.h"

#include <fmt/core.h>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/region_metadata.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/scans/detail/scan_part.h"
#include "vdb_madf/scans/histogram.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "vdb_madf/volumes/detail/chosen_part.h"
#include "vdb_madf/volumes/detail/reading.h"
#include "vdb_madf/volumes/detail/volume_notes.h"
#include "vdb_madf/volumes/read_labels.h"

namespace vdb_madf {

namespace {

/// A gray scan would have millions of grains: it has many values, and hardly two voxels side by
/// side have the same. So have labels of grains that are a voxel or two wide; but theirs lie close
/// together, where those of a gray value lie anywhere. Ordinary labels have longer runs, and are
/// not read a second time. A scan that was smoothed has longer runs, too, and is noted.
void checkLabels(const ImageOpener& open, const VolumeOptions& options, Interrupter* interrupter) {
  constexpr double kNoise = 1.5;
  constexpr double kScattered = 0.2;  // between a tenth, of a thousand grains, and 1/3
  constexpr size_t kFewValues = 100;
  const auto image = open();
  const Histogram values = histogramOf(*image, interrupter);
  if (values.counts.size() <= kFewValues || kindOf(values) != ImageKind::gray) return;
  const bool isNoisy = meanRun(values) < kNoise;
  if (!isNoisy && (options.areLabels || !options.note)) return;
  constexpr double kMost = 2147483647;
  const bool couldBe =
      values.whole && values.notFinite == 0 && values.max <= kMost && values.min >= -kMost - 1;
  if (!couldBe && !isNoisy) return;
  if (couldBe && valueSpread(*open(), interrupter) < kScattered) return;
  const std::string range = fmt::format("{} to {}", detail::shortestDecimal(values.min),
                                        detail::shortestDecimal(values.max));
  if (isNoisy && (!couldBe || !options.areLabels))
    throw InvalidInput(fmt::format("{}: is a gray image, with values from {}, not labels: segment "
                                   "it first",
                                   image->path(), range),
                       couldBe ? Hint::areLabels : Hint::none);
  if (options.note)
    options.note(
        fmt::format("{}: its values, from {}, are taken for labels{}, though they lie as in "
                    "a gray image{}",
                    image->path(), range, isNoisy ? ", as was said" : "",
                    isNoisy ? "" : ", which is to be segmented first"),
        NoteAbout::file);
}

Int32Grid::Ptr labelsOfGrid(const std::string& path, const VolumeOptions& options,
                            Interrupter* interrupter) {
  const auto labels = openvdb::gridPtrCast<Int32Grid>(
      detail::readGrid(path, GridUse::labels, options, interrupter));
  detail::giveDomain(*labels, path, options);
  if (const auto part = detail::partOf(*labels, path, options, interrupter))
    detail::noteLeftOut(path, detail::cutTo(*part, *labels), "labeled voxel", options);
  detail::noteVoxelSize(path, *labels, options);
  return labels;
}

Int32Grid::Ptr labelsOfImage(const std::string& path, const ImageOpener& open,
                             const VolumeOptions& options, Interrupter* interrupter) {
  checkLabels(open, options, interrupter);
  const auto part = detail::partOfImage(open, options, interrupter);
  const auto image = open();
  if (!part) {
    const Int32Grid::Ptr labels = readLabels(*image, interrupter);
    detail::giveDomain(*labels, path, options);
    return labels;
  }
  const Int32Grid::Ptr labels =
      readLabels(*image, interrupter, detail::boxOf(*part, image->info().size));
  detail::noteLeftOut(path, detail::cutTo(*part, *labels), "labeled voxel", options);
  return labels;
}

}  // namespace

Int32Grid::Ptr loadLabels(const std::string& path, const VolumeOptions& options,
                          Interrupter* interrupter) {
  const Int32Grid::Ptr labels = detail::naming(path, options.region.mask, [&] {
    return detail::isReadAsVdb(path, options)
               ? labelsOfGrid(path, options, interrupter)
               : labelsOfImage(
                     path, [&] { return openVolumeImage(path, options); }, options, interrupter);
  });
  detail::giveVoxelSize(*labels, options);
  return labels;
}

LabelSlabs openLabelSlabs(const std::string& path, const VolumeOptions& options,
                          Interrupter* interrupter) {
  const SlabFolder folder = openSlabFolder(path);
  auto chosen = chooseGrid(readVdbHeaders(path, interrupter), path, GridUse::labels, options.grid);
  if ((*chosen)[detail::kRegionKey])  // headers do not hold a region's voxels
    chosen = readVdbSlab(folder, 0, detail::readingAlone(*chosen), interrupter)
                 .at(0)
                 ->copyGridWithNewTree();
  LabelSlabs slabs;
  slabs.cuts = folder.cuts;
  slabs.read = [folder, reading = detail::readingAlone(*chosen)](size_t slab, Interrupter* of) {
    return openvdb::gridPtrCast<Int32Grid>(readVdbSlab(folder, slab, reading, of).at(0));
  };
  overrideFile(*chosen, path, options);
  slabs.about = openvdb::gridPtrCast<Int32Grid>(chosen);
  return slabs;
}

Int32Grid::Ptr loadLabels(const ImageOpener& open, const VolumeOptions& options,
                          Interrupter* interrupter) {
  const ImageOpener checked = [&] { return detail::checkedImage(open(), options); };
  const std::string path = open()->path();
  const Int32Grid::Ptr labels = detail::naming(path, options.region.mask, [&] {
    return labelsOfImage(path, checked, options, interrupter);
  });
  detail::giveVoxelSize(*labels, options);
  return labels;
}

}  // namespace vdb_madf
