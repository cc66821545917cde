// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "measure_arguments.h"

#include <fmt/core.h>

#include "command.h"
#include "outputs.h"
#include "parse.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/measure/bootstrap.h"
#include "vdb_madf/pictures/measures_plot.h"
#include "wrong_usage.h"

namespace vdb_madf::tools {

namespace {

int parseTimes(const std::string& text, const std::string& option, int least, int most) {
  const int64_t times = parseCount(text, option);
  if (times < least || times > most)
    throw WrongUsage(fmt::format("{} {}: must be from {} to {}", option, text, least, most));
  return int(times);
}

/// --vary threshold:T,smooth:S,strictness:K,gamma:G, or some of these.
void parseVary(const std::string& text, SensitivityOptions& options) {
  for (const std::string& item : split(text, ',')) {
    const size_t colon = item.find(':');
    const std::string name = item.substr(0, colon);
    const std::string value = colon == std::string::npos ? "" : item.substr(colon + 1);
    const std::string about = "--vary " + name;
    const bool isWhole = name == "gamma";
    if (!options.vary(name, 0))
      throw WrongUsage("--vary " + text +
                       ": write threshold:T,smooth:S,strictness:K,gamma:G, or some of these");
    const double number = isWhole ? double(parseCount(value, about)) : parseNumber(value, about);
    try {
      options.vary(name, number);
    } catch (const InvalidInput& error) {
      throw WrongUsage(about + ":" + value + ": " + error.what());
    }
  }
}

void parseSensitivity(MeasureArguments& o) {
  if (o.runs.empty()) {
    if (!o.vary.empty()) throw WrongUsage("--vary says how far --sensitivity goes: give it, too");
    return;
  }
  if (o.gray.path.empty())
    throw WrongUsage("--sensitivity segments the scan again: give it with --gray SCAN");
  o.sensitivity.emplace();
  o.sensitivity->runs = parseTimes(o.runs, "--sensitivity", kMinRuns, kMaxRuns);
  o.sensitivity->measure = o.measure;
  if (!o.vary.empty()) parseVary(o.vary, *o.sensitivity);
}

void parseBinder(MeasureArguments& o) {
  if (!o.bridges.empty()) checkTableEnding(o.bridges);
  if (o.phases.path.empty() != o.bridges.empty())
    throw WrongUsage("--phases MAP and --bridges FILE.csv go together: give both");
  if (!o.binderText.empty()) {
    if (o.phases.path.empty())
      throw WrongUsage("--binder is a value of a map of phases: give --phases, too");
    o.binder = parseCount(o.binderText, "--binder");
  }
}

}  // namespace

void parse(MeasureArguments& o) {
  o.input.outputs = MeasurementTables::paths(o.folder);
  o.input.outputs.push_back(o.plot);
  o.input.outputs.push_back(o.sizeCurve);
  o.input.outputs.push_back(o.bridges);
  parseBinder(o);
  if (!o.sizeCurve.empty()) checkTableEnding(o.sizeCurve);
  if (!o.sizeReference.empty()) checkOutputs(o.input.outputs, o.sizeReference);
  o.measure.sizes = !o.sizeCurve.empty();
  if (!o.plot.empty() && !plotTypeOf(o.plot))
    throw WrongUsage(o.plot + ": the plot's ending must be .svg, .pdf or .png");
  o.input.parse();
  o.tables.density = parseDensity(o.ice, o.density);
  if (o.stability && !hasVdbEnding(o.input.path) && !hasSlabsEnding(o.input.path) &&
      !isInSlabs(o.input))
    throw WrongUsage(o.input.path +
                     ": --stability needs what segment --keep manifold keeps, in .vdb or .slabs");
  checkScan(o.intensity, o.input);
  checkScan(o.gray, o.input);
  checkScan(o.phases, o.input);
  o.measure.boundary = parseBoundary(o.boundary);
  o.measure.minFaces = parseCount(o.minFaces, "--min-faces");
  if (!o.bootstrap.empty())
    o.measure.bootstrap = parseTimes(o.bootstrap, "--bootstrap", kMinReplicates, kMaxReplicates);
  parseSensitivity(o);
}

}  // namespace vdb_madf::tools
