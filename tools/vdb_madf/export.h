// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "command.h"
#include "input_options.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/shapes/clumps.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf::tools {

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

/// Says what became of the output, unless the user wants to hear nothing.
void say(const ExportArguments& o, const Common& common, const std::string& text);
/// The factor by which labels are reduced: 1 unless the options ask for a smaller volume.
int reductionOf(const ExportArguments& o, const Int32Grid& labels);
GrainMeshOptions meshOptions(const ExportArguments& o);

// The kinds of export: grains as shapes, the templates of an Int32Grid or of LabelSlabs,
template <typename Labels>
void exportMesh(const ExportArguments& o, const Common& common, const Labels& labels);
template <typename Labels>
void exportPreview(const ExportArguments& o, const Common& common, const Labels& labels);
template <typename Labels>
void exportReduced(const ExportArguments& o, const Common& common, const Labels& labels);
void exportGrainGrids(const ExportArguments& o, const Common& common, const Int32Grid& labels);
void exportSurface(const ExportArguments& o, const Common& common, const Int32Grid& labels);
void exportClumps(const ExportArguments& o, const Common& common, const Int32Grid& labels);
void exportSandAtlas(const ExportArguments& o, const Common& common, const Int32Grid& labels);
void exportHexahedra(const ExportArguments& o, const Common& common, const Int32Grid& labels);

// and labels as volumes and networks.
void exportPalabos(const ExportArguments& o, const Common& common, const Int32Grid& labels);
void exportVti(const ExportArguments& o, const Common& common, const Int32Grid& labels);
template <typename Labels>
void exportMask(const ExportArguments& o, const Common& common, const Labels& labels);
template <typename Labels>
void exportNetwork(const ExportArguments& o, const Common& common, const Labels& labels);
template <typename Labels>
void exportZarr(const ExportArguments& o, const Common& common, const Labels& labels);

}  // namespace vdb_madf::tools
