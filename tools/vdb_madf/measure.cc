// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/measure.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>

#include "command.h"
#include "input_options.h"
#include "outputs.h"
#include "parse.h"
#include "remerge_slabs.h"
#include "scan_option.h"
#include "text_file.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/grids/object_keys.h"
#include "vdb_madf/intensity/estimate_blur.h"
#include "vdb_madf/intensity/measure_gray.h"
#include "vdb_madf/intensity/measure_necks.h"
#include "vdb_madf/intensity/measure_sensitivity.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/measure/edge_weights.h"
#include "vdb_madf/measure/measure_binder.h"
#include "vdb_madf/measure/measure_stability.h"
#include "vdb_madf/measure/size_biases.h"
#include "vdb_madf/pictures/measures_plot.h"

namespace vdb_madf::tools {

namespace {

struct MeasureArguments {
  InputOptions input;
  std::string folder, boundary = "auto", density, minFaces = "1", bootstrap, plot, sizeCurve,
                      sizeReference;
  ScanOption intensity{"", "", "--intensity"}, gray{"", "", "--gray"}, phases{"", "", "--phases"};
  std::string binderText, bridges;
  int64_t binder = 1;
  std::string runs, vary;
  bool ice = false, stability = false;
  MeasureOptions measure;
  std::optional<SensitivityOptions> sensitivity;
  TableOptions tables;
};

/// --vary threshold:T,smooth:S,strictness:K,gamma:G, or some of these.
void parseVary(const std::string& text, SensitivityOptions& options) {
  for (const std::string& item : split(text, ',')) {
    const size_t colon = item.find(':');
    const std::string name = item.substr(0, colon);
    const std::string value = colon == std::string::npos ? "" : item.substr(colon + 1);
    const std::string about = "--vary " + name;
    if (name == "gamma") {
      options.gamma = parseCount(value, about);
      continue;
    }
    std::optional<double>* const number = name == "threshold"    ? &options.threshold
                                          : name == "smooth"     ? &options.smooth
                                          : name == "strictness" ? &options.strictness
                                                                 : nullptr;
    if (!number)
      throw WrongUsage("--vary " + text +
                       ": write threshold:T,smooth:S,strictness:K,gamma:G, or some of these");
    *number = parseNumber(value, about);
    if (!(**number >= 0)) throw WrongUsage(about + ":" + value + ": must be 0 or more");
  }
}

void parseSensitivity(MeasureArguments& o) {
  if (o.runs.empty()) {
    if (!o.vary.empty()) throw WrongUsage("--vary says how far --sensitivity goes: give it, too");
    return;
  }
  if (o.gray.path.empty())
    throw WrongUsage("--sensitivity segments the scan again: give it with --gray SCAN");
  const int64_t runs = parseCount(o.runs, "--sensitivity");
  if (runs < kMinRuns || runs > kMaxRuns)
    throw WrongUsage(
        fmt::format("--sensitivity {}: must be from {} to {}", o.runs, kMinRuns, kMaxRuns));
  o.sensitivity.emplace();
  o.sensitivity->runs = int(runs);
  o.sensitivity->measure = o.measure;
  if (!o.vary.empty()) parseVary(o.vary, *o.sensitivity);
}

void parse(MeasureArguments& o) {
  o.input.outputs = MeasurementTables::paths(o.folder);
  o.input.outputs.push_back(o.plot);
  o.input.outputs.push_back(o.sizeCurve);
  o.input.outputs.push_back(o.bridges);
  if (!o.bridges.empty()) checkTableEnding(o.bridges);
  if (o.phases.path.empty() != o.bridges.empty())
    throw WrongUsage("--phases MAP and --bridges FILE.csv go together: give both");
  if (!o.binderText.empty()) {
    if (o.phases.path.empty())
      throw WrongUsage("--binder is a value of a map of phases: give --phases, too");
    o.binder = parseCount(o.binderText, "--binder");
  }
  if (!o.sizeCurve.empty()) checkTableEnding(o.sizeCurve);
  if (!o.sizeReference.empty()) checkOutputs(o.input.outputs, o.sizeReference);
  o.measure.sizes = !o.sizeCurve.empty();
  if (!o.plot.empty() && !plotTypeOf(o.plot))
    throw WrongUsage(o.plot + ": the plot's ending must be .svg, .pdf or .png");
  o.input.parse();
  if (o.ice) o.tables.density = kIceDensity;
  if (!o.density.empty()) {
    if (o.ice) throw WrongUsage("--ice is --density 917: give one of the two");
    o.tables.density = parseNumber(o.density, "--density");
    if (!(*o.tables.density > 0)) throw WrongUsage("--density " + o.density + ": must be above 0");
  }
  if (o.stability && !hasVdbEnding(o.input.path) && !isInSlabs(o.input))
    throw WrongUsage(o.input.path +
                     ": --stability needs what segment --keep manifold keeps, in .vdb or .slabs");
  checkScan(o.intensity, o.input);
  checkScan(o.gray, o.input);
  checkScan(o.phases, o.input);
  o.measure.boundary = parseBoundary(o.boundary);
  o.measure.minFaces = parseCount(o.minFaces, "--min-faces");
  if (!o.bootstrap.empty()) {
    const int64_t replicates = parseCount(o.bootstrap, "--bootstrap");
    if (replicates < kMinReplicates || replicates > kMaxReplicates)
      throw WrongUsage(fmt::format("--bootstrap {}: must be from {} to {}", o.bootstrap,
                                   kMinReplicates, kMaxReplicates));
    o.measure.bootstrap = int(replicates);
  }
  parseSensitivity(o);
}

void printCorrected(const Measurements& m, double length, const std::string& unit) {
  const EdgeCorrected corrected = edgeCorrected(m.grains);
  std::printf("  at the faces        %s, left out of the corrected sizes\n",
              counted(corrected.leftOut, "grain").c_str());
  if (corrected.grains > 0)
    std::printf("  corrected diameter  d50 %.5g %s by number, %.5g by volume\n",
                length * correctedDiameterPercentile(m.grains, 0.5, false), unit.c_str(),
                length * correctedDiameterPercentile(m.grains, 0.5, true));
  else
    std::printf("  corrected diameter  unknown: no grain is whole\n");
}

void printIntervals(const std::vector<MeanInterval>& intervals, double length,
                    const std::string& unit) {
  for (const MeanInterval& mean : intervals)
    if (mean.low && mean.high)
      std::printf("  %-33s %.4g, 95 %% from %.4g to %.4g\n",
                  (mean.name + unitSuffix(mean.power, unit)).c_str(),
                  scaled(*mean.mean, mean.power, length), scaled(*mean.low, mean.power, length),
                  scaled(*mean.high, mean.power, length));
}

/// How much of it all comes again by other choices.
void printSensitivity(const Measurements& m, double length, const std::string& unit) {
  const Sensitivity& s = *m.sensitivity;
  std::printf(
      "  sensitivity         %d runs: threshold %.5g to %.5g, smooth %.2f to %.2f,\n"
      "                      strictness %.4g to %.4g, gamma %.0f to %.0f\n",
      s.runs, s.threshold.low, s.threshold.high, s.smooth.low, s.smooth.high, s.strictness.low,
      s.strictness.high, s.gamma.low, s.gamma.high);
  const auto often = [](const auto& list) {
    return (long long)std::count_if(list.begin(), list.end(),
                                    [](const auto& item) { return item.recurrence->share >= 0.9; });
  };
  std::printf("  in 90 %% of them     %lld of %s, %lld of %s\n", often(m.grains),
              counted(int64_t(m.grains.size()), "grain").c_str(), often(m.bonds),
              counted(int64_t(m.bonds.size()), "bond").c_str());
  printIntervals(s.intervals, length, unit);
}

/// Necks as the labels have them and as the scan shows them.
void printNecks(const Measurements& m, double length, const std::string& unit) {
  int64_t confirmed = 0;
  double labelled = 0, shown = 0;
  for (const BondMeasures& bond : m.bonds)
    if (bond.neck->confirmed) {
      ++confirmed;
      labelled += bond.area;
      shown += bond.neck->area;
    }
  std::printf("  scan                blur %.2f voxel, noise %.1f %% of the contrast\n",
              m.scan->sigma, 100 * m.scan->noise);
  std::printf("  necks in the scan   %lld of %s, mean area %.5g %s2 (%.5g in the labels)\n",
              (long long)confirmed, counted(int64_t(m.bonds.size()), "bond").c_str(),
              confirmed ? shown / double(confirmed) * length * length : 0.0, unit.c_str(),
              confirmed ? labelled / double(confirmed) * length * length : 0.0);
  std::printf("  contacts a grain    %.2f with gaps of up to %.3g %s\n", contactCoordination(m),
              kContactGap * length, unit.c_str());
}

void print(const MeasureArguments& o, const Measurements& m) {
  const std::string unit = m.voxelSize ? m.voxelSize->unit() : "voxel";
  const auto edges = m.voxelSize ? m.voxelSize->edgesInUnit() : std::array<double, 3>{1, 1, 1};
  const double length = *std::min_element(edges.begin(), edges.end());
  std::printf("%s: %s, %s%s\n", o.folder.c_str(),
              counted(int64_t(m.grains.size()), "grain").c_str(),
              counted(int64_t(m.bonds.size()), "bond").c_str(),
              m.grains.size() == 1 ? ": is this a mask? segment it first" : "");
  if (!m.voxelSize)
    std::printf("  voxel size          unknown, so lengths are in %s (give --voxel-size)\n",
                m.edges == openvdb::Vec3d(1) ? "voxels" : "shortest edges of a voxel");
  const std::optional<double>& density = o.tables.density;
  std::printf("  solid fraction      %.4f of the %s", m.sample.objectFraction,
              m.sample.domainKnown ? "domain" : "box of the grains (the domain is unknown)");
  if (density) std::printf(", %.1f kg/m3", *density * m.sample.objectFraction);
  std::printf("\n  specific surface    %.5g /%s", m.sample.specificSurface / length, unit.c_str());
  if (m.voxelSize && density)
    std::printf(" = %.4g m2/kg", m.sample.specificSurface / m.voxelSize->shortestEdge() / *density);
  std::printf("\n  grain diameter      d50 %.5g %s by number, %.5g by volume\n",
              length * diameterPercentile(m.grains, 0.5, false), unit.c_str(),
              length * diameterPercentile(m.grains, 0.5, true));
  if (m.extra.edgeWeights) printCorrected(m, length, unit);
  std::printf("  bonds a grain       %.2f\n", m.sample.meanCoordination);
  if (m.minFaces > 1)
    std::printf("  left out            %s of fewer than %lld faces\n",
                counted(m.sample.contactsLeftOut, "contact").c_str(), (long long)m.minFaces);
  if (m.sample.bondsWithoutCurvature > 0)
    std::printf("  too small to curve  %s (under 10 faces, or all in a row)\n",
                counted(m.sample.bondsWithoutCurvature, "bond").c_str());
  if (m.scan)
    printNecks(m, length, unit);
  else if (m.metadata[kThresholdKey])
    std::printf(
        "  areas of bonds      of a thresholded scan, too large by its blur (--gray SCAN)\n");
  if (m.binder)
    std::printf("  binder              %s, %.3g %% of the binder in none\n",
                counted(int64_t(m.binder->bridges.size()), "bridge").c_str(),
                m.binder->volume > 0 ? 100 * m.binder->looseVolume / m.binder->volume : 0.0);
  for (const SizeDeviation& deviation : m.sizeDeviations)
    std::printf("  %-20sRMS %.2f %% from the curve\n", deviation.size.c_str(), deviation.percent);
  printIntervals(m.intervals, length, unit);
  if (m.sensitivity) printSensitivity(m, length, unit);
  for (const SizeBias& bias : sizeBiases(m))
    std::printf("  too small for       %s\n", toString(bias).c_str());
}

/// The sample's name, else that of the file without folders.
std::string titleOf(const MeasureArguments& o) {
  return o.tables.sample.empty() ? o.input.path.substr(o.input.path.find_last_of('/') + 1)
                                 : o.tables.sample;
}

/// Of labels, a grid or slabs.
template <typename Labels>
Measurements measureLabels(const MeasureArguments& o, const Common& common, const Labels& labels) {
  // Scans are opened before the work: what is wrong with them is said at once.
  std::optional<GrayScan> scan;
  if (!o.intensity.path.empty()) scan = openScan(o.intensity, o.input, common.progress);
  const MaskGrid::Ptr binder =
      o.phases.path.empty() ? nullptr : loadPhase(o.phases, o.binder, o.input, common.progress);
  std::optional<ScanBlur> blur;
  if (!o.gray.path.empty()) {
    const GrayScan gray = openScan(o.gray, o.input, common.progress);
    common.progress->start("blur");
    blur = blurOf(*gray.image, common.progress);
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
    }
    if (blur) {
      common.progress->start("necks");
      GrayScan gray = openScan(o.gray, o.input, common.progress);
      measureNecks(labels, gray, *blur, measurements, common.progress);
    }
    if (o.sensitivity) {
      common.progress->start("sensitivity");
      withFileName(o.input.path, [&] {
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
    if (!domain || domain->isBox()) return measureLabels(o, common, labels);
  }  // in a region, for necks and for binder, they have to be there together
  common.progress->start("read");
  return measureLabels(o, common, *loadLabels(o.input, "--grid", common.progress));
}

void runMeasure(MeasureArguments& o, const Common& common) {
  constexpr uint64_t kMostBytes = 1 << 20;
  if (!o.sizeReference.empty())
    o.measure.sizeReference = withFileName(
        o.sizeReference, [&] { return parseSizeReference(readText(o.sizeReference, kMostBytes)); });
  MeasurementTables tables(o.folder);
  TextFile plot(o.plot), sizes(o.sizeCurve), bridges(o.bridges);
  const Measurements measurements = measureInput(o, common);
  TableOptions options = o.tables;
  options.labels = o.input.path;
  tables.write(measurements, options);
  if (!plot.isNowhere()) plot.write(measuresPlot(measurements, titleOf(o), *plotTypeOf(o.plot)));
  if (!bridges.isNowhere()) bridges.write(bridgesText(measurements, options));
  if (!sizes.isNowhere()) sizes.write(sizeCurveText(measurements, options));
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
  verb.option("--min-faces", o->minFaces,
              "fewest voxel faces of a bond; the areas keep what smaller contacts share")
      .typeName("N")
      .showDefault();
  verb.option("--density", o->density, "of the grains' material, kg/m3: adds what is per mass")
      .typeName("D");
  verb.flag("--ice", o->ice, "the density of ice: --density 917");
  verb.flag("--shape", o->measure.shape,
            "adds Feret diameters, convex volume, solidity and Zingg's class");
  verb.flag("--edge-weights", o->measure.edgeWeights,
            "adds weights for what the faces of a box cut, and sizes corrected by them");
  verb.flag("--voronoi", o->measure.cells,
            "adds each grain's set-Voronoi cell: its volume, local solid fraction and neighbors");
  verb.option("--size-curve", o->sizeCurve,
              "writes the sizes that 0 to 100 % of the volume pass, of four kinds; with --shape")
      .typeName("FILE.csv");
  verb.option("--size-reference", o->sizeReference,
              "adds how far these curves are from that of a table: size_mm,percent_passing")
      .typeName("FILE.csv");
  verb.option("--intensity", o->intensity.path,
              "adds the gray values of grains and bonds in the scan that they were made of")
      .typeName("FILE");
  verb.option("--intensity-grid", o->intensity.grid,
              "of the scan: the grid of a VDB, the array of a Zarr or HDF5 file")
      .typeName("NAME");
  verb.option("--gray", o->gray.path,
              "adds the necks of bonds as this gray scan shows them, freed of its blur")
      .typeName("FILE");
  verb.option("--gray-grid", o->gray.grid,
              "of that scan: the grid of a VDB, the array of a Zarr or HDF5 file")
      .typeName("NAME");
  verb.option("--phases", o->phases.path,
              "a map of phases on the voxels of the labels: measures the binder between grains")
      .typeName("FILE");
  verb.option("--phases-grid", o->phases.grid,
              "of that map: the grid of a VDB, the array of a Zarr or HDF5 file")
      .typeName("NAME");
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
