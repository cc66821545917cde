// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/intensity/gray_scan.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

/// What a page says of a sample, and how fine its view is.
struct ReportOptions {
  std::string title;   ///< of the page; empty: the name of the labels' file
  std::string labels;  ///< where they are, such as the path of their file; empty: not said
  std::optional<double> density;  ///< of the grains' material, kg/m^3: adds what is per mass
  MeasureOptions measure;
  /// Triangles of all grains together: about 150 a grain, or 40000 if that is more, but no more
  /// than this. 0: no view in three dimensions.
  uint64_t maxTriangles = 1000000;
  std::string sweep;  ///< the text of a table of the verb sweep, to be shown as plots; empty: none
  /// Columns of grains from outside, which the tables get. There is no slider for the strictness
  /// then: what they are of other grains is not known.
  std::vector<GivenColumn> given;
  /// What the labels were merged from (segment with keepManifold): the page gets a slider for the
  /// strictness, if merging by score made them and nothing has edited them since. In slabs if the
  /// labels are.
  std::optional<AnyLabels> manifold;
  /// Slices are those of labels that are reduced to at most so many voxels a side, 1 or more.
  int maxSlice = 256;
  /// The gray scan that slices show with the grains: its box holds that of the labels. Null: none.
  GrayScan* scan = nullptr;
  int pictureEdge = 640;  ///< pixels of the picture for where there is no WebGL, about; 16 .. 8192
};

/// What a page has.
struct Report {
  int64_t grains = 0, bonds = 0;
  uint64_t triangles = 0;
  int sliceReduction = 1;   ///< voxels of the labels along an edge of one in the slices
  bool hasLevels = false;   ///< a slider for the strictness
  uint64_t bytes = 0;       ///< of the file
  std::string noteOnGiven;  ///< see noteOnGiven()
};

/// False if this was built without what the page's script is made with.
bool canWriteReport();

/// True for the text of a table of the verb sweep, by its first columns.
bool isSweepTable(const std::string& text);

/// Writes a sample as a web page in one file, whole or not at all: its numbers, its grains to look
/// at from all sides, slices, tables and charts, which a reader can click, sort and filter. The
/// file holds all that it needs and asks for nothing else: it opens without a network. Same labels
/// and options, same bytes.
///
/// The tables are those of measurementTexts(). Grains are meshed, smoothed and simplified; of
/// labels with many times the triangles reduced ones are meshed, and a grain that is lost there
/// becomes an octahedron of its volume. With manifolds, mesh and slices are those of the grains at
/// the largest strictness of the slider, without tidying; at any other, the page joins these and
/// adds up their measures. Memory: that of measure() and grainMesh(), and of the page's text.
/// Labels in slabs are the same page; they are in memory together only if they are meshed, or
/// sliced, without being reduced.
/// @throw InvalidInput for options out of range, labels without a domain and without grains, a scan
///   that does not hold them, and as measure() does; IoError, also if !canWriteReport();
///   Interrupted.
Report writeReport(const std::string& path, const AnyLabels& labels,
                   const ReportOptions& options = {}, Interrupter* interrupter = nullptr);

/// One of several.
struct ReportSample {
  std::string name, path;             ///< of the labels
  std::function<AnyLabels()> labels;  ///< one sample is in memory at a time
};

/// Writes a sample scan by scan: the page of each, as writeReport() makes it, with a slider from
/// scan to scan and curves of what changes. Grains have one number, and one color, in all scans:
/// see track(). Of the options `labels`, `manifold`, `given`, `scan` and `sweep` are not used.
/// Labels are asked for twice. @throw as writeComparison()
Report writeSeries(const std::string& path, const std::vector<ReportSample>& scans,
                   const ReportOptions& options = {}, Interrupter* interrupter = nullptr);

/// Writes samples side by side: their numbers, pictures, distributions and roses. Of the options
/// those of view and slices are not used, nor are `labels` and `manifold`.
/// @throw InvalidInput also if lengths are not in one unit; else as writeReport()
Report writeComparison(const std::string& path, const std::vector<ReportSample>& samples,
                       const ReportOptions& options = {}, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
