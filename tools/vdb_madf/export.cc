// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

#include "command.h"
#include "grid_image.h"
#include "input_options.h"
#include "outputs.h"
#include "parse.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/base/word_list.h"
#include "vdb_madf/exports/clump_bonds.h"
#include "vdb_madf/exports/clump_file.h"
#include "vdb_madf/exports/hexahedra_file.h"
#include "vdb_madf/exports/mesh_file.h"
#include "vdb_madf/exports/network_file.h"
#include "vdb_madf/exports/ome_zarr.h"
#include "vdb_madf/exports/vti_file.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/files/output_folder.h"
#include "vdb_madf/files/output_tree.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/labels/grain_masks.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/labels/select_grains.h"
#include "vdb_madf/measure/grain_network.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/pictures/preview_volume.h"
#include "vdb_madf/segmentation/ball_grids.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"
#include "vdb_madf/shapes/clumps.h"
#include "vdb_madf/shapes/level_sets.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "vdb_madf/volumes/write_image.h"

namespace vdb_madf::tools {

namespace {

struct ExportArguments {
  InputOptions input;
  std::string out, kind, minFaces = "1";
  std::string bonds, cover;  ///< of clumps; empty: not written
  std::string ome = "0.4";
  int smoothing = 10, maxDim = 0, reduce = 0;
  int64_t mostTriangles = 0;  ///< 0: any number
  std::string select;
  std::vector<int32_t> grains;  ///< of meshes; empty: all
  bool compress = false, asBool = false, meshes = false;
  ClumpOptions clumps;
  MeasureOptions measure;
};

/// The kind that the output's ending leaves no doubt about; else empty.
std::string kindOf(const std::string& out) {
  const std::string ending = fileEnding(out);
  if (ending == ".vti") return "vti";
  if (ending == ".graphml") return "network";
  if (isZarrEnding(out)) return "zarr";
  if (isHexahedraEnding(out)) return "hexa";
  return isMeshEnding(out) && ending != ".vtp" ? "mesh" : "";
}

std::string unitOf(const openvdb::GridBase& grid) {
  const auto size = storedVoxelSize(grid);
  return size ? size->unit() : std::string();
}

void say(const ExportArguments& o, const Common& common, const std::string& text) {
  common.progress->end();
  if (!common.quiet) std::cout << o.out << ": " << text << "\n";
}

/// 1 unless the options ask for a smaller volume.
int reductionOf(const ExportArguments& o, const Int32Grid& labels) {
  if (o.reduce > 0) return o.reduce;
  if (o.maxDim == 0) return 1;
  return reductionFor(boxOf(labels), o.maxDim);
}

GrainMeshOptions meshOptions(const ExportArguments& o) {
  GrainMeshOptions options;
  options.smoothing = o.smoothing;
  options.triangles = uint64_t(o.mostTriangles);
  return options;
}

/// Labels as they are meshed: those of the chosen grains, reduced.
Int32Grid::ConstPtr meshedLabels(const ExportArguments& o, const Common& common,
                                 const Int32Grid& labels, int factor) {
  const Int32Grid::ConstPtr all =
      factor == 1 ? labels.copy() : reduceLabels(labels, factor, common.progress);
  return o.grains.empty() ? all : selectGrains(*all, o.grains, common.progress);
}

void exportMesh(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  const GrainMeshOptions options = meshOptions(o);
  const int factor = reductionOf(o, labels);
  const Int32Grid::ConstPtr meshed = meshedLabels(o, common, labels, factor);
  MeshFileOptions file;
  file.transform = meshed->constTransformPtr();
  file.lengthUnit = unitOf(labels);
  file.shadeSmooth = o.smoothing > 0;
  if (isGlb(o.out) && options.triangles == 0)
    checkMeshRoom(o.out, countTriangles(*meshed, common.progress), file);
  const GrainMesh mesh = grainMesh(*meshed, options, common.progress);
  file.colors = grainColors(labels, common.progress);
  std::optional<GrainNetwork> measured;
  if (isGlb(o.out)) file.measured = &measured.emplace(grainNetwork(labels, {}, common.progress));
  if (isMeshEnding(o.out))
    writeMesh(o.out, mesh, file, common.progress);
  else
    writeStlFolder(o.out, mesh, file, common.progress);
  const bool isOver = options.triangles > 0 && mesh.triangles.size() > options.triangles;
  say(o, common,
      counted(mesh.labels.size(), "grain") + ", " + counted(mesh.points.size(), "point") + ", " +
          counted(mesh.triangles.size(), "triangle") +
          (isOver ? " (fewer would not keep all grains and contacts)" : "") +
          (factor == 1 ? "" : " (labels at 1/" + std::to_string(factor) + ")") + "; lengths in " +
          (file.lengthUnit.empty() ? "voxels" : file.lengthUnit));
}

void exportPreview(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  const int factor = reductionOf(o, labels);
  const LabelPreview preview = previewLabels(labels, factor, common.progress);
  writeVdb(o.out, {preview.color, preview.density}, common.progress);
  say(o, common,
      "density (fog) and color at 1/" + std::to_string(factor) + ", " +
          counted(preview.density->activeVoxelCount(), "voxel"));
}

void exportReduced(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  const int factor = o.reduce == 0 && o.maxDim == 0 ? 2 : reductionOf(o, labels);
  const Int32Grid::Ptr reduced = reduceLabels(labels, factor, common.progress);
  writeVdb(o.out, {reduced}, common.progress);
  say(o, common,
      "labels at 1/" + std::to_string(factor) + ", " +
          counted(reduced->activeVoxelCount(), "voxel"));
}

void exportVti(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  const CoordBBox box = boxOf(labels);
  writeVti(o.out, labels, box, o.compress, common.progress);
  const Coord size = box.dim();
  say(o, common,
      "cell data grain_id, " + std::to_string(size.x()) + "x" + std::to_string(size.y()) + "x" +
          std::to_string(size.z()) + " voxels");
}

/// Has the transform and the metadata of labels.
const Int32Grid& aboutOf(const Int32Grid& labels) {
  return labels;
}
const Int32Grid& aboutOf(const LabelSlabs& labels) {
  return *labels.about;
}

template <typename Labels>
void exportNetwork(const ExportArguments& o, const Common& common, const Labels& labels) {
  const GrainNetwork network = grainNetwork(labels, o.measure, common.progress);
  writeNetwork(o.out, network, common.progress);
  say(o, common,
      counted(network.grains.size(), "grain") + ", " + counted(network.bonds.size(), "bond") +
          (o.measure.minFaces > 1
               ? " (" + counted(network.contactsLeftOut, "contact") + " of fewer than " +
                     std::to_string(o.measure.minFaces) + " faces left out)"
               : ""));
}

/// @throw InvalidInput for voxels that level sets do not take
void requireCubes(const Int32Grid& labels) {
  try {
    requireCubicVoxels(labels, "a level set");
  } catch (const InvalidInput& error) {
    throw InvalidInput(error.what() + std::string(" (convert --resample)"));
  }
}

void exportGrainGrids(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  if (o.asBool) {
    const auto grids = grainMasks(labels, common.progress);
    writeVdb(o.out, {grids.begin(), grids.end()}, common.progress);
    say(o, common, counted(grids.size(), "Bool grid"));
    return;
  }
  requireCubes(labels);
  LevelSetOptions options;
  options.smoothing = o.smoothing;
  const auto grids = grainLevelSets(labels, options, common.progress);
  writeVdb(o.out, {grids.begin(), grids.end()}, common.progress);
  say(o, common, counted(grids.size(), "level set"));
}

void exportSurface(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  requireCubes(labels);
  LevelSetOptions options;
  options.smoothing = o.smoothing;
  const auto grid = surfaceLevelSet(labels, options, common.progress);
  writeVdb(o.out, {grid}, common.progress);
  say(o, common,
      "level set of the object, " + counted(grid->activeVoxelCount(), "voxel") + " in its band");
}

struct ExportKind {
  const char* name;
  void (*run)(const ExportArguments&, const Common&, const Int32Grid&);
  std::string endings;  ///< in words
  bool (*accepts)(const std::string& out);
  /// Of labels that need not fit in memory together; null: not known.
  void (*runSlabs)(const ExportArguments&, const Common&, const LabelSlabs&) = nullptr;
};

bool isMeshOutput(const std::string& out) {
  return isMeshEnding(out) || fileEnding(out).empty();
}

/// The medial balls that were kept with the labels, unless those had other voxels; else the balls of
/// the labels' voxels, with air beyond the faces.
Int32Grid::Ptr ballsOf(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  if (!o.input.size && isVdb(o.input))
    if (const auto kept = storedBalls(readVdb(o.input.path, {}, common.progress)))
      if (areBallsOfVoxels(labels, *kept)) return kept;
  return closedBalls(*objectMask(labels), availableMemory(), common.progress);
}

/// Writes the tables of the bonds and of the cover, if they are asked for.
/// @return the bonds
std::vector<ClumpBond> exportClumpTables(const ExportArguments& o, const Common& common,
                                         const Int32Grid& labels,
                                         const std::vector<Clump>& clumps) {
  if (!o.cover.empty()) writeClumpCover(o.cover, clumps, labels.transform(), common.progress);
  if (o.bonds.empty()) return {};
  const auto bonds =
      clumpBonds(clumps, measure(labels, o.measure, common.progress).bonds, labels.transform());
  writeClumpBonds(o.bonds, bonds, labels.transform(), common.progress);
  return bonds;
}

void exportClumps(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  const Int32Grid::Ptr balls = ballsOf(o, common, labels);
  const auto made = clumps(labels, *balls, o.clumps, common.progress);
  const auto bonds = exportClumpTables(o, common, labels, made);
  writeClumps(o.out, made, labels.transform(), bonds, common.progress);
  size_t ballCount = 0, without = 0;
  int64_t voxels = 0, uncovered = 0, outside = 0;
  double farthest = 0;
  for (const Clump& clump : made) {
    ballCount += clump.balls.size();
    without += clump.balls.empty();
    voxels += clump.voxels;
    uncovered += clump.uncovered;
    outside += clump.outside;
    farthest = std::max(farthest, clump.farthest);
  }
  const auto percent = [&](int64_t part) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f %%", voxels ? 100.0 * double(part) / double(voxels) : 0);
    return std::string(text);
  };
  char distance[32];
  std::snprintf(distance, sizeof distance, "%.2f", farthest);
  say(o, common,
      counted(made.size(), "grain") + ", " + counted(ballCount, "ball") + "; uncovered " +
          percent(uncovered) + ", outside the own grain " + percent(outside) + ", volume error " +
          percent(outside - uncovered) + ", farthest voxel " + distance +
          (hasCubicVoxels(labels) ? " voxels" : " shortest edges") + " from its balls" +
          (without ? "; " + counted(without, "grain") + " without a ball" : "") +
          (o.bonds.empty() ? "" : "; " + counted(bonds.size(), "bond") + " in " + o.bonds) +
          // Distances ignore what may be beyond the faces of an open scan.
          (storedBoundary(*balls) == Boundary::open
               ? "; balls reach beyond the scan (segment with --boundary closed to prevent that)"
               : ""));
}

void exportHexahedra(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  const HexahedraCounts counts = writeHexahedra(o.out, labels, common.progress);
  say(o, common,
      counted(counts.grains, "grain") + ", " + counted(counts.elements, "element") + ", " +
          counted(counts.nodes, "node"));
}

template <typename Labels>
void exportZarr(const ExportArguments& o, const Common& common, const Labels& labels) {
  const CoordBBox box = boxOf(aboutOf(labels));
  OmeZarrOptions options;
  options.version = omeVersionOf(o.ome);
  options.measure = o.measure;
  options.meshes = o.meshes;
  options.mesh = meshOptions(o);
  options.meshReduction = reductionOf(o, aboutOf(labels));
  writeOmeZarr(o.out, labels, box, options, common.progress);
  const Coord size = box.dim();
  say(o, common,
      "OME-Zarr " + o.ome + ", the object and labels/grain, " + std::to_string(size.x()) + "x" +
          std::to_string(size.y()) + "x" + std::to_string(size.z()) + " voxels" +
          (o.meshes ? "; meshes and measures for neuroglancer" : ""));
}

void writeMask(const ExportArguments& o, const CoordBBox& box, const Int32Grid& labels,
               Progress* progress) {
  writeImage(o.out, *objectMask(labels), box, SampleType::uint8, progress);
}

void writeMask(const ExportArguments& o, const CoordBBox& box, const LabelSlabs& labels,
               Progress* progress) {
  LabelSlabs ones = labels;
  ones.read = [&labels](size_t slab, Interrupter* interrupter) {
    const MaskGrid::Ptr object = objectMask(*labels.read(slab, interrupter));
    return Int32Grid::create(
        std::make_shared<Int32Tree>(object->tree(), 0, 1, openvdb::TopologyCopy()));
  };
  writeImage(o.out, ones, box, SampleType::uint8, progress);
}

template <typename Labels>
void exportMask(const ExportArguments& o, const Common& common, const Labels& labels) {
  const Int32Grid& about = aboutOf(labels);
  const CoordBBox box = boxOf(about);
  writeMask(o, box, labels, common.progress);
  noteLostEdges(o.out, hasCubicVoxels(about), storedVoxelSize(about), common);
  const Coord size = box.dim();
  say(o, common,
      "1 = grain, 0 = background, " + std::to_string(size.x()) + "x" + std::to_string(size.y()) +
          "x" + std::to_string(size.z()) + " voxels of type uint8, x fastest");
}

bool isVtiOutput(const std::string& out) {
  return fileEnding(out) == ".vti";
}

const ExportKind kExportKinds[] = {
    {"mesh", exportMesh, ".ply, .obj, .stl, .glb or .vtp, or a folder name without an ending (STL)",
     isMeshOutput},
    {"viz", exportPreview, ".vdb", hasVdbEnding},
    {"lod", exportReduced, ".vdb", hasVdbEnding},
    {"grids", exportGrainGrids, ".vdb", hasVdbEnding},
    {"surface", exportSurface, ".vdb", hasVdbEnding},
    {"vti", exportVti, ".vti", isVtiOutput},
    {"clumps", exportClumps, ".csv, .txt (YADE) or .data (LAMMPS)", isClumpEnding},
    {"hexa", exportHexahedra, ".vtu or .inp (Abaqus)", isHexahedraEnding},
    {"mask", exportMask, wordList(writtenEndings()), isImageEnding, exportMask},
    {"network", exportNetwork, ".vtp, .graphml or .csv", isNetworkEnding, exportNetwork},
    {"zarr", exportZarr, ".zarr, a folder (.ome.zarr)", isZarrEnding, exportZarr},
};

std::vector<std::string> kindList() {
  std::vector<std::string> names;
  for (const ExportKind& kind : kExportKinds) names.push_back(kind.name);
  return names;
}

std::string kindNames() {
  std::string names;
  for (const std::string& name : kindList()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

const ExportKind& findKind(const ExportArguments& o) {
  const std::string wanted = o.kind.empty() ? kindOf(o.out) : o.kind;
  if (wanted.empty()) throw WrongUsage(o.out + ": say what to write with --as: " + kindNames());
  for (const ExportKind& kind : kExportKinds) {
    if (wanted != kind.name) continue;
    if (!kind.accepts(o.out))
      throw WrongUsage(o.out + ": the ending for --as " + wanted + " must be " + kind.endings);
    return kind;
  }
  throw WrongUsage("--as " + wanted + ": must be one of " + kindNames());
}

/// @throw WrongUsage for tables that would not be written
void checkTables(const ExportArguments& o, const ExportKind& kind) {
  for (const auto& [option, file] : {std::pair("--bonds", &o.bonds), {"--cover", &o.cover}}) {
    if (file->empty()) continue;
    if (kind.run != exportClumps)
      throw WrongUsage(std::string(option) + " is a table of --as clumps");
    if (fileEnding(*file) != ".csv")
      throw WrongUsage(*file + ": the ending for " + option + " must be .csv");
  }
}

void runExport(const ExportArguments& o, const Common& common, const ExportKind& kind) {
  if (fileEnding(o.out).empty())
    checkOutputFolder(o.out);
  else if (kind.run == exportZarr<Int32Grid>)
    checkOutputTree(o.out);
  else
    checkWritable(o.out);
  for (const std::string& file : {o.bonds, o.cover})
    if (!file.empty()) checkWritable(file);
  if (kind.runSlabs && isInSlabs(o.input) && !o.meshes) {
    const LabelSlabs labels = openLabelSlabs(o.input, "--grid", common.progress);
    const auto domain = storedDomain(*labels.about);
    if (domain && domain->isBox())
      return withFileName(o.input.path, [&] { kind.runSlabs(o, common, labels); });
  }
  const Int32Grid::Ptr labels = loadLabels(o.input, "--grid", common.progress);
  withFileName(o.input.path, [&] { kind.run(o, common, *labels); });
}

}  // namespace

void addExport(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<ExportArguments>();
  Verb verb = addVerb(command, common, "export", "labels for other programs",
                      "vdb_madf export grains.vdb grains.ply\n"
                      "  vdb_madf export grains.vdb view.vdb --as viz --max-dim 512");
  verb.option("LABELS", o->input.path, "labels: VDB or integer image").required();
  verb.option("OUT", o->out, "what is written").required();
  verb.option("--as", o->kind, kindNames() + "; default: by the ending, where that is clear")
      .typeName("KIND")
      .offer(kindList());
  verb.option("--grid", o->input.gridName, "VDB input: the grid to take").typeName("NAME");
  verb.option("--smooth", o->smoothing,
              "mesh, grids, surface, zarr: rounds of smoothing; 0: the exact "
              "faces of the voxels")
      .range(0, 1000)
      .showDefault();
  Option maxDim =
      verb.option("--max-dim", o->maxDim,
                  "mesh, viz, lod, zarr (its meshes): reduce until no axis has more voxels");
  maxDim.range(1, kMaxImageSide);
  verb.option("--reduce", o->reduce,
              "mesh, viz, lod, zarr (its meshes): voxels per coarse voxel along an axis")
      .range(1, kMaxReduction)
      .excludes(maxDim);
  verb.option("--triangles", o->mostTriangles,
              "mesh, zarr (its meshes): simplify to so many triangles of all grains together")
      .range(int64_t(1), int64_t(0xffffffff));
  verb.option("--select", o->select, "mesh: these grains alone").typeName("A,B,...");
  verb.flag("--compress", o->compress, "vti: with zlib");
  verb.flag("--bool", o->asBool, "grids: the voxels as Bool grids, not level sets");
  verb.option("--balls", o->clumps.mostBalls, "clumps: most balls per grain")
      .range(1, 1000000)
      .showDefault();
  verb.option("--uncovered", o->clumps.coverageError,
              "clumps: part of a grain that may stay uncovered, 0 to 1")
      .showDefault();
  verb.option("--min-faces", o->minFaces, "network, zarr: fewest voxel faces of a bond")
      .typeName("N")
      .showDefault();
  verb.flag(
      "--apart", o->clumps.apart,
      "clumps: balls of different grains do not overlap, so that a simulation starts at rest");
  verb.option("--bonds", o->bonds, "clumps: also a table of the bonds between them")
      .typeName("FILE.csv");
  verb.option("--cover", o->cover, "clumps: also a table of how well each grain is covered")
      .typeName("FILE.csv");
  verb.option("--ome", o->ome, "zarr: version of OME-Zarr, 0.4 (Zarr 2) or 0.5 (Zarr 3)")
      .typeName("VERSION")
      .oneOf({"0.4", "0.5"})
      .showDefault();
  verb.flag("--meshes", o->meshes, "zarr: also meshes and measures for neuroglancer");
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  verb.onParsed([o, &common, &action] {
    if (!(o->clumps.coverageError >= 0 && o->clumps.coverageError <= 1))
      throw WrongUsage("--uncovered: must lie between 0 and 1");
    o->measure.minFaces = parseCount(o->minFaces, "--min-faces");
    const ExportKind& kind = findKind(*o);
    o->grains = parseGrains(o->select, "--select");
    if (!o->grains.empty() && kind.run != exportMesh)
      throw WrongUsage("--select chooses the grains of --as mesh");
    checkTables(*o, kind);
    o->input.outputs = {o->out, o->bonds, o->cover};
    o->input.parse();
    if (o->out == "-")
      throw WrongUsage("OUT: standard output takes raw:-, npy:-, nrrd:- and csv:-");
    action = [o, &common, &kind] {
      Common quiet = common;
      for (const std::string& output : o->input.outputs) quiet = besideOutput(quiet, output);
      runExport(*o, quiet, kind);
    };
  });
}

}  // namespace vdb_madf::tools
