// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/ome_zarr.h"

#include <filesystem>
#include <type_traits>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/detail/grain_table.h"
#include "vdb_madf/exports/detail/neuroglancer_files.h"
#include "vdb_madf/exports/detail/ome_attributes.h"
#include "vdb_madf/exports/detail/ome_levels.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/labels/grain_colors.h"

namespace vdb_madf {

namespace {

using detail::OmeLevel;
using detail::OmePlace;
using detail::WorkPart;
using detail::ZarrVersion;

/// Per cent of the work that measures and colors are.
constexpr int kMeasured = 60;

void writeGroups(const OutputTree& folder, const OmePlace& place,
                 const std::vector<OmeLevel>& levels, const std::string& imageLabel,
                 OmeVersion version, ZarrVersion zarr) {
  std::vector<detail::OmeScale> scales;
  for (const OmeLevel& level : levels) scales.push_back({level.factor, level.box.min()});
  const auto write = [&](const std::string& name,
                         const std::vector<detail::OmeMember>& attributes) {
    detail::writeZarrGroup(folder, name, detail::omeAttributes(attributes, version), zarr);
  };
  write("", {{"multiscales", detail::multiscales("object", place, scales, version)}});
  write("labels", {{"labels", "[\"grain\"]"}});
  write(detail::kLabelGroup, {{"multiscales", detail::multiscales("grain", place, scales, version)},
                              {"image-label", imageLabel}});
}

/// The last part of a path, with or without a slash behind it.
std::string nameOf(const std::string& path) {
  const std::filesystem::path name(path);
  return (name.has_filename() ? name : name.parent_path()).filename().string();
}

/// @param about the transform and the metadata of the labels
template <typename Labels>
void writeFolder(const std::string& path, const Labels& labels, const Int32Grid& about,
                 const CoordBBox& box, const OmeZarrOptions& options, Interrupter* interrupter) {
  if (box.empty()) throw InvalidInput("there is no voxel and no domain: nothing to write");
  constexpr bool kInOnePiece = std::is_same_v<Labels, Int32Grid>;
  if (!kInOnePiece && options.meshes)
    throw InvalidInput("meshes are made of labels in one piece, not of slabs");
  const OmePlace place = detail::omePlaceOf(about);
  const ZarrVersion zarr =
      options.version == OmeVersion::v05 ? ZarrVersion::three : ZarrVersion::two;
  const std::vector<OmeLevel> levels = detail::omeLevels(box);
  detail::checkNeuroglancer(about, options);
  OutputTree folder(path);
  {
    WorkPart part(interrupter, 0, kMeasured);
    const detail::GrainTable table(measure(labels, options.measure, &part));
    const GrainColors colors = grainColors(labels, interrupter);
    writeGroups(folder, place, levels, detail::imageLabel(table, colors, options.version),
                options.version, zarr);
    if constexpr (kInOnePiece)
      if (options.meshes)
        detail::writeNeuroglancer(folder, nameOf(path), labels, box, place, table, colors, options,
                                  interrupter);
  }
  WorkPart part(interrupter, kMeasured, 100);
  detail::writeOmeLevels(folder, labels, levels, zarr, &part);
  folder.commit();
}

}  // namespace

void writeOmeZarr(const std::string& path, const Int32Grid& labels, const CoordBBox& box,
                  const OmeZarrOptions& options, Interrupter* interrupter) {
  writeFolder(path, labels, labels, box, options, interrupter);
}

void writeOmeZarr(const std::string& path, const LabelSlabs& labels, const CoordBBox& box,
                  const OmeZarrOptions& options, Interrupter* interrupter) {
  writeFolder(path, labels, *labels.about, box, options, interrupter);
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
