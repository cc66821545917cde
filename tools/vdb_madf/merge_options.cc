// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "merge_options.h"

#include "parse.h"
#include "wrong_usage.h"

namespace vdb_madf::tools {

void MergeArguments::add(Verb verb) {
  verb.option("--theta", theta, "merge balls that meet at a cosine below T, -1..1 (default -0.9)")
      .typeName("T");
  verb.option("--merge", mode, "tests: both, angle (the paper's), neck (default both)")
      .oneOf({"both", "angle", "neck"});
  verb.option("--adjacency", adjacency,
              "what the angle test pairs: manifold, cell (default manifold)")
      .oneOf({"manifold", "cell"});
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

}  // namespace vdb_madf::tools
