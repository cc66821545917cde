// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/ome_zarr.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/detail/grain_table.h"
#include "vdb_madf/exports/detail/neuroglancer_files.h"
#include "vdb_madf/exports/detail/ome_attributes.h"
#include "vdb_madf/exports/detail/zarr_array_file.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/detail/reduction.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/labels/reduced_labels.h"

namespace vdb_madf {

namespace {

using detail::OmePlace;
using detail::WorkPart;
using detail::ZarrSamples;
using detail::ZarrVersion;
using Leaf = Int32Tree::LeafNodeType;

constexpr char kLabelGroup[] = "labels/grain";
/// Per cent of the work that measures and colors are.
constexpr int kMeasured = 60;

/// A volume at 1/factor.
struct Level {
  int factor = 1;
  CoordBBox box;
};

std::vector<Level> levelsOf(const CoordBBox& box) {
  std::vector<Level> levels{{1, box}};
  const auto longest = [&] {
    const Coord size = levels.back().box.dim();
    return std::max({size.x(), size.y(), size.z()});
  };
  for (int factor = 2; factor <= kMaxReduction && longest() > detail::kZarrChunk; factor *= 2)
    levels.push_back({factor, CoordBBox(detail::floorDiv(box.min(), factor),
                                        detail::floorDiv(box.max(), factor))});
  return levels;
}

/// Labels and object at 1/factor, in one pass.
struct CoarseTrees {
  Int32Tree label, gray;
};

CoarseTrees coarseTrees(const Int32Grid& labels, int factor, Interrupter* interrupter) {
  const detail::Reduction reduction(labels, factor);
  std::vector<std::unique_ptr<Leaf>> label(reduction.leafCount()), gray(reduction.leafCount());
  const int64_t all = int64_t(factor) * factor * factor;
  reduction.run(
      [&](size_t n, const Coord& origin, const detail::Cells& cells) {
        label[n] = detail::leafAt<Int32Grid>(origin);
        gray[n] = detail::leafAt<Int32Grid>(origin);
        for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
          const int64_t part = (2 * 255 * cells[i].labelled + all) / (2 * all);
          if (cells[i].majority) label[n]->setValueOn(i, cells[i].majority);
          if (part) gray[n]->setValueOn(i, int32_t(part));
        }
      },
      interrupter);
  CoarseTrees trees;
  for (size_t n = 0; n < label.size(); ++n) {
    if (!label[n]->isEmpty()) trees.label.addLeaf(label[n].release());
    if (!gray[n]->isEmpty()) trees.gray.addLeaf(gray[n].release());
  }
  return trees;
}

void writeLevel(const OutputTree& folder, const Int32Grid& labels, const Level& level,
                const std::string& name, ZarrVersion version, Interrupter* interrupter) {
  const auto write = [&](const std::string& group, const Int32Tree& tree, ZarrSamples samples) {
    detail::writeZarrArray(folder, group + name, tree, level.box, samples, version, interrupter);
  };
  const std::string labelGroup = std::string(kLabelGroup) + "/";
  if (level.factor == 1) {
    const auto tree = detail::withoutTiles(labels);
    write("", *tree, ZarrSamples::mask);
    write(labelGroup, *tree, ZarrSamples::label);
    return;
  }
  const CoarseTrees trees = coarseTrees(labels, level.factor, interrupter);
  write("", trees.gray, ZarrSamples::gray);
  write(labelGroup, trees.label, ZarrSamples::label);
}

void writeGroups(const OutputTree& folder, const OmePlace& place, const std::vector<Level>& levels,
                 const std::string& imageLabel, OmeVersion version, ZarrVersion zarr) {
  std::vector<detail::OmeScale> scales;
  for (const Level& level : levels) scales.push_back({level.factor, level.box.min()});
  const auto write = [&](const std::string& name,
                         const std::vector<detail::OmeMember>& attributes) {
    detail::writeZarrGroup(folder, name, detail::omeAttributes(attributes, version), zarr);
  };
  write("", {{"multiscales", detail::multiscales("object", place, scales, version)}});
  write("labels", {{"labels", "[\"grain\"]"}});
  write(kLabelGroup, {{"multiscales", detail::multiscales("grain", place, scales, version)},
                      {"image-label", imageLabel}});
}

/// The last part of a path, with or without a slash behind it.
std::string nameOf(const std::string& path) {
  const std::filesystem::path name(path);
  return (name.has_filename() ? name : name.parent_path()).filename().string();
}

}  // namespace

void writeOmeZarr(const std::string& path, const Int32Grid& labels, const CoordBBox& box,
                  const OmeZarrOptions& options, Interrupter* interrupter) {
  if (box.empty()) throw InvalidInput("there is no voxel and no domain: nothing to write");
  const OmePlace place = detail::omePlaceOf(labels);
  const ZarrVersion zarr =
      options.version == OmeVersion::v05 ? ZarrVersion::three : ZarrVersion::two;
  const std::vector<Level> levels = levelsOf(box);
  detail::checkNeuroglancer(labels, options);
  OutputTree folder(path);
  {
    WorkPart part(interrupter, 0, kMeasured);
    const detail::GrainTable table(measure(labels, options.measure, &part));
    const GrainColors colors = grainColors(labels, interrupter);
    writeGroups(folder, place, levels, detail::imageLabel(table, colors, options.version),
                options.version, zarr);
    if (options.meshes)
      detail::writeNeuroglancer(folder, nameOf(path), labels, box, place, table, colors, options,
                                interrupter);
  }
  for (size_t i = 0; i < levels.size(); ++i) {
    const auto percent = [&](size_t done) {
      return kMeasured + int(done) * (100 - kMeasured) / int(levels.size());
    };
    WorkPart part(interrupter, percent(i), percent(i + 1));
    writeLevel(folder, labels, levels[i], std::to_string(i), zarr, &part);
  }
  folder.commit();
}

OmeVersion omeVersionOf(const std::string& text) {
  if (text == "0.4") return OmeVersion::v04;
  if (text == "0.5") return OmeVersion::v05;
  throw InvalidInput("there is no OME-Zarr " + text + " to write: 0.4 or 0.5");
}

bool isZarrEnding(const std::string& path) {
  return fileEnding(path) == ".zarr";
}

}  // namespace vdb_madf
