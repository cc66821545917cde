// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "merge_options.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "parse.h"
#include "vdb_madf/method/tidy.h"
#include "wrong_usage.h"

namespace vdb_madf::tools {

void MergeArguments::add(Verb verb) {
  verb.option("--strictness", strictness,
              "least score that joins pieces; larger: more grains (default 11); auto: most stable")
      .typeName("K");
  verb.option("--merge", mode, "by score, or by tests: both, angle, neck (default score)")
      .oneOf({"score", "both", "angle", "neck"});
  verb.option("--theta", theta,
              "of the tests: merge balls that meet at a cosine below T, -1..1 (default -0.9)")
      .typeName("T");
  verb.option("--delta", delta,
              "of both and neck: merge where the neck is under K/8 voxel narrower (default 2)")
      .typeName("K");
  verb.option("--adjacency", adjacency,
              "of both and angle: what the test pairs: manifold, cell (default manifold)")
      .oneOf({"manifold", "cell"});
  addMinGrain(verb, minGrain);
}

MergeOptions MergeArguments::parse() const {
  MergeOptions options;
  options.minGrain = parseMinGrain(minGrain);
  if (mode.empty() || mode == "score") {
    for (const auto& [text, name] : {std::pair<const std::string*, const char*>{&theta, "--theta"},
                                     {&delta, "--delta"},
                                     {&adjacency, "--adjacency"}})
      if (!text->empty()) refuseOptionOfTests(name);
    if (!strictness.empty() && !isAutomatic()) options.strictness = parseStrictness(strictness);
    return options;
  }
  if (!strictness.empty()) refuseStrictness(mode);
  if (!theta.empty()) options.theta = parseNumber(theta, "--theta");
  if (!(options.theta >= -1 && options.theta <= 1))
    throw WrongUsage("--theta " + theta + ": is a cosine, it must lie between -1 and 1");
  options.mode = mode == "angle"  ? MergeMode::angle
                 : mode == "neck" ? MergeMode::neck
                                  : MergeMode::both;
  if (adjacency == "cell") options.adjacency = Adjacency::cell;
  if (!delta.empty()) options.delta = parseDelta(delta);
  return options;
}

std::string textOf(const StableStrictness& stable, const std::string& indentOfSecond) {
  const auto& plateau = stable.plateau;
  return fmt::format("auto: {:g}, of 8 to 14 where grains are most stable;\n{}", stable.strictness,
                     indentOfSecond) +
         (plateau ? fmt::format("the number of grains changes by less than 5 % from {:g} to {:g}",
                                plateau->first, plateau->second)
                  : "nowhere does the number of grains stay within 5 % over 1: no preferred scale");
}

void refuseOptionOfTests(const std::string& name) {
  throw WrongUsage(name +
                   ": belongs to the tests: add --merge both (or angle, neck); the default, score, "
                   "has --strictness");
}

void refuseStrictness(const std::string& mode) {
  throw WrongUsage("--strictness: belongs to --merge score, not " + mode);
}

int parseDelta(const std::string& text) {
  const int64_t delta = parseCount(text, "--delta");
  if (delta > kMaxDelta)
    throw WrongUsage(fmt::format(
        "--delta {}: is in eighths of a voxel, it must lie between 0 and {}", text, kMaxDelta));
  return int(delta);
}

double parseStrictness(const std::string& text, const std::string& option) {
  const double strictness = parseNumber(text, option);
  if (!(std::abs(strictness) <= kMaxStrictness))
    throw WrongUsage(option + " " + text + ": must lie between -200000 and 200000");
  return strictness;
}

void addMinGrain(Verb verb, std::string& text) {
  verb.option("--min-grain", text,
              "join grains of fewer voxels to the neighbor of most shared faces (default 0)")
      .typeName("N");
}

int64_t parseMinGrain(const std::string& text) {
  return text.empty() ? 0 : parseCount(text, "--min-grain");
}

void addFillHoles(Verb verb, std::string& text) {
  verb.option(
          "--fill-holes", text,
          "fill cavities of fewer voxels for the distance; 0: none (default 27; 0 for one slice)")
      .typeName("N");
}

std::optional<int64_t> parseFillHoles(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return parseCount(text, "--fill-holes");
}

void addTidy(Verb verb, std::string& text) {
  verb.option("--tidy", text,
              "rounds that smooth interfaces, then one piece a grain; 0: neither (default 2)")
      .typeName("N");
}

int parseTidy(const std::string& text) {
  const int64_t rounds = text.empty() ? kTidy : parseCount(text, "--tidy");
  if (rounds > kMaxTidy)
    throw WrongUsage(fmt::format("--tidy {}: at most {} rounds", text, kMaxTidy));
  return int(rounds);
}

}  // namespace vdb_madf::tools
