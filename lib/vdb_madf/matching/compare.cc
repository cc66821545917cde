// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/compare.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/labels/detail/slab_window.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

using Root = Int32Tree::RootNodeType;
using Leaf = Int32Tree::LeafNodeType;
/// Exact sums of pairs of voxels: 10^11 voxels have 5 * 10^21 pairs.
using PairCount = unsigned __int128;

/// 0: no label.
int32_t label(int32_t value, bool active) {
  return active && value > 0 ? value : 0;
}

/// A part of a tree: a node, or (if null) one label throughout.
template <typename Node>
struct Part {
  const Node* node = nullptr;
  int32_t constant = 0;
};

/// Voxels by (truth label, test label), either of them 0 where only the other one is labelled.
class Counts {
 public:
  void add(int32_t truth, int32_t test, int64_t voxels) {
    if (truth || test) counts_[uint64_t(uint32_t(truth)) << 32 | uint32_t(test)] += voxels;
  }
  void add(const Counts& other) {
    for (const auto& [key, voxels] : other.counts_) counts_[key] += voxels;
  }

  /// By truth, then by test.
  std::vector<Overlap> sorted() const {
    std::vector<Overlap> entries;
    for (const auto& [key, voxels] : counts_)
      entries.push_back({int32_t(key >> 32), int32_t(key & 0xffffffffu), voxels});
    std::sort(entries.begin(), entries.end(), [](const Overlap& a, const Overlap& b) {
      return a.truth != b.truth ? a.truth < b.truth : a.test < b.test;
    });
    return entries;
  }

 private:
  std::unordered_map<uint64_t, int64_t> counts_;
};

/// Walks both trees side by side. Tiles are counted whole wherever the other tree is constant too;
/// the leaves that remain are counted in parallel. (LabelLeaves and LabelBlocks walk one grid, and
/// make leaves of its tiles.)
class OverlapCounter {
 public:
  Counts count(const Root& truth, const Root& test, Interrupter* interrupter) {
    visitRoots(truth, test);
    detail::parallelFor(leaves_.size(), detail::kLightLeafGrain, interrupter,
                        [&](size_t begin, size_t end) {
                          Counts local;
                          for (size_t i = begin; i < end; ++i)
                            countLeaves(leaves_[i].truth, leaves_[i].test, local);
                          // Integer sums: the order in which the parts arrive does not matter.
                          const std::lock_guard<std::mutex> lock(mutex_);
                          counts_.add(local);
                        });
    return std::move(counts_);
  }

 private:
  using Upper = Root::ChildNodeType;
  struct LeafPair {
    Part<Leaf> truth, test;
  };

  /// The root is a table of nodes and tiles by origin, everything else is background.
  static void collect(const Root& root, std::map<Coord, Part<Upper>>& parts) {
    for (auto child = root.cbeginChildOn(); child; ++child) parts[child.getCoord()].node = &*child;
    for (auto tile = root.cbeginValueOn(); tile; ++tile)
      parts[tile.getCoord()].constant = label(*tile, true);
  }

  void visitRoots(const Root& truth, const Root& test) {
    std::map<Coord, Part<Upper>> truths, tests;
    collect(truth, truths);
    collect(test, tests);
    for (const auto& [origin, part] : truths) {
      const auto other = tests.find(origin);
      visit(part, other == tests.end() ? Part<Upper>() : other->second);
    }
    for (const auto& [origin, part] : tests)
      if (truths.find(origin) == truths.end()) visit(Part<Upper>(), part);
  }

  template <typename Node>
  static Part<typename Node::ChildNodeType> child(const Part<Node>& part, openvdb::Index n) {
    if (!part.node) return {nullptr, part.constant};
    const auto& entry = part.node->getTable()[n];
    if (part.node->isChildMaskOn(n)) return {entry.getChild(), 0};
    return {nullptr, label(entry.getValue(), part.node->isValueMaskOn(n))};
  }

  template <typename Node>
  void visit(const Part<Node>& truth, const Part<Node>& test) {
    if (!truth.node && !test.node)
      return counts_.add(truth.constant, test.constant, int64_t(Node::NUM_VOXELS));
    for (openvdb::Index n = 0; n < Node::NUM_VALUES; ++n) visit(child(truth, n), child(test, n));
  }

  void visit(const Part<Leaf>& truth, const Part<Leaf>& test) {
    if (!truth.node && !test.node)
      return counts_.add(truth.constant, test.constant, int64_t(Leaf::NUM_VOXELS));
    leaves_.push_back({truth, test});
  }

  static void labels(const Part<Leaf>& part, int32_t* values) {
    std::fill(values, values + Leaf::SIZE, part.constant);
    if (!part.node) return;
    for (auto voxel = part.node->cbeginValueOn(); voxel; ++voxel)
      values[voxel.pos()] = label(*voxel, true);
  }

  static void countLeaves(const Part<Leaf>& truth, const Part<Leaf>& test, Counts& counts) {
    int32_t truths[Leaf::SIZE], tests[Leaf::SIZE];
    labels(truth, truths);
    labels(test, tests);
    // Neighbours mostly share their labels: one look-up for a run.
    for (int begin = 0, end; begin < int(Leaf::SIZE); begin = end) {
      end = begin + 1;
      while (end < int(Leaf::SIZE) && truths[end] == truths[begin] && tests[end] == tests[begin])
        ++end;
      counts.add(truths[begin], tests[begin], end - begin);
    }
  }

  std::vector<LeafPair> leaves_;
  std::mutex mutex_;
  Counts counts_;
};

/// Counts the voxels of two windows of slabs with the same layers.
Counts countWindow(const detail::LabelLeaves& truth, const detail::LabelLeaves& test,
                   Interrupter* interrupter) {
  Counts counts;
  std::mutex mutex;
  const LeafIndex &truths = truth.index(), &tests = test.index();
  const auto only = [](const detail::LabelPart& part, const LeafIndex& others, const auto& leaf) {
    return int64_t(
        detail::countVoxels(leaf ? detail::without(part.mask, others.mask(*leaf)) : part.mask));
  };
  detail::parallelFor(
      truths.leafCount(), detail::kLightLeafGrain, interrupter, [&](size_t begin, size_t end) {
        Counts local;
        for (size_t i = begin; i < end; ++i) {
          const auto other = tests.findLeaf(truths.origin(i));
          for (const detail::LabelPart& part : truth.parts(i)) {
            if (const int64_t voxels = only(part, tests, other)) local.add(part.label, 0, voxels);
            if (!other) continue;
            for (const detail::LabelPart& met : test.parts(*other))
              if (const int64_t voxels = detail::countVoxels(detail::both(part.mask, met.mask)))
                local.add(part.label, met.label, voxels);
          }
        }
        const std::lock_guard<std::mutex> lock(mutex);
        counts.add(local);
      });
  for (size_t i = 0; i < tests.leafCount(); ++i) {
    const auto other = truths.findLeaf(tests.origin(i));
    for (const detail::LabelPart& part : test.parts(i))
      if (const int64_t voxels = only(part, truths, other)) counts.add(0, part.label, voxels);
  }
  return counts;
}

/// The grains of one grid, gathered from the overlaps.
struct Grains {
  std::map<int32_t, GrainMatch> matches;
  std::map<int32_t, int64_t> common;  ///< voxels labelled in both grids, where there are any

  void add(int32_t grain, int32_t other, int64_t voxels) {
    if (!grain) return;
    GrainMatch& match = matches[grain];
    match.grain = grain;
    match.voxels += voxels;
    if (!other) return;
    common[grain] += voxels;
    if (voxels > match.overlapVoxels) {  // the first of equals: overlaps come in ascending order
      match.partner = other;
      match.overlapVoxels = voxels;
    }
  }
};

/// What a grain's match says of the partner: known once all overlaps are added.
void link(Grains& grains, Grains& others) {
  for (auto& [id, match] : grains.matches) {
    if (!match.partner) continue;
    GrainMatch& partner = others.matches[match.partner];
    ++partner.pieces;
    match.intersectionOverUnion =
        double(match.overlapVoxels) / double(match.voxels + partner.voxels - match.overlapVoxels);
  }
}

std::vector<GrainMatch> listed(const std::map<int32_t, GrainMatch>& matches) {
  std::vector<GrainMatch> list;
  for (const auto& [id, match] : matches) list.push_back(match);
  return list;
}

int64_t countBroken(const std::vector<GrainMatch>& matches) {
  return std::count_if(matches.begin(), matches.end(),
                       [](const GrainMatch& match) { return match.pieces > 1; });
}

/// The broken grains of `matches` with their pieces among `others`.
std::vector<GrainGroup> groups(const std::vector<GrainMatch>& matches,
                               const std::vector<GrainMatch>& others) {
  std::map<int32_t, std::vector<int32_t>> parts;
  for (const GrainMatch& other : others) parts[other.partner].push_back(other.grain);
  std::vector<GrainGroup> result;
  for (const GrainMatch& match : matches)
    if (match.pieces > 1) result.push_back({match.grain, parts[match.grain]});
  return result;
}

PairCount pairs(int64_t voxels) {
  return voxels < 2 ? 0 : PairCount(voxels) * PairCount(voxels - 1) / 2;
}

double misclassifiedPercent(const Grains& grains, int64_t common) {
  int64_t voxels = common;
  for (const auto& [id, match] : grains.matches) voxels -= match.overlapVoxels;
  return common ? 100.0 * double(voxels) / double(common) : 0.0;
}

double adjustedRandIndex(const std::vector<Overlap>& overlaps, const Grains& truths,
                         const Grains& tests, int64_t voxels) {
  PairCount together = 0, inTruth = 0, inTest = 0;
  for (const Overlap& overlap : overlaps)
    if (overlap.truth && overlap.test) together += pairs(overlap.voxels);
  for (const auto& [id, common] : truths.common) inTruth += pairs(common);
  for (const auto& [id, common] : tests.common) inTest += pairs(common);
  // One class on both sides, or single voxels on both: the index is 0/0, the partitions agree.
  const PairCount all = pairs(voxels);
  if (inTruth == inTest && (inTruth == 0 || inTruth == all)) return 1;
  const double expected = double(inTruth) * (double(inTest) / double(all));
  const double greatest = 0.5 * double(inTruth + inTest);
  return (double(together) - expected) / (greatest - expected);
}

void addVariation(const Grains& truths, const Grains& tests, Comparison& result) {
  for (const Overlap& overlap : result.overlaps) {
    if (!overlap.truth || !overlap.test) continue;
    const double share = double(overlap.voxels) / double(result.commonVoxels);
    const auto voxels = double(overlap.voxels);
    result.variationSplit += share * std::log2(double(truths.common.at(overlap.truth)) / voxels);
    result.variationMerge += share * std::log2(double(tests.common.at(overlap.test)) / voxels);
  }
  result.variationOfInformation = result.variationSplit + result.variationMerge;
}

void addMatches(Grains& truths, Grains& tests, Comparison& result) {
  link(truths, tests);
  link(tests, truths);
  result.truthMatches = listed(truths.matches);
  result.testMatches = listed(tests.matches);
  result.splits = countBroken(result.truthMatches);
  result.merges = countBroken(result.testMatches);
  double sum = 0;
  for (const GrainMatch& match : result.truthMatches) {
    result.foundGrains += match.intersectionOverUnion > 0.5;
    sum += match.intersectionOverUnion;
  }
  if (result.truthGrains) result.meanIntersectionOverUnion = sum / double(result.truthGrains);
}

Comparison comparisonOf(std::vector<Overlap> overlaps) {
  Comparison result;
  result.overlaps = std::move(overlaps);
  Grains truths, tests;
  for (const Overlap& overlap : result.overlaps) {
    truths.add(overlap.truth, overlap.test, overlap.voxels);
    tests.add(overlap.test, overlap.truth, overlap.voxels);
    (overlap.truth && overlap.test ? result.commonVoxels
     : overlap.truth               ? result.truthOnlyVoxels
                                   : result.testOnlyVoxels) += overlap.voxels;
  }
  result.truthGrains = int64_t(truths.matches.size());
  result.testGrains = int64_t(tests.matches.size());
  result.misclassifiedPercent = misclassifiedPercent(truths, result.commonVoxels);
  result.mirrorMisclassifiedPercent = misclassifiedPercent(tests, result.commonVoxels);
  result.adjustedRandIndex = adjustedRandIndex(result.overlaps, truths, tests, result.commonVoxels);
  addVariation(truths, tests, result);
  addMatches(truths, tests, result);
  return result;
}

}  // namespace

std::vector<GrainGroup> splits(const Comparison& comparison) {
  return groups(comparison.truthMatches, comparison.testMatches);
}

std::vector<GrainGroup> merges(const Comparison& comparison) {
  return groups(comparison.testMatches, comparison.truthMatches);
}

Comparison compare(const Int32Grid& truth, const Int32Grid& test, Interrupter* interrupter) {
  return comparisonOf(
      OverlapCounter().count(truth.tree().root(), test.tree().root(), interrupter).sorted());
}

Comparison compare(const LabelSlabs& truth, const LabelSlabs& test, Interrupter* interrupter) {
  std::vector<int> cuts = truth.cuts;
  cuts.insert(cuts.end(), test.cuts.begin(), test.cuts.end());
  std::sort(cuts.begin(), cuts.end());
  detail::SlabWindow truths(truth), tests(test);
  Counts counts;
  for (size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (cuts[i] == cuts[i + 1]) continue;
    const int done = int(100 * i / cuts.size());
    detail::WorkPart part(interrupter, done, done);
    const detail::LeafLayers layers{cuts[i], cuts[i + 1]};
    counts.add(countWindow(truths.leaves(layers, &part), tests.leaves(layers, &part), &part));
  }
  return comparisonOf(counts.sorted());
}

}  // namespace vdb_madf
