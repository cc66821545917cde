// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_grains.h"

#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/slabs/detail/point_numbers.h"

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

/// Those of the terminals of a slab that are critical points, which lie in it.
std::vector<Coord> criticalPoints(const SlabWork& work, size_t slab,
                                  const std::vector<CriticalPoint>& points) {
  std::vector<Coord> critical;
  for (const CriticalPoint& point : points)
    if (work.slabOf(point.position.z()) == slab) critical.push_back(point.position);
  return critical;
}

/// Numbers the critical points of all slabs, if manifolds are kept: the pieces "numbers".
void numberPoints(SlabWork& work, size_t slabs) {
  if (!work.options.keepManifold) return;
  PointNumbers numbers;
  for (size_t s = 0; s < slabs; ++s)
    numbers.count(criticalPoints(work, s, terminals(work, s).points));
  numbers.finish();
  for (size_t s = 0; s < slabs; ++s) {
    const std::vector<CriticalPoint> points = terminals(work, s).points;
    const std::vector<uint32_t> own = numbers.next(criticalPoints(work, s, points));
    auto next = own.begin();
    std::vector<uint32_t> of;
    for (const CriticalPoint& point : points)
      of.push_back(work.slabOf(point.position.z()) == s ? *next++ : 0);
    work.writeVector("numbers", s, of);
  }
}

/// Of the terminals of a slab; 0: none of its critical points. Empty: manifolds are not kept.
std::vector<uint32_t> numbersOf(const SlabWork& work, size_t slab) {
  if (!work.options.keepManifold) return {};
  return work.readVector<uint32_t>("numbers", slab);
}

}  // namespace

std::vector<Coord> mergeParts(SlabWork& work, size_t slabs,
                              const std::function<SlabGraph::Part(size_t slab)>& nextPart) {
  MergeParts merging(MergeRule(work.options.merge, work.weights));
  for (size_t s = 0; s < slabs; ++s) {
    if (work.interrupter && work.interrupter->wasInterrupted(75)) throw Interrupted();
    const SlabGraph::Part part = nextPart(s);
    const std::vector<uint32_t> classOfNode = merging.add(part);
    if (work.has("classes", s)) continue;
    std::vector<uint32_t> classes;
    for (const uint32_t node : part.nodeOf) classes.push_back(classOfNode[node]);
    work.writeVector("classes", s, classes);
  }
  PartGrains grains = merging.finish();
  for (size_t s = 0; s < slabs; ++s) {
    auto grainOf = work.readVector<uint32_t>("classes", s);
    for (uint32_t& grain : grainOf) grain = grains.grainOfClass[grain];
    work.sendVector(kGrainsOfTerminals, SlabWork::kRoot, s, grainOf);
  }
  return std::move(grains.representative);
}

std::vector<Coord> mergeSlabs(SlabWork& work, SlabGraph graph) {
  graph.finish();
  numberPoints(work, graph.slabCount());
  for (size_t s = 0; s < graph.slabCount(); ++s)
    if (graph.isShared(s)) graph.tellShared(s, terminals(work, s).points, numbersOf(work, s));
  return mergeParts(work, graph.slabCount(), [&](size_t s) {
    SlabGraph::Part part = graph.nextPart(terminals(work, s), numbersOf(work, s), contacts(work, s),
                                          contacts(work, s + 1));
    if (work.options.keepManifold) {
      ByteWriter bytes;
      addPart(part, bytes);
      work.send(kGraphPart, SlabWork::kRoot, s, bytes);
    }
    return part;
  });
}

void addPart(const SlabGraph::Part& part, ByteWriter& bytes) {
  bytes.add(part.graph.nodes);
  bytes.add(part.graph.edges);
  bytes.add(part.number);
  bytes.add(part.goesOn);
  bytes.add(part.nodeOf);
}

SlabGraph::Part readPart(ByteReader bytes) {
  SlabGraph::Part part;
  part.graph.nodes = bytes.vector<CriticalPoint>();
  part.graph.edges = bytes.vector<ManifoldGraph::Edge>();
  part.number = bytes.vector<uint32_t>();
  part.goesOn = bytes.vector<char>();
  part.nodeOf = bytes.vector<uint32_t>();
  return part;
}

}  // namespace vdb_madf::detail
