// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <optional>

#include "bindings.h"
#include "mesh_options.h"
#include "vdb_madf/exports/clump_file.h"
#include "vdb_madf/exports/clump_folder.h"
#include "vdb_madf/exports/hexahedra_file.h"
#include "vdb_madf/exports/mesh_file.h"
#include "vdb_madf/exports/network_file.h"
#include "vdb_madf/exports/ome_zarr.h"
#include "vdb_madf/exports/sand_atlas.h"
#include "vdb_madf/exports/vti_file.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/measure/table_unit.h"
#include "vdb_madf/pictures/label_panels.h"
#include "vdb_madf/pictures/png_file.h"
#include "vdb_madf/pictures/preview_volume.h"
#include "vdb_madf/shapes/level_sets.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "vdb_madf/volumes/image_losses.h"
#include "vdb_madf/volumes/label_type.h"
#include "vdb_madf/volumes/write_image.h"

namespace vdb_madf::python {

namespace {

/// work(interrupter) that returns nothing.
template <typename Work>
void write(const Call& call, const Work& work) {
  withoutLock(call, [&](Interrupter* interrupter) {
    work(interrupter);
    return true;
  });
}

/// Masks as Bool grids, which other programs read.
void saveVdb(const std::string& path, const std::vector<GridPtr>& grids, const Call& call) {
  write(call, [&](Interrupter* interrupter) {
    std::vector<openvdb::GridBase::ConstPtr> written;
    for (const GridPtr& grid : grids) {
      if (grid->isType<MaskGrid>())
        written.push_back(toBoolGrid(asMask(*grid)));
      else
        written.push_back(grid);
    }
    writeVdb(path, written, interrupter);
  });
}

SampleType typeFor(const openvdb::GridBase& grid, const std::string& name, bool asTiff) {
  if (!name.empty()) return sampleTypeOf(name);
  if (grid.isType<MaskGrid>()) return SampleType::uint8;
  return asTiff ? labelType(asLabels(grid)) : SampleType::int32;
}

void saveImage(const std::string& path, const GridPtr& grid, const std::string& type, bool asTiff,
               const Call& call) {
  write(call, [&](Interrupter* interrupter) {
    writeImage(path, *grid, shownBox(*grid), typeFor(*grid, type, asTiff), interrupter);
  });
}

/// What the command notes of such a file.
std::vector<std::string> fileLosses(const std::string& path, const GridPtr& grid,
                                    const std::string& kind) {
  if ((kind == "labels" || kind == "mask") && fileEnding(path) != ".vdb")
    return lossesOf(path, *grid);
  if (kind == "zarr") {
    std::vector<std::string> losses = zarrLossesOf(path, *grid);
    const std::string places = noteOnPlaces(*grid);
    if (!places.empty()) losses.push_back(path + ": " + places);
    return losses;
  }
  const std::string region = kind == "vti" ? lostRegion(path, *grid) : "";
  return region.empty() ? std::vector<std::string>() : std::vector<std::string>{region};
}

void saveMesh(const std::string& path, const GridPtr& whole, const GridPtr& meshed, int smoothing,
              const std::optional<int64_t>& triangles, const Call& call) {
  write(call, [&](Interrupter* interrupter) {
    const GrainMeshOptions shape = meshOptions(smoothing, triangles);
    MeshFileOptions options;
    options.transform = transformInUnitOf(asLabels(*whole), asLabels(*meshed));
    options.lengthUnit = worldUnit(*whole);
    options.shadeSmooth = smoothing > 0;
    if (isGlb(path) && !triangles)
      checkMeshRoom(path, countTriangles(asLabels(*meshed), interrupter), options);
    const GrainMesh mesh = grainMesh(asLabels(*meshed), shape, interrupter);
    std::optional<GrainNetwork> measured;
    if (isGlb(path))
      options.measured = &measured.emplace(grainNetwork(asLabels(*whole), {}, interrupter));
    options.colors = grainColors(asLabels(*whole), interrupter);
    if (isMeshEnding(path))
      writeMesh(path, mesh, options, interrupter);
    else
      writeStlFolder(path, mesh, options, interrupter);
  });
}

void saveVti(const std::string& path, const GridPtr& labels, bool compressed, const Call& call) {
  write(call, [&](Interrupter* interrupter) {
    writeVti(path, asLabels(*labels), shownBox(*labels), compressed, interrupter);
  });
}

void saveNetwork(const std::string& path, const GridPtr& labels, int64_t minFaces,
                 const Call& call) {
  write(call, [&](Interrupter* interrupter) {
    MeasureOptions options;
    options.minFaces = minFaces;
    writeNetwork(path, grainNetwork(asLabels(*labels), options, interrupter), interrupter);
  });
}

void saveZarr(const std::string& path, const GridPtr& labels, const std::string& ome,
              int64_t minFaces, bool meshes, int smoothing, int reduction,
              const std::optional<int64_t>& triangles, const Call& call) {
  write(call, [&](Interrupter* interrupter) {
    OmeZarrOptions options;
    options.version = omeVersionOf(ome);
    options.measure.minFaces = minFaces;
    options.meshes = meshes;
    options.mesh = meshOptions(smoothing, triangles);
    options.meshReduction = reduction;
    writeOmeZarr(path, asLabels(*labels), shownBox(*labels), options, interrupter);
  });
}

void saveSandAtlas(const std::string& path, const GridPtr& labels, int smoothing,
                   const Call& call) {
  write(call, [&](Interrupter* interrupter) {
    writeSandAtlas(path, asLabels(*labels), smoothing, interrupter);
  });
}

/// @return a note, if grains are left out
std::vector<std::string> saveClumps(const std::string& path, const GridPtr& labels,
                                    const GridPtr& balls, int mostBalls, double uncovered,
                                    bool apart, const Call& call) {
  return withoutLock(call, [&](Interrupter* interrupter) {
    const auto made =
        clumps(asLabels(*labels), asLabels(*balls), {mostBalls, uncovered, apart}, interrupter);
    if (fileEnding(path).empty())
      writeClumpFolder(path, made, measure(asLabels(*labels), {}, interrupter).grains,
                       labels->transform());
    else
      writeClumps(path, made, labels->transform(), {}, interrupter);
    std::vector<std::string> notes;
    if (std::any_of(made.begin(), made.end(), [](const Clump& c) { return c.balls.empty(); }))
      notes.push_back(path + ": " + describeClumps(made, hasCubicVoxels(*labels)));
    return notes;
  });
}

void saveHexahedra(const std::string& path, const GridPtr& labels, const Call& call) {
  write(call,
        [&](Interrupter* interrupter) { writeHexahedra(path, asLabels(*labels), interrupter); });
}

void savePreview(const std::string& path, const GridPtr& labels, int factor, const Call& call) {
  write(call, [&](Interrupter* interrupter) {
    const LabelPreview preview = previewLabels(asLabels(*labels), factor, interrupter);
    writeVdb(path, {preview.color, preview.density}, interrupter);
  });
}

void saveLevelSets(const std::string& path, const GridPtr& labels, int smoothing, bool asOne,
                   const Call& call) {
  write(call, [&](Interrupter* interrupter) {
    LevelSetOptions options;
    options.smoothing = smoothing;
    if (asOne) {
      writeVdb(path, {surfaceLevelSet(asLabels(*labels), options, interrupter)}, interrupter);
    } else {
      const auto grids = grainLevelSets(asLabels(*labels), options, interrupter);
      writeVdb(path, {grids.begin(), grids.end()}, interrupter);
    }
  });
}

/// The sheet of `vdb_madf render`.
void savePicture(const std::string& path, const GridPtr& grid, int size, double azimuth,
                 double elevation, const Call& call) {
  write(call, [&](Interrupter* interrupter) {
    const Int32Grid& labels = asLabels(*grid);
    const CoordBBox box = shownBox(labels);
    if (box.empty()) throw InvalidInput("there are no labels and no domain: nothing to show");
    PanelOptions options;
    options.edge = size;
    options.direction.azimuth = azimuth;
    options.direction.elevation = elevation;
    writePng(path,
             pictureSheet(labelPanels(labels, box, options, interrupter), storedVoxelSize(labels)));
  });
}

}  // namespace

void bindFiles(py::module_& m) {
  const auto path = py::arg("path"), labels = py::arg("labels"), call = py::arg("call");
  m.def("save_vdb", saveVdb, path, py::arg("grids"), call);
  m.def("save_image", saveImage, path, py::arg("grid"), py::arg("type"), py::arg("as_tiff"), call);
  m.def("file_losses", fileLosses, path, py::arg("grid"), py::arg("kind"));
  m.def("save_mesh", saveMesh, path, py::arg("whole"), py::arg("meshed"), py::arg("smoothing"),
        py::arg("triangles"), call);
  m.def("save_vti", saveVti, path, labels, py::arg("compressed"), call);
  m.def("save_network", saveNetwork, path, labels, py::arg("min_faces"), call);
  m.def("save_zarr", saveZarr, path, labels, py::arg("ome"), py::arg("min_faces"),
        py::arg("meshes"), py::arg("smoothing"), py::arg("reduction"), py::arg("triangles"), call);
  m.def("save_sand_atlas", saveSandAtlas, path, labels, py::arg("smoothing"), call);
  m.def("save_clumps", saveClumps, path, labels, py::arg("balls"), py::arg("max_balls"),
        py::arg("uncovered"), py::arg("apart"), call);
  m.def("save_hexahedra", saveHexahedra, path, labels, call);
  m.def("save_preview", savePreview, path, labels, py::arg("factor"), call);
  m.def("save_level_sets", saveLevelSets, path, labels, py::arg("smoothing"), py::arg("as_one"),
        call);
  m.def("save_picture", savePicture, path, labels, py::arg("size"), py::arg("azimuth"),
        py::arg("elevation"), call);
}

}  // namespace vdb_madf::python
