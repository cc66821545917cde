// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_grains.h"

#include <utility>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

SlabTerminals terminals(const SlabWork& work, size_t slab) {
  ByteReader bytes = work.receive("terminals", slab, SlabWork::kRoot);
  return SlabTerminals::readFrom(bytes);
}

/// Of a slab to the one below it; none above the highest.
std::vector<ManifoldGraph::Edge> contacts(const SlabWork& work, size_t slab) {
  return work.receiveVector<ManifoldGraph::Edge>("contacts", slab, SlabWork::kRoot);
}

}  // namespace

std::vector<Coord> mergeSlabs(SlabWork& work, SlabGraph graph) {
  graph.finish();
  for (size_t s = 0; s < graph.slabCount(); ++s)
    if (graph.isShared(s)) graph.tellShared(s, terminals(work, s).points);
  MergeParts merging(MergeRule(work.options.merge, work.weights));
  for (size_t s = 0; s < graph.slabCount(); ++s) {
    if (work.interrupter && work.interrupter->wasInterrupted(75)) throw Interrupted();
    const SlabGraph::Part part =
        graph.nextPart(terminals(work, s), contacts(work, s), contacts(work, s + 1));
    const std::vector<uint32_t> classOfNode = merging.add(part);
    if (work.has("classes", s)) continue;
    std::vector<uint32_t> classes;
    for (const uint32_t node : part.nodeOf) classes.push_back(classOfNode[node]);
    work.writeVector("classes", s, classes);
  }
  PartGrains grains = merging.finish();
  for (size_t s = 0; s < graph.slabCount(); ++s) {
    auto grainOf = work.readVector<uint32_t>("classes", s);
    for (uint32_t& grain : grainOf) grain = grains.grainOfClass[grain];
    work.sendVector(kGrainsOfTerminals, SlabWork::kRoot, s, grainOf);
  }
  return std::move(grains.representative);
}

}  // namespace vdb_madf::detail
