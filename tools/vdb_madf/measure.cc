// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/measure.h"

#include <memory>
#include <type_traits>

#include "command.h"
#include "measure_arguments.h"
#include "measure_summary.h"
#include "remerge_slabs.h"
#include "scan_option.h"
#include "text_file.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/intensity/estimate_blur.h"
#include "vdb_madf/intensity/measure_gray.h"
#include "vdb_madf/intensity/measure_necks.h"
#include "vdb_madf/intensity/measure_sensitivity.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/measure/measure_binder.h"
#include "vdb_madf/measure/measure_stability.h"
#include "vdb_madf/measure/table_unit.h"
#include "vdb_madf/pictures/measures_plot.h"

namespace vdb_madf::tools {

namespace {

/// The sample's name, else that of the file without folders.
std::string titleOf(const MeasureArguments& o) {
  return o.tables.sample.empty() ? lastPart(o.input.path) : o.tables.sample;
}

/// Of labels, a grid or slabs.
template <typename Labels>
Measurements measureLabels(const MeasureArguments& o, const Common& common, const Labels& labels) {
  noteOfScan(o.input.path, noteOnPlaces(aboutOf(labels)), common.progress);
  // Scans are opened before the work: what is wrong with them is said at once.
  std::optional<GrayScan> scan;
  if (!o.intensity.path.empty()) {
    scan = openScan(o.intensity, o.input, common.progress);
    noteOfScan(o.intensity.path, noteOnScan(*scan, aboutOf(labels)), common.progress);
  }
  const MaskGrid::Ptr binder =
      o.phases.path.empty() ? nullptr : loadPhase(o.phases, o.binder, o.input, common.progress);
  if (const auto domain = binder ? storedDomain(*binder) : std::nullopt)
    noteOfScan(o.phases.path,
               noteOnScan(o.phases.path, domain->box(), storedVoxelSize(*binder), aboutOf(labels)),
               common.progress);
  std::optional<ScanBlur> blur;
  if (!o.gray.path.empty()) {
    GrayScan gray = openScan(o.gray, o.input, common.progress);
    noteOfScan(o.gray.path, noteOnScan(gray, aboutOf(labels)), common.progress);
    common.progress->start("blur");
    const auto domain = storedDomain(aboutOf(labels));
    if (!o.sensitivity)
      blur = blurOf(std::move(gray), domain, common.progress);
    else if (blur = estimateBlur(std::move(gray), domain, common.progress); !blur)
      noteOfScan(o.gray.path, "its edges tell no blur: necks are not measured", common.progress);
    if (blur) noteOfScan(o.gray.path, noteOn(*blur), common.progress);
  }
  std::optional<ManifoldGraph> graph;
  if (o.stability)
    graph = withFileName(o.input.path, [&] { return keptGraph(o.input, common.progress); });
  common.progress->start("measure");
  Measurements measurements =
      withFileName(o.input.path, [&] { return measure(labels, o.measure, common.progress); });
  if (graph) withFileName(o.input.path, [&] { measureStability(*graph, measurements); });
  if (scan) {
    common.progress->start("gray values");
    measureGray(labels, *scan, measurements, common.progress);
  }
  if constexpr (std::is_same_v<Labels, Int32Grid>) {
    if (binder) {
      common.progress->start("binder");
      withFileName(o.phases.path, [&] {
        measureBinder(labels, *binder, o.measure, measurements, common.progress);
      });
      noteOfScan(o.phases.path, noteOn(*measurements.binder, o.binder), common.progress);
    }
    if (blur) {
      common.progress->start("necks");
      GrayScan gray = openScan(o.gray, o.input, common.progress);
      measureNecks(labels, gray, *blur, measurements, common.progress);
    }
    if (o.sensitivity) {
      common.progress->start("sensitivity");
      withFileName(o.gray.path, [&] {
        measureSensitivity(
            labels, [&] { return openScan(o.gray, o.input, common.progress); }, *o.sensitivity,
            measurements, common.progress);
      });
    }
  }
  return measurements;
}

Measurements measureInput(const MeasureArguments& o, const Common& common) {
  if (isInSlabs(o.input) && o.gray.path.empty() && o.phases.path.empty()) {
    const LabelSlabs labels = openLabelSlabs(o.input, "--grid", common.progress);
    const auto domain = storedDomain(*labels.about);
    requireTableUnit(o.tables.unit, storedVoxelSize(*labels.about));
    if (!domain || domain->isBox()) return measureLabels(o, common, labels);
  }  // in a region, for necks and for binder, they have to be there together
  common.progress->start("read");
  const Int32Grid::Ptr labels = loadLabels(o.input, "--grid", common.progress);
  requireTableUnit(o.tables.unit, storedVoxelSize(*labels));
  return measureLabels(o, common, *labels);
}

void runMeasure(MeasureArguments& o, const Common& common) {
  if (!o.sizeReference.empty()) o.measure.sizeReference = readSizeReference(o.sizeReference);
  MeasurementTables tables(o.folder);
  TextFile plot(o.plot), sizes(o.sizeCurve), bridges(o.bridges);
  const Measurements measurements = measureInput(o, common);
  TableOptions options = o.tables;
  options.labels = o.input.path;
  OutputSet files;
  tables.write(measurements, options);
  if (!plot.isNowhere())
    plot.write(measuresPlot(measurements, titleOf(o), *plotTypeOf(o.plot), o.tables.unit));
  if (!bridges.isNowhere()) bridges.write(bridgesText(measurements, options));
  if (!sizes.isNowhere()) sizes.write(sizeCurveText(measurements, options));
  files.commit();
  common.progress->end();
  if (!common.quiet && !sizes.isStandardOutput() && !bridges.isStandardOutput())
    print(o, measurements);
}

}  // namespace

void addMeasure(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<MeasureArguments>();
  Verb verb = addVerb(command, common, "measure", "tables of grains, bonds and the sample",
                      "vdb_madf measure grains.vdb tables --voxel-size 8.5um --ice");
  verb.option("LABELS", o->input.path, "labels: VDB or integer image").required();
  verb.option("OUT_DIR", o->folder,
              "gets grains.csv, bonds.csv and sample.json; or OUT.h5: one HDF5 file with these")
      .required();
  verb.option("--grid", o->input.gridName, "VDB input: the grid to take").typeName("NAME");
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  o->input.addDomain(verb);
  addBoundary(verb, o->boundary);
  verb.option("--sample", o->tables.sample,
              "name of the sample: becomes the first column of both tables")
      .typeName("NAME");
  verb.option("--unit", o->tables.unit, "of lengths; default: mm, of voxels under 20 nm um")
      .oneOf({"mm", "um"});
  verb.option("--min-faces", o->minFaces,
              "fewest voxel faces of a bond; the areas keep what smaller contacts share")
      .typeName("N")
      .showDefault();
  addDensity(verb, o->density, o->ice);
  verb.flag("--shape", o->measure.shape,
            "adds Feret diameters, convex volume, solidity and Zingg's class");
  verb.flag("--edge-weights", o->measure.edgeWeights,
            "adds weights for what the faces of a box cut, and sizes corrected by them");
  verb.flag("--crossing", o->measure.crossings,
            "adds what leads from face to face of a box: the minimum cut, what the bonds conduct");
  verb.flag("--voronoi", o->measure.cells,
            "adds each grain's set-Voronoi cell: its volume, local solid fraction and neighbors");
  verb.option("--size-curve", o->sizeCurve,
              "writes the sizes that 0 to 100 % of the volume pass, of four kinds; with --shape")
      .typeName("FILE.csv");
  verb.option("--size-reference", o->sizeReference,
              "adds how far these curves are from that of a table: size_mm,percent_passing")
      .typeName("FILE.csv");
  o->intensity.add(verb,
                   "adds the gray values of grains and bonds in the scan that they were made of",
                   "of the scan");
  o->gray.add(verb, "adds the necks of bonds as this gray scan shows them, freed of its blur");
  o->phases.add(verb,
                "a map of phases on the voxels of the labels: measures the binder between grains",
                "of that map");
  verb.option("--binder", o->binderText, "the value of binder in the map, 1 if it is not given")
      .typeName("V");
  verb.option("--bridges", o->bridges,
              "table of the binder of each pair of grains: volume, section, what it covers")
      .typeName("FILE.csv");
  verb.flag("--stability", o->stability,
            "adds the strictnesses between which grains stay the same, and bonds vanish (manifolds "
            "kept)");
  verb.option("--bootstrap", o->bootstrap,
              "adds 95 % intervals of the means, from N samples drawn of the grains")
      .typeName("N");
  verb.option("--sensitivity", o->runs,
              "adds what comes again when the --gray scan is segmented N times by other choices")
      .typeName("N");
  verb.option("--vary", o->vary,
              "how far these go: threshold:T,smooth:S,strictness:K,gamma:G (default: by the scan)")
      .typeName("LIST");
  verb.option("--plot", o->plot,
              "draws histograms and roses of grains and bonds: .svg, .pdf or .png")
      .typeName("FILE");
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] { runMeasure(*o, common); };
  });
}

}  // namespace vdb_madf::tools
