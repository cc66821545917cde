// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/measure_stability.h"

#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/grain_lives.h"
#include "vdb_madf/method/hierarchy.h"
#include "vdb_madf/method/merge.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf {

void measureStability(const ManifoldGraph& graph, Measurements& measurements) {
  const auto stored = storedMerging(measurements.metadata);
  if (!stored || stored->options.mode != MergeMode::score)
    throw InvalidInput(
        "the stability is that of grains merged by score, and these are not, or do not say it: "
        "segment or remerge them with --merge score");
  if (measurements.metadata[kEditsKey])
    throw InvalidInput(
        "the stability is that of grains as they were segmented, and these were edited: measure "
        "it without the edits");
  checkMergeOptions(stored->options);
  const std::vector<uint32_t> nodes = merge(graph, stored->options).representative;
  auto& grains = measurements.grains;
  if (grains.size() != nodes.size() ||
      (!grains.empty() && size_t(grains.back().id) != nodes.size()))
    throw InvalidInput("the labels have " + std::to_string(grains.size()) +
                       " grains, their manifolds " + std::to_string(nodes.size()) +
                       " at this strictness: take both of one segmentation");
  const GrainLives lives(mergeHierarchy(graph), stored->options.strictness);
  const auto nodeOf = [&](int32_t id) { return nodes[size_t(id) - 1]; };
  for (GrainMeasures& grain : grains) grain.life = lives.of(nodeOf(grain.id));
  for (BondMeasures& bond : measurements.bonds)
    bond.vanishes = lives.joinedAt(nodeOf(bond.first), nodeOf(bond.second));
  measurements.extra.stability = true;
}

}  // namespace vdb_madf
