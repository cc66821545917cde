// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_grains.h"

#include <utility>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

SlabGrains::SlabGrains(SlabWork& work, SlabGraph graph, const VoxelWeights& weights) : work_(work) {
  graph.finish();
  for (size_t s = 0; s < graph.slabCount(); ++s)
    if (graph.isShared(s)) graph.tellShared(s, terminals(s).points);
  MergeParts merging(MergeRule(work.options.merge, weights));
  SlabTerminals here, next;
  std::vector<ManifoldGraph::Edge> below, above;
  for (size_t s = 0; s < graph.slabCount(); ++s) {
    if (work.interrupter && work.interrupter->wasInterrupted(75)) throw Interrupted();
    here = s == 0 ? terminals(s) : std::move(next);
    next = s + 1 < graph.slabCount() ? terminals(s + 1) : SlabTerminals();
    below = std::move(above);
    above = SlabTerminals::contacts(here.highest, next.lowest);
    const SlabGraph::Part part = graph.nextPart(here, below, above);
    const std::vector<uint32_t> classOfNode = merging.add(part);
    if (work.has("classes", s)) continue;
    std::vector<uint32_t> classes;
    for (const uint32_t node : part.nodeOf) classes.push_back(classOfNode[node]);
    work.writeVector("classes", s, classes);
  }
  grains_ = merging.finish();
}

SlabTerminals SlabGrains::terminals(size_t slab) const {
  ByteReader bytes = work_.read("terminals", slab);
  return SlabTerminals::readFrom(bytes);
}

std::vector<uint32_t> SlabGrains::grainsOf(size_t slab) const {
  auto grains = work_.readVector<uint32_t>("classes", slab);
  for (uint32_t& grain : grains) grain = grains_.grainOfClass[grain];
  return grains;
}

}  // namespace vdb_madf::detail
