// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/report.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "command.h"
#include "given_option.h"
#include "input_options.h"
#include "outputs.h"
#include "parse.h"
#include "remerge_slabs.h"
#include "scan_option.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/gray_planes.h"
#include "vdb_madf/vdb/read_vdb.h"

namespace vdb_madf::tools {

namespace {

constexpr uint64_t kMaxSweepBytes = 10000000;

struct ReportArguments {
  InputOptions input;
  std::vector<std::string> files;  ///< of labels, and of the page
  std::vector<InputOptions> samples;
  std::string out, boundary = "auto", minFaces = "1", density, sweep, with, triangles = "1000000";
  ScanOption scan{"", "", "--overlay"};
  bool ice = false, noView = false, isSeries = false;
  ReportOptions report;
};

void parse(ReportArguments& o) {
  o.out = o.files.back();
  const std::string ending = fileEnding(o.out);
  if (ending != ".html" && ending != ".htm")
    throw WrongUsage(o.out + ": the output comes last, and its ending must be .html");
  if (o.files.size() == 1) throw WrongUsage("give the labels, and last the page to write");
  o.input.outputs = {o.out};
  for (size_t i = 0; i + 1 < o.files.size(); ++i) {
    o.input.path = o.files[i];
    o.input.parse();
    o.samples.push_back(o.input);
  }
  o.report.labels = o.input.path;
  if (!o.sweep.empty() && o.samples.size() > 1)
    throw WrongUsage("--sweep is of one sample: give the labels of one");
  if (!o.with.empty() && o.samples.size() > 1)
    throw WrongUsage("--with is of one sample: give the labels of one");
  if (!o.scan.path.empty() && o.samples.size() > 1)
    throw WrongUsage("--overlay is of one sample: give the labels of one");
  const ReportOptions usual;
  if (o.samples.size() > 1 && !o.isSeries &&
      (o.noView || o.triangles != ReportArguments().triangles ||
       o.report.maxSlice != usual.maxSlice))
    throw WrongUsage(
        "--no-3d, --triangles and --max-dim are of one sample or a --series: the page that "
        "compares several has no view and no slices");
  checkScan(o.scan, o.input);
  if (o.isSeries && o.samples.size() == 1)
    throw WrongUsage("--series: give the labels of two scans or more, and last the page");
  o.report.measure.boundary = parseBoundary(o.boundary);
  o.report.measure.minFaces = parseCount(o.minFaces, "--min-faces");
  o.report.maxTriangles = o.noView ? 0 : uint64_t(parseCount(o.triangles, "--triangles"));
  if (!o.noView && o.report.maxTriangles == 0)
    throw WrongUsage("--triangles 0: give --no-3d for a page without them");
  o.report.density = parseDensity(o.ice, o.density);
}

/// The manifolds that a file or a folder of slabs keeps beside its labels, in slabs if these are.
std::optional<AnyLabels> manifoldsBeside(const InputOptions& input, const AnyLabels& labels,
                                         Progress* progress) {
  if (std::holds_alternative<LabelSlabs>(labels)) {
    if (!manifoldsAmong(readVdbHeaders(input.path, progress))) return std::nullopt;
    return openManifoldSlabs(input, progress);
  }
  if (!isVdb(input) || isInSlabs(input)) return std::nullopt;
  if (const auto whole = manifoldsAmong(readVdb(input.path, manifoldsAlone(), progress)))
    return Int32Grid::ConstPtr(whole);
  return std::nullopt;
}

/// In slabs only if they can be measured so.
AnyLabels labelsOf(const InputOptions& input, const Common& common) {
  common.progress->start("read");
  return loadAnyLabels(input, "--grid", common.progress);
}

Report writeOne(const ReportArguments& o, const Common& common) {
  ReportOptions options = o.report;
  if (!o.sweep.empty()) options.sweep = readText(o.sweep, kMaxSweepBytes);
  if (!o.sweep.empty() && !isSweepTable(options.sweep))
    throw InvalidInput(o.sweep + ": is no table of the verb sweep");
  const AnyLabels labels = labelsOf(o.input, common);
  options.given = readGiven(o.with, aboutOf(labels), common.progress);
  std::optional<GrayScan> scan;
  if (!o.scan.path.empty()) {
    scan = openScan(o.scan, o.input, common.progress);
    noteOfScan(o.scan.path, noteOnScan(*scan, aboutOf(labels)), common.progress);
    placeScan(*scan, boxOf(aboutOf(labels)));
    options.scan = &*scan;
  }
  // What crosses at another strictness the page cannot tell.
  if (!options.measure.crossings)
    options.manifold = manifoldsBeside(o.input, labels, common.progress);
  return withFileName(o.input.path,
                      [&] { return writeReport(o.out, labels, options, common.progress); });
}

Report writeAll(const ReportArguments& o, const Common& common) {
  std::vector<ReportSample> samples;
  for (const InputOptions& input : o.samples)
    samples.push_back(
        {input.path, input.path, [&input, &common] { return labelsOf(input, common); }});
  if (o.isSeries) {
    for (ReportSample& scan : samples) scan.name = std::filesystem::path(scan.path).stem().string();
    return writeSeries(o.out, samples, o.report, common.progress);
  }
  return writeComparison(o.out, samples, o.report, common.progress);
}

void runReport(const ReportArguments& o, const Common& common) {
  checkWritable(o.out);
  const bool isOne = o.samples.size() == 1;
  const Report report = isOne ? writeOne(o, common) : writeAll(o, common);
  common.progress->end();
  if (!report.noteOnGiven.empty()) common.progress->note(o.with + ": " + report.noteOnGiven);
  if (common.quiet) return;
  std::printf("%s: %.1f MB, open it in a browser: ", o.out.c_str(), double(report.bytes) / 1e6);
  if (!isOne)
    std::printf("%s, ", counted(int64_t(o.samples.size()), o.isSeries ? "scan" : "sample").c_str());
  std::printf("%s, %s", counted(report.grains, "grain").c_str(),
              counted(report.bonds, "bond").c_str());
  if (report.triangles > 0)
    std::printf(", %s", counted(int64_t(report.triangles), "triangle").c_str());
  std::printf("\n");
  if (report.sliceReduction > 1)
    std::printf("  slices              reduced %d times: a voxel of them is %d^3 of the labels\n",
                report.sliceReduction, report.sliceReduction);
  if (report.hasLevels) std::printf("  strictness          a slider joins and parts grains\n");
}

}  // namespace

void addReport(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<ReportArguments>();
  Verb verb = addVerb(command, common, "report", "a page for the browser: look, click, filter",
                      "vdb_madf report grains.vdb report.html");
  verb.option(
          "LABELS", o->files,
          "labels, VDB or integer image, of one sample or of several to compare; last, the page "
          "to write, OUT.html: one file that opens in a browser, without a network")
      .required();
  verb.option("--grid", o->input.gridName, "VDB input: the grid to take").typeName("NAME");
  verb.option("--title", o->report.title, "of the page (default: the name of the file)")
      .typeName("TEXT");
  verb.option("--triangles", o->triangles, "of all grains together, at most, about; 150 a grain do")
      .typeName("N")
      .showDefault();
  verb.flag("--no-3d", o->noView, "a picture in the place of the view to turn");
  verb.option("--sweep", o->sweep, "a table of the verb sweep, of the same object: adds its plots")
      .typeName("FILE.csv");
  verb.flag("--series", o->isSeries,
            "the labels are scans of one sample, numbered by track: a page with a slider from scan "
            "to scan");
  verb.option("--with", o->with, kWithHelp).typeName("FILE.csv");
  o->scan.add(verb, "the gray scan: slices show it with the outlines of grains");
  verb.option("--max-dim", o->report.maxSlice, "longest side of the slices, in voxels")
      .range(16, 1024)
      .showDefault();
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  o->input.addDomain(verb);
  addBoundary(verb, o->boundary);
  verb.option("--min-faces", o->minFaces, "fewest voxel faces of a bond")
      .typeName("N")
      .showDefault();
  verb.flag(
      "--crossing", o->report.measure.crossings,
      "adds the minimum cut and the currents between opposite faces of a box, in the place of "
      "the slider of strictness");
  addDensity(verb, o->density, o->ice);
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] { runReport(*o, common); };
  });
}

}  // namespace vdb_madf::tools
