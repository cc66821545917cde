// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "export.h"

#include <algorithm>
#include <iostream>
#include <memory>

#include "outputs.h"
#include "parse.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/word_list.h"
#include "vdb_madf/exports/clump_file.h"
#include "vdb_madf/exports/hexahedra_file.h"
#include "vdb_madf/exports/mesh_file.h"
#include "vdb_madf/exports/network_file.h"
#include "vdb_madf/exports/ome_zarr.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/output_folder.h"
#include "vdb_madf/files/output_tree.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/labels/reduced_labels.h"

namespace vdb_madf::tools {

namespace {

/// The kind that the output's ending leaves no doubt about; else empty.
std::string kindOf(const std::string& out) {
  const std::string ending = fileEnding(out);
  if (ending == ".vti") return "vti";
  if (ending == ".graphml") return "network";
  if (isZarrEnding(out)) return "zarr";
  if (isHexahedraEnding(out)) return "hexa";
  return isMeshEnding(out) && ending != ".vtp" ? "mesh" : "";
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

bool isPalabosOutput(const std::string& out) {
  return fileEnding(out) == ".dat";
}

bool isFolder(const std::string& out) {
  return fileEnding(out).empty();
}

bool isClumpOutput(const std::string& out) {
  return isClumpEnding(out) || isFolder(out);
}

bool isVtiOutput(const std::string& out) {
  return fileEnding(out) == ".vti";
}

const ExportKind kExportKinds[] = {
    {"mesh", exportMesh, ".ply, .obj, .stl, .glb or .vtp, or a folder name without an ending (STL)",
     isMeshOutput, exportMesh},
    {"viz", exportPreview, ".vdb", hasVdbEnding, exportPreview},
    {"lod", exportReduced, ".vdb", hasVdbEnding, exportReduced},
    {"grids", exportGrainGrids, ".vdb", hasVdbEnding},
    {"surface", exportSurface, ".vdb", hasVdbEnding},
    {"vti", exportVti, ".vti", isVtiOutput},
    {"clumps", exportClumps, ".csv, .txt (YADE) or .data (LAMMPS), or none: a folder (MercuryDPM)",
     isClumpOutput},
    {"hexa", exportHexahedra, ".vtu or .inp (Abaqus)", isHexahedraEnding},
    {"mask", exportMask, wordList(writtenEndings()), isImageEnding, exportMask},
    {"palabos", exportPalabos, ".dat", isPalabosOutput},
    {"network", exportNetwork, ".vtp, .graphml, .csv or .txt (MUSEN)", isNetworkEnding,
     exportNetwork},
    {"zarr", exportZarr, ".zarr, a folder (.ome.zarr)", isZarrEnding, exportZarr},
    {"sandatlas", exportSandAtlas, "none: a folder", isFolder},
};

std::vector<std::string> kindList() {
  std::vector<std::string> names;
  for (const ExportKind& kind : kExportKinds) names.push_back(kind.name);
  return names;
}

std::string kindNames() {
  return wordList(kindList(), ", ");
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

void checkTables(const ExportArguments& o) {
  for (const auto& [option, file] : {std::pair("--bonds", &o.bonds), {"--cover", &o.cover}}) {
    if (!file->empty() && fileEnding(*file) != ".csv")
      throw WrongUsage(*file + ": the ending for " + option + " must be .csv");
  }
}

/// @throw WrongUsage for options that this kind has no use for
void checkOptions(const ExportArguments& o, const std::string& kind) {
  const ExportArguments usual;
  const bool reduces = o.reduce > 0 || o.maxDim > 0;
  const struct {
    const char* option;
    bool isGiven;
    std::vector<std::string> kinds;
  } options[] = {
      {"--smooth",
       o.smoothing != usual.smoothing,
       {"mesh", "grids", "surface", "zarr", "sandatlas"}},
      {o.maxDim > 0 ? "--max-dim" : "--reduce", reduces, {"mesh", "viz", "lod", "zarr"}},
      {"--triangles", o.mostTriangles > 0, {"mesh", "zarr"}},
      {"--select", !o.select.empty(), {"mesh"}},
      {"--compress", o.compress, {"vti"}},
      {"--bool", o.asBool, {"grids"}},
      {"--balls", o.clumps.mostBalls != usual.clumps.mostBalls, {"clumps"}},
      {"--uncovered", o.clumps.coverageError != usual.clumps.coverageError, {"clumps"}},
      {"--apart", o.clumps.apart, {"clumps"}},
      {"--bonds", !o.bonds.empty(), {"clumps"}},
      {"--cover", !o.cover.empty(), {"clumps"}},
      {"--min-faces", o.minFaces != usual.minFaces, {"network", "zarr"}},
      {"--ome", o.ome != usual.ome, {"zarr"}},
      {"--meshes", o.meshes, {"zarr"}},
  };
  for (const auto& [option, isGiven, kinds] : options)
    if (isGiven && std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      throw WrongUsage(std::string(option) + " is for --as " + wordList(kinds, ", ") + ", not " +
                       kind);
  if (o.asBool && o.smoothing != usual.smoothing)
    throw WrongUsage("--smooth is of level sets, and --bool writes masks: give one of them");
  const bool ofMeshes = o.smoothing != usual.smoothing || reduces || o.mostTriangles > 0;
  if (kind == "zarr" && ofMeshes && !o.meshes)
    throw WrongUsage(
        "--smooth, --reduce, --max-dim and --triangles are of the meshes of a .zarr: give "
        "--meshes, too");
}

void runExport(const ExportArguments& o, const Common& common, const ExportKind& kind) {
  if (isFolder(o.out) && kind.run == exportMesh<Int32Grid>)
    checkOutputFolder(o.out);
  else if (isFolder(o.out) || isZarrEnding(o.out))
    checkOutputTree(o.out);
  else
    checkWritable(o.out);
  for (const std::string& file : {o.bonds, o.cover})
    if (!file.empty()) checkWritable(file);
  // Meshes of all voxels need the labels in memory together.
  const bool isOfAll =
      o.meshes || (kind.run == exportMesh<Int32Grid> && o.reduce <= 1 && o.maxDim == 0);
  if (kind.runSlabs && !isOfAll)
    if (const auto labels = openBoxSlabs(o.input, "--grid", common.progress))
      return withFileName(o.input.path, [&] { kind.runSlabs(o, common, *labels); });
  const Int32Grid::Ptr labels = loadLabels(o.input, "--grid", common.progress);
  withFileName(o.input.path, [&] { kind.run(o, common, *labels); });
}

}  // namespace

void say(const ExportArguments& o, const Common& common, const std::string& text) {
  common.progress->end();
  if (!common.quiet) std::cout << o.out << ": " << text << "\n";
}

int reductionOf(const ExportArguments& o, const Int32Grid& labels) {
  if (o.reduce > 0) return o.reduce;
  if (o.maxDim == 0) return 1;
  return reductionFor(boxOf(labels), o.maxDim);
}

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
              "mesh, grids, surface, zarr, sandatlas: rounds of smoothing; 0: the exact faces of "
              "voxels")
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
  verb.option("--ome", o->ome, "zarr: version of OME-Zarr, 0.4 (Zarr 2), 0.5 or 0.6 (Zarr 3)")
      .typeName("VERSION")
      .oneOf({"0.4", "0.5", "0.6"})
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
    checkOptions(*o, kind.name);
    checkTables(*o);
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
