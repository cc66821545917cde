// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <fmt/core.h>

#include <optional>
#include <type_traits>

#include "export.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/exports/clump_bonds.h"
#include "vdb_madf/exports/clump_file.h"
#include "vdb_madf/exports/clump_folder.h"
#include "vdb_madf/exports/hexahedra_file.h"
#include "vdb_madf/exports/mesh_file.h"
#include "vdb_madf/exports/sand_atlas.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/labels/grain_masks.h"
#include "vdb_madf/labels/label_sizes.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/labels/select_grains.h"
#include "vdb_madf/measure/grain_network.h"
#include "vdb_madf/pictures/preview_volume.h"
#include "vdb_madf/segmentation/ball_grids.h"
#include "vdb_madf/shapes/level_sets.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

namespace {

/// Says how many of the grains have no voxel any more where labels were reduced.
void noteVanished(const ExportArguments& o, const Common& common, size_t grains,
                  const Int32Grid& reduced) {
  const size_t left = labelSizes(reduced, common.progress).size();
  if (left < grains)
    common.progress->note(fmt::format("{}: {} of {} are too small to be seen in reduced labels",
                                      o.out, grains - left, counted(grains, "grain")));
}

/// Labels as they are meshed: those of the chosen grains, reduced.
/// @param grains how many the labels have
template <typename Labels>
Int32Grid::ConstPtr meshedLabels(const ExportArguments& o, const Common& common,
                                 const Labels& labels, int factor, size_t grains) {
  Int32Grid::ConstPtr all;
  if constexpr (std::is_same_v<Labels, Int32Grid>)
    if (factor == 1) all = labels.copy();
  if (!all) all = reduceLabels(labels, factor, common.progress);
  if (factor > 1) noteVanished(o, common, grains, *all);
  return o.grains.empty() ? all : selectGrains(*all, o.grains, common.progress);
}

/// @throw InvalidInput for other voxels, which `what` does not take
void requireCubes(const Int32Grid& labels, const std::string& what) {
  try {
    requireCubicVoxels(labels, what);
  } catch (const InvalidInput& error) {
    throw InvalidInput(error.what() + std::string(" (convert --resample)"));
  }
}

/// The medial balls that were kept with the labels, unless those had other voxels, or grains that
/// were dropped since; else the balls of the labels' voxels, with air beyond the faces.
Int32Grid::Ptr ballsOf(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  if (!o.input.size && isVdb(o.input))
    if (const auto kept = storedBalls(readVdb(o.input.path, {}, common.progress)))
      if (areBallsOfVoxels(labels, *kept) && areBallsOfObject(*kept, labels)) return kept;
  return closedBalls(*objectMask(labels), availableMemory(), common.progress);
}

/// Writes the tables of the bonds and of the cover, if they are asked for.
/// @return the bonds
std::vector<ClumpBond> exportClumpTables(const ExportArguments& o, const Common& common,
                                         const Int32Grid& labels, const std::vector<Clump>& clumps,
                                         const Measurements& measured) {
  if (!o.cover.empty()) writeClumpCover(o.cover, clumps, labels.transform(), common.progress);
  if (o.bonds.empty()) return {};
  const auto bonds = clumpBonds(clumps, measured.bonds, labels.transform());
  writeClumpBonds(o.bonds, bonds, labels.transform(), common.progress);
  return bonds;
}

}  // namespace

GrainMeshOptions meshOptions(const ExportArguments& o) {
  GrainMeshOptions options;
  options.smoothing = o.smoothing;
  options.triangles = uint64_t(o.mostTriangles);
  return options;
}

template <typename Labels>
void exportMesh(const ExportArguments& o, const Common& common, const Labels& labels) {
  const GrainMeshOptions options = meshOptions(o);
  const int factor = reductionOf(o, aboutOf(labels));
  MeshFileOptions file;
  file.colors = grainColors(labels, common.progress);
  const Int32Grid::ConstPtr meshed =
      meshedLabels(o, common, labels, factor, file.colors.labels.size());
  file.transform = transformInUnitOf(aboutOf(labels), *meshed);
  file.lengthUnit = worldUnit(aboutOf(labels));
  file.shadeSmooth = o.smoothing > 0;
  if (isGlb(o.out) && options.triangles == 0)
    checkMeshRoom(o.out, countTriangles(*meshed, common.progress), file);
  const GrainMesh mesh = grainMesh(*meshed, options, common.progress);
  std::optional<GrainNetwork> measured;
  if (isGlb(o.out)) file.measured = &measured.emplace(grainNetwork(labels, {}, common.progress));
  if (isMeshEnding(o.out))
    writeMesh(o.out, mesh, file, common.progress);
  else
    writeStlFolder(o.out, mesh, file, common.progress);
  const bool isOver = options.triangles > 0 && mesh.triangles.size() > options.triangles;
  say(o, common,
      fmt::format("{}, {}, {}{}{}; lengths in {}", counted(mesh.labels.size(), "grain"),
                  counted(mesh.points.size(), "point"), counted(mesh.triangles.size(), "triangle"),
                  isOver ? " (fewer would not keep all grains and contacts)" : "",
                  factor == 1 ? "" : fmt::format(" (labels at 1/{})", factor),
                  file.lengthUnit.empty() ? "voxels" : file.lengthUnit));
}

template <typename Labels>
void exportPreview(const ExportArguments& o, const Common& common, const Labels& labels) {
  const int factor = reductionOf(o, aboutOf(labels));
  const LabelPreview preview = previewLabels(labels, factor, common.progress);
  writeVdb(o.out, {preview.color, preview.density}, common.progress);
  say(o, common,
      fmt::format("density (fog) and color at 1/{}, {}", factor,
                  counted(preview.density->activeVoxelCount(), "voxel")));
}

template <typename Labels>
void exportReduced(const ExportArguments& o, const Common& common, const Labels& labels) {
  const int factor = o.reduce == 0 && o.maxDim == 0 ? 2 : reductionOf(o, aboutOf(labels));
  const Int32Grid::Ptr reduced = reduceLabels(labels, factor, common.progress);
  noteVanished(o, common, labelSizes(labels, common.progress).size(), *reduced);
  writeVdb(o.out, {reduced}, common.progress);
  say(o, common,
      fmt::format("labels at 1/{}, {}", factor, counted(reduced->activeVoxelCount(), "voxel")));
}

void exportGrainGrids(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  if (o.asBool) {
    const auto grids = grainMasks(labels, common.progress);
    writeVdb(o.out, {grids.begin(), grids.end()}, common.progress);
    say(o, common, counted(grids.size(), "Bool grid"));
    return;
  }
  requireCubes(labels, "a level set");
  LevelSetOptions options;
  options.smoothing = o.smoothing;
  const auto grids = grainLevelSets(labels, options, common.progress);
  writeVdb(o.out, {grids.begin(), grids.end()}, common.progress);
  say(o, common, counted(grids.size(), "level set"));
}

void exportSurface(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  requireCubes(labels, "a level set");
  LevelSetOptions options;
  options.smoothing = o.smoothing;
  const auto grid = surfaceLevelSet(labels, options, common.progress);
  writeVdb(o.out, {grid}, common.progress);
  say(o, common,
      "level set of the object, " + counted(grid->activeVoxelCount(), "voxel") + " in its band");
}

void exportClumps(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  const Int32Grid::Ptr balls = ballsOf(o, common, labels);
  const auto made = clumps(labels, *balls, o.clumps, common.progress);
  OutputSet files;
  const bool isFolder = fileEnding(o.out).empty();
  Measurements measured;
  if (isFolder || !o.bonds.empty()) measured = measure(labels, o.measure, common.progress);
  const auto bonds = exportClumpTables(o, common, labels, made, measured);
  if (isFolder)
    writeClumpFolder(o.out, made, measured.grains, labels.transform());
  else
    writeClumps(o.out, made, labels.transform(), bonds, common.progress);
  files.commit();
  std::string text = describeClumps(made, hasCubicVoxels(labels));
  if (!o.bonds.empty()) text += fmt::format("; {} in {}", counted(bonds.size(), "bond"), o.bonds);
  // Distances ignore what may be beyond the faces of an open scan.
  const auto domain = storedDomain(labels);
  if (storedBoundary(*balls) == Boundary::open && !(domain && domain->flatAxis()))
    text += "; balls reach beyond the scan (segment with --boundary closed to prevent that)";
  say(o, common, text);
}

void exportHexahedra(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  const HexahedraCounts counts = writeHexahedra(o.out, labels, common.progress);
  say(o, common,
      fmt::format("{}, {}, {}", counted(counts.grains, "grain"),
                  counted(counts.elements, "element"), counted(counts.nodes, "node")));
}

void exportSandAtlas(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  requireCubes(labels, "the Sand Atlas");
  const SandAtlasCounts counts = writeSandAtlas(o.out, labels, o.smoothing, common.progress);
  say(o, common,
      fmt::format("{}; {} at faces left out", counted(counts.particles, "particle"),
                  counted(counts.atFaces, "grain")));
}

template void exportMesh(const ExportArguments&, const Common&, const Int32Grid&);
template void exportMesh(const ExportArguments&, const Common&, const LabelSlabs&);
template void exportPreview(const ExportArguments&, const Common&, const Int32Grid&);
template void exportPreview(const ExportArguments&, const Common&, const LabelSlabs&);
template void exportReduced(const ExportArguments&, const Common&, const Int32Grid&);
template void exportReduced(const ExportArguments&, const Common&, const LabelSlabs&);

}  // namespace vdb_madf::tools
