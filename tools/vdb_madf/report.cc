// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/report.h"

#include <cstdio>
#include <memory>

#include "command.h"
#include "input_options.h"
#include "outputs.h"
#include "parse.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/files/file_ending.h"

namespace vdb_madf::tools {

namespace {

struct Options {
  InputOptions input;
  std::string out, boundary = "auto", minFaces = "1", density, triangles = "1000000";
  bool ice = false, noView = false;
  ReportOptions report;
};

void parse(Options& o) {
  const std::string ending = fileEnding(o.out);
  if (ending != ".html" && ending != ".htm")
    throw WrongUsage(o.out + ": the output's ending must be .html");
  o.input.outputs = {o.out};
  o.input.parse();
  o.report.labels = o.input.path;
  o.report.measure.boundary = parseBoundary(o.boundary);
  o.report.measure.minFaces = parseCount(o.minFaces, "--min-faces");
  o.report.maxTriangles = o.noView ? 0 : uint64_t(parseCount(o.triangles, "--triangles"));
  if (!o.noView && o.report.maxTriangles == 0)
    throw WrongUsage("--triangles 0: give --no-3d for a page without them");
  if (o.ice && !o.density.empty()) throw WrongUsage("--ice is --density 917: give one of the two");
  if (o.ice) o.report.density = kIceDensity;
  if (!o.density.empty()) {
    o.report.density = parseNumber(o.density, "--density");
    if (!(*o.report.density > 0)) throw WrongUsage("--density " + o.density + ": must be above 0");
  }
}

void run(const Options& o, const Common& common) {
  checkWritable(o.out);
  common.progress->start("read");
  const Int32Grid::Ptr labels = loadLabels(o.input, "--grid", common.progress);
  const Report report = withFileName(
      o.input.path, [&] { return writeReport(o.out, *labels, o.report, common.progress); });
  common.progress->end();
  if (common.quiet) return;
  std::printf("%s: %.1f MB, open it in a browser: %s, %s", o.out.c_str(),
              double(report.bytes) / 1e6, counted(report.grains, "grain").c_str(),
              counted(report.bonds, "bond").c_str());
  if (report.triangles > 0)
    std::printf(", %s", counted(int64_t(report.triangles), "triangle").c_str());
  std::printf("\n");
  if (report.sliceReduction > 1)
    std::printf("  slices              reduced %d times: a voxel of them is %d^3 of the labels\n",
                report.sliceReduction, report.sliceReduction);
}

}  // namespace

void addReport(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<Options>();
  Verb verb = addVerb(command, common, "report", "a page for the browser: look, click, filter",
                      "vdb_madf report grains.vdb report.html");
  verb.option("LABELS", o->input.path, "labels: VDB or integer image").required();
  verb.option("OUT.html", o->out, "one file that opens in a browser, without a network").required();
  verb.option("--grid", o->input.gridName, "VDB input: the grid to take").typeName("NAME");
  verb.option("--title", o->report.title, "of the page (default: the name of the file)")
      .typeName("TEXT");
  verb.option("--triangles", o->triangles, "of all grains together, at most, about; 150 a grain do")
      .typeName("N")
      .showDefault();
  verb.flag("--no-3d", o->noView, "a picture in the place of the view to turn");
  verb.option("--max-dim", o->report.maxSlice, "longest side of the slices, in voxels")
      .range(16, 2048)
      .showDefault();
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  o->input.addDomain(verb);
  addBoundary(verb, o->boundary);
  verb.option("--min-faces", o->minFaces, "fewest voxel faces of a bond")
      .typeName("N")
      .showDefault();
  verb.option("--density", o->density, "of the grains' material, kg/m3: adds what is per mass")
      .typeName("D");
  verb.flag("--ice", o->ice, "the density of ice: --density 917");
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] { run(*o, common); };
  });
}

}  // namespace vdb_madf::tools
