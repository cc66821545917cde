// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/parameter_sweep.h"

#include <fmt/core.h>
#include <openvdb/Metadata.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <set>
#include <sstream>
#include <utility>

#include "command.h"
#include "input_options.h"
#include "merge_options.h"
#include "outputs.h"
#include "parse.h"
#include "remerge_slabs.h"
#include "text_file.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/pictures/sweep_plot.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"
#include "vdb_madf/slabs/sweep_slabs.h"
#include "vdb_madf/vdb/read_vdb.h"

namespace vdb_madf::tools {

namespace {

constexpr char kStrictnesses[] = "8:14:0.5", kThetas[] = "-1:-0.5:0.05", kDeltas[] = "2";

struct SweepArguments {
  InputOptions input;
  std::string out, plot, gamma, merge = "score", strictness = kStrictnesses;
  std::string theta = kThetas, delta = kDeltas, adjacency = "manifold";
  std::string boundary = "auto", small = "100", minGrain, fillHoles, tidy, scratch;
  SweepOptions sweep;
};

constexpr int kMaxSteps = 1000;

/// As split(), but nothing need follow the last separator.
std::vector<std::string> listed(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

/// The double next to the number's decimals, so that step 3 of -1:-0.5:0.05 is the -0.85 of others.
double asTyped(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", number);
  return std::stod(text);
}

/// A list of numbers and of ranges FIRST:LAST:STEP, the last included.
std::vector<double> parseRanges(const std::string& text, const std::string& option) {
  std::vector<double> numbers;
  for (const std::string& part : listed(text, ',')) {
    std::vector<double> range;
    for (const std::string& number : listed(part, ':'))
      range.push_back(parseNumber(number, option));
    if (range.size() == 1) {
      numbers.push_back(range[0]);
    } else {
      const double count = range.size() == 3 ? (range[1] - range[0]) / range[2] : -1;
      if (!(count >= 0 && count < kMaxSteps))
        throw WrongUsage(
            fmt::format("{} {}: must be a number or FIRST:LAST:STEP of at most {} steps from "
                        "FIRST to LAST",
                        option, part, kMaxSteps));
      for (int i = 0; i <= int(count + 1e-9); ++i)
        numbers.push_back(asTyped(range[0] + i * range[2]));
    }
  }
  return numbers;
}

std::vector<double> parseThetas(const std::string& text) {
  const std::vector<double> thetas = parseRanges(text, "--theta");
  for (const double theta : thetas)
    if (!(theta >= -1 && theta <= 1))
      throw WrongUsage("--theta " + text + ": cosines must lie between -1 and 1");
  return thetas;
}

template <typename T>
void requireDifferent(const std::vector<T>& values, const std::string& option) {
  if (values.empty()) throw WrongUsage(option + ": the list is empty");
  if (std::set<T>(values.begin(), values.end()).size() < values.size())
    throw WrongUsage(option + ": a value is there twice");
}

/// @throw WrongUsage if options of the tests are given for scores alone, or those of scores without
void parseStrictnesses(SweepArguments& o) {
  const std::vector<MergeMode>& modes = o.sweep.modes;
  const auto scores = std::count(modes.begin(), modes.end(), MergeMode::score);
  if (!scores && o.strictness != kStrictnesses) refuseStrictness(o.merge);
  if (scores && modes.size() == 1)
    for (const auto& [isGiven, name] :
         {std::pair(o.theta != kThetas, "--theta"), std::pair(o.delta != kDeltas, "--delta"),
          std::pair(o.adjacency != "manifold", "--adjacency")})
      if (isGiven) refuseOptionOfTests(name);
  if (scores && modes.size() > 1 && !o.plot.empty())
    throw WrongUsage(
        "--plot draws grains by --strictness or by --theta: sweep --merge score alone");
  o.sweep.strictnesses = parseRanges(o.strictness, "--strictness");
  for (const double strictness : o.sweep.strictnesses)
    if (!(std::abs(strictness) <= kMaxStrictness))
      throw WrongUsage("--strictness " + o.strictness + ": must lie between -200000 and 200000");
  requireDifferent(o.sweep.strictnesses, "--strictness");
}

void parse(SweepArguments& o) {
  o.input.outputs = {o.out, o.plot};
  o.input.longestSide = kMaxExtent;
  o.input.parse();
  checkTableEnding(o.out);
  if (!o.plot.empty() && o.plot != "-" && !plotTypeOf(o.plot))
    throw WrongUsage(o.plot + ": the plot's ending must be .svg, .pdf or .png");
  SweepOptions& sweep = o.sweep;
  sweep.gammas.clear();
  for (const std::string& gamma : listed(o.gamma.empty() ? "0" : o.gamma, ','))
    sweep.gammas.push_back(parseCount(gamma, "--gamma"));
  sweep.modes.clear();
  for (const std::string& mode : listed(o.merge, ',')) {
    MergeArguments arguments;
    arguments.mode = mode;
    sweep.modes.push_back(arguments.parse().mode);
    if (mode != toString(sweep.modes.back()))
      throw WrongUsage("--merge " + mode + ": must be score, both, angle or neck");
  }
  parseStrictnesses(o);
  sweep.thetas = parseThetas(o.theta);
  sweep.deltas.clear();
  for (const std::string& delta : listed(o.delta, ',')) sweep.deltas.push_back(parseDelta(delta));
  sweep.minGrain = parseMinGrain(o.minGrain);
  sweep.fillHoles = parseFillHoles(o.fillHoles);
  sweep.tidy = parseTidy(o.tidy);
  requireDifferent(sweep.deltas, "--delta");
  requireDifferent(sweep.gammas, "--gamma");
  requireDifferent(sweep.modes, "--merge");
  requireDifferent(sweep.thetas, "--theta");
  if (o.adjacency == "cell") sweep.adjacency = Adjacency::cell;
  const double small = parseNumber(o.small, "--small");
  if (!(small >= 1 && small <= 1e15 && small == std::floor(small)))
    throw WrongUsage("--small " + o.small + ": must be a whole number of voxels, 1 or more");
  sweep.smallVoxels = int64_t(small);
}

double share(int64_t part, int64_t whole) {
  return whole ? double(part) / double(whole) : 0;
}

std::string table(const std::vector<SweepRow>& rows) {
  std::ostringstream csv;
  csv << "gamma,merge,strictness,delta,theta,grains,median_voxels,small_grains,small_grains_share,"
         "small_grains_volume_share,largest_grain_volume_share,crumbs,specks,slivers,grains_in_"
         "pieces\n";
  csv.precision(9);
  for (const SweepRow& row : rows) {
    csv << row.gamma << ',' << toString(row.mode) << ',';
    if (row.mode == MergeMode::score)
      csv << row.strictness << ",,,";
    else
      csv << ',' << row.delta << ',' << row.theta << ',';
    csv << row.grains << ',' << row.medianVoxels << ',' << row.smallGrains << ','
        << share(row.smallGrains, row.grains) << ',' << share(row.smallVoxels, row.objectVoxels)
        << ',' << share(row.largestVoxels, row.objectVoxels) << ',' << row.flaws.crumbs << ','
        << row.flaws.specks << ',' << row.flaws.slivers << ',' << row.flaws.inPieces << '\n';
  }
  return csv.str();
}

/// Is it a file or a folder of slabs with manifolds, which are to be merged?
bool isOfManifolds(const SweepArguments& o, const Common& common) {
  if (!(isInSlabs(o.input) || hasVdbEnding(o.input.path)) ||
      !(o.input.gridName.empty() || o.input.gridName == kManifoldGrid))
    return false;
  return manifoldsAmong(readVdbHeaders(o.input.path, common.progress)) != nullptr;
}

/// What of the options does not concern manifolds. @throw WrongUsage
void checkManifoldOptions(const SweepArguments& o, const openvdb::MetaMap& manifolds) {
  const InputOptions& in = o.input;
  for (const auto& [text, name] : {std::pair<const std::string*, const char*>{&in.phase, "--phase"},
                                   {&in.threshold, "--threshold"},
                                   {&in.range, "--range"},
                                   {&in.median, "--median"},
                                   {&in.smooth, "--smooth"},
                                   {&in.despeckle, "--despeckle"},
                                   {&in.domainText, "--domain"},
                                   {&in.voxelSizeText, "--voxel-size"},
                                   {&in.roi, "--roi"},
                                   {&in.cropText, "--crop"},
                                   {&o.fillHoles, "--fill-holes"}})
    if (!text->empty())
      throw WrongUsage(in.path + ": the manifolds in it are merged as they are: leave " + name +
                       " out, or name a grid to segment: --grid grain");
  const auto gamma = manifolds.getMetadata<openvdb::Int64Metadata>("madf_gamma");
  const std::string stored = std::to_string(gamma ? gamma->value() : 0);
  if (in.invert || o.boundary != "auto" || (!o.gamma.empty() && o.gamma != stored))
    throw WrongUsage(in.path + ": the manifolds in it are those of gamma " + stored +
                     ": leave --gamma, --boundary and --invert out, or name a grid to segment: "
                     "--grid grain");
}

/// What there is to sweep, and the gamma of the manifolds.
SweepOptions manifoldOptions(const SweepArguments& o, const openvdb::MetaMap& manifolds) {
  checkManifoldOptions(o, manifolds);
  SweepOptions options = o.sweep;
  if (const auto gamma = manifolds.getMetadata<openvdb::Int64Metadata>("madf_gamma"))
    options.gammas = {gamma->value()};
  return options;
}

void refuseScratch(const SweepArguments& o) {
  if (!o.scratch.empty()) throw WrongUsage("--scratch is for manifolds in a folder of slabs");
}

/// The rows of the manifolds in a file, or in a folder of slabs.
std::vector<SweepRow> sweepManifolds(const SweepArguments& o, const Common& common) {
  if (!isInSlabs(o.input)) {
    refuseScratch(o);
    const Int32Grid::Ptr manifold =
        requiredManifolds(readVdb(o.input.path, manifoldsAlone(), common.progress), o.input.path);
    const SweepOptions options = manifoldOptions(o, *manifold);
    return withFileName(o.input.path,
                        [&] { return mergingSweep(*manifold, options, common.progress); });
  }
  const LabelSlabs manifolds = openManifoldSlabs(o.input, common.progress);
  const SweepOptions options = manifoldOptions(o, *manifolds.about);
  if (o.scratch.empty() && o.out == "-")
    throw WrongUsage("-: say where scratch data may be: --scratch DIR");
  ScratchFolder folder(o.scratch.empty() ? o.out + ".scratch" : o.scratch);
  return withFileName(o.input.path, [&] {
    return mergingSweep(manifolds, options, folder.scratch(), common.progress);
  });
}

std::vector<SweepRow> sweepObject(const SweepArguments& o, const Common& common) {
  refuseScratch(o);
  const MaskGrid::Ptr object = loadObject(o.input, common.progress);
  SweepOptions options = o.sweep;
  options.boundary = boundaryOf(o.boundary, o.input, *object, common.progress);
  options.maxMemory = availableMemory();
  return withFileName(o.input.path,
                      [&] { return parameterSweep(*object, options, common.progress); });
}

void runSweep(const SweepArguments& o, const Common& common) {
  TextFile csv(o.out), plot(o.plot);
  common.progress->start("read");
  const bool isOfStored = isOfManifolds(o, common);
  const std::vector<SweepRow> rows =
      isOfStored ? sweepManifolds(o, common) : sweepObject(o, common);
  OutputSet files;
  csv.write(table(rows));
  plot.write(sweepPlot(rows, o.sweep.smallVoxels, plotTypeOf(o.plot).value_or(PlotType::svg)));
  files.commit();
  common.progress->end();
  if (!common.quiet)
    std::printf("%s: %s, of %s\n", o.out.c_str(), counted(int64_t(rows.size()), "row").c_str(),
                isOfStored ? isInSlabs(o.input) ? "the manifolds in slabs" : "the manifolds"
                           : counted(int64_t(o.sweep.gammas.size()), "segmentation").c_str());
}

}  // namespace

void addSweep(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<SweepArguments>();
  Verb verb =
      addVerb(command, common, "sweep", "grains for many strictnesses, or theta, delta, gamma",
              "vdb_madf sweep scan.tif sweep.csv --phase 1 --plot sweep.svg");
  verb.option("IN", o->input.path, "any readable volume").required();
  verb.option("OUT.csv", o->out, "a line per gamma and strictness (or merge mode, delta and theta)")
      .required();
  o->input.addSelection(verb);
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  o->input.addDomain(verb);
  o->input.addRegion(verb);
  verb.option("--gamma", o->gamma, "list of gammas, voxels; one segmentation each (default: 0)")
      .typeName("LIST");
  verb.option("--strictness", o->strictness, "list of numbers and of ranges FIRST:LAST:STEP")
      .typeName("LIST")
      .showDefault();
  verb.option("--merge", o->merge, "list: score, or of the tests: both, angle, neck")
      .typeName("LIST")
      .offer({"score", "both", "angle", "neck"})
      .showDefault();
  verb.option("--theta", o->theta, "of the tests: list of cosines and of ranges")
      .typeName("LIST")
      .showDefault();
  verb.option("--delta", o->delta, "of the tests: list of tolerances, eighths of a voxel")
      .typeName("LIST")
      .showDefault();
  addMinGrain(verb, o->minGrain);
  addFillHoles(verb, o->fillHoles);
  addTidy(verb, o->tidy);
  verb.option("--adjacency", o->adjacency, "what the angle test pairs: manifold, cell")
      .oneOf({"manifold", "cell"})
      .showDefault();
  addBoundary(verb, o->boundary);
  verb.option("--small", o->small, "a grain of fewer voxels counts as small")
      .typeName("N")
      .showDefault();
  verb.option("--plot", o->plot,
              "draws grains, median size and share of small ones: .svg, .pdf or .png")
      .typeName("FILE");
  verb.option("--scratch", o->scratch,
              "manifolds in slabs: folder for what is read of them (default: OUT.csv.scratch)")
      .typeName("DIR");
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] { runSweep(*o, besideOutput(besideOutput(common, o->out), o->plot)); };
  });
}

}  // namespace vdb_madf::tools
