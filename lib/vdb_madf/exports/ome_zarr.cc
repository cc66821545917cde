// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/ome_zarr.h"

#include <type_traits>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/detail/grain_table.h"
#include "vdb_madf/exports/detail/neuroglancer_files.h"
#include "vdb_madf/exports/detail/ome_attributes.h"
#include "vdb_madf/exports/detail/ome_levels.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/labels/grain_colors.h"

namespace vdb_madf {

namespace {

using detail::OmeLevel;
using detail::OmePlace;
using detail::WorkPart;
using detail::ZarrVersion;

/// Per cent of the work that measures and colors are.
constexpr int kMeasured = 60;

/// Within a folder, below `group`.
void writeGroups(const OutputTree& folder, const std::string& group, const OmePlace& place,
                 const std::vector<OmeLevel>& levels, const std::string& imageLabel,
                 OmeVersion version, ZarrVersion zarr) {
  std::vector<detail::OmeScale> scales;
  for (const OmeLevel& level : levels) scales.push_back({level.factor, level.box.min()});
  const auto write = [&](const std::string& name,
                         const std::vector<detail::OmeMember>& attributes) {
    detail::writeZarrGroup(folder, group + name, detail::omeAttributes(attributes, version), zarr);
  };
  write("", {{"multiscales", detail::multiscales("object", place, scales, version)}});
  write("labels", {{"labels", "[\"grain\"]"}});
  write(detail::kLabelGroup, {{"multiscales", detail::multiscales("grain", place, scales, version)},
                              {"image-label", imageLabel}});
}

ZarrVersion zarrOf(OmeVersion version) {
  return version == OmeVersion::v04 ? ZarrVersion::two : ZarrVersion::three;
}

/// An image and its labels within a folder.
/// @param path of the folder; group: "", or what the image is called in it, "before/"
template <typename Labels>
void writeGroup(const OutputTree& folder, const std::string& path, const std::string& group,
                const Labels& labels, const OmePlace& place, const CoordBBox& box,
                const OmeZarrOptions& options, Interrupter* interrupter) {
  const ZarrVersion zarr = zarrOf(options.version);
  const std::vector<OmeLevel> levels = detail::omeLevels(box);
  {
    WorkPart part(interrupter, 0, kMeasured);
    const detail::GrainTable table(measure(labels, options.measure, &part));
    const GrainColors colors = grainColors(labels, interrupter);
    writeGroups(folder, group, place, levels, detail::imageLabel(table, colors, options.version),
                options.version, zarr);
    if constexpr (std::is_same_v<Labels, Int32Grid>)
      if (options.meshes)
        detail::writeNeuroglancer(folder, lastPart(path), labels, box, place, table, colors,
                                  options, interrupter);
  }
  WorkPart part(interrupter, kMeasured, 100);
  detail::writeOmeLevels(folder, group, labels, levels, zarr, &part);
}

void checkBox(const CoordBBox& box) {
  if (box.empty()) throw InvalidInput("there is no voxel and no domain: nothing to write");
}

/// @param about the transform and the metadata of the labels
template <typename Labels>
void writeFolder(const std::string& path, const Labels& labels, const Int32Grid& about,
                 const CoordBBox& box, const OmeZarrOptions& options, Interrupter* interrupter) {
  checkBox(box);
  if (!std::is_same_v<Labels, Int32Grid> && options.meshes)
    throw InvalidInput("meshes are made of labels in one piece, not of slabs");
  const OmePlace place = detail::omePlaceOf(about);
  detail::checkNeuroglancer(about, options);
  OutputTree folder(path);
  writeGroup(folder, path, "", labels, place, box, options, interrupter);
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

void writeOmeScene(const std::string& path, const OmeScene& scene, const MeasureOptions& measure,
                   Interrupter* interrupter) {
  OmeZarrOptions options;
  options.version = OmeVersion::v06;
  options.measure = measure;
  const std::array<std::string, 2> names{"before", "after"};
  const std::array<const Int32Grid*, 2> grids{&scene.before, &scene.after};
  const std::array<OmePlace, 2> places{detail::omePlaceOf(scene.before),
                                       detail::omePlaceOf(scene.after)};
  if (places[0].unit != places[1].unit)
    throw InvalidInput(
        "the voxel size of one of the two is not known: a scene needs both, or none");
  for (const Int32Grid* grid : grids) checkBox(boxOf(*grid));
  OutputTree folder(path);
  for (size_t i = 0; i < 2; ++i) {
    WorkPart part(interrupter, int(50 * i), int(50 * i) + 50);
    writeGroup(folder, path, names[i] + "/", *grids[i], places[i], boxOf(*grids[i]), options,
               &part);
  }
  detail::writeZarrGroup(
      folder, "",
      detail::omeAttributes(
          {{"scene", detail::sceneText(names, places, scene.linear, scene.shift)}},
          options.version),
      ZarrVersion::three);
  folder.commit();
}

OmeVersion omeVersionOf(const std::string& text) {
  if (text == "0.4") return OmeVersion::v04;
  if (text == "0.5") return OmeVersion::v05;
  if (text == "0.6") return OmeVersion::v06;
  throw InvalidInput("there is no OME-Zarr " + text + " to write: 0.4, 0.5 or 0.6");
}

bool isZarrEnding(const std::string& path) {
  return fileEnding(path) == ".zarr";
}

}  // namespace vdb_madf
