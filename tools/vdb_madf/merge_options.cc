// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "merge_options.h"

#include <charconv>

#include "command.h"
#include "input.h"

namespace vdb_madf::tools {

void MergeArguments::add(CLI::App& verb) {
  verb.add_option("--theta", theta,
                  "merge balls that meet at a cosine below T, -1..1 (default -0.9)")
      ->type_name("T");
  verb.add_option("--merge", mode, "tests: both, angle (the paper's), neck (default both)")
      ->check(CLI::IsMember({"both", "angle", "neck"}));
  verb.add_option("--adjacency", adjacency,
                  "what the angle test pairs: manifold, cell (default manifold)")
      ->check(CLI::IsMember({"manifold", "cell"}));
}

MergeOptions MergeArguments::parse() const {
  MergeOptions options;
  if (!theta.empty()) options.theta = parseNumber(theta, "--theta");
  if (!(options.theta >= -1 && options.theta <= 1))
    throw WrongUsage("--theta " + theta + ": is a cosine, it must lie between -1 and 1");
  if (mode == "angle") options.mode = MergeMode::angle;
  if (mode == "neck") options.mode = MergeMode::neck;
  if (adjacency == "cell") options.adjacency = Adjacency::cell;
  return options;
}

int64_t parseGamma(const std::string& text) {
  int64_t gamma = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), gamma);
  if (error != std::errc() || end != text.data() + text.size() || gamma < 0)
    throw WrongUsage("--gamma " + text + ": must be a whole number of voxels, 0 or more");
  return gamma;
}

}  // namespace vdb_madf::tools
