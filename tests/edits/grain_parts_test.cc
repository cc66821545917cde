// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/edits/detail/grain_parts.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/edits.h"
#include "support/naive_neck.h"
#include "support/oracle.h"
#include "support/random_case.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/edits/edit_labels.h"
#include "vdb_madf/labels/label_digest.h"
#include "vdb_madf/labels/label_sizes.h"
#include "vdb_madf/method/hierarchy.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

using Nodes = std::vector<uint32_t>;

/// By the definition: sets of classes, voxels counted anew.
std::optional<std::vector<char>> naiveJoin(const ManifoldGraph& graph, double strictness,
                                           const Nodes& nodes, const std::vector<int64_t>& voxels) {
  const Hierarchy hierarchy = mergeHierarchy(graph, strictness);
  using Classes = std::set<uint32_t>;
  std::map<uint32_t, Classes> sets;  // of each class the set that it is in
  for (uint32_t c = 0; c < hierarchy.classes.size(); ++c) sets[c] = {c};
  const auto count = [&](const Classes& classes) {
    int64_t sum = 0;
    for (size_t i = 0; i < nodes.size(); ++i)
      if (classes.count(hierarchy.classOfNode[nodes[i]])) sum += voxels[i];
    return sum;
  };
  std::array<Classes, 2> last;
  for (const Hierarchy::Join& join : hierarchy.joins) {
    const std::array<Classes, 2> two{sets[join.first], sets[join.second]};
    if (count(two[0]) > 0 && count(two[1]) > 0) last = two;
    Classes both = two[0];
    both.insert(two[1].begin(), two[1].end());
    for (const uint32_t c : both) sets[c] = both;
  }
  int64_t all = 0;
  for (const int64_t its : voxels) all += its;
  if (last[0].empty() || count(last[0]) + count(last[1]) < all) return std::nullopt;
  const auto isIn = [&](size_t side, uint32_t node) {
    return last[side].count(hierarchy.classOfNode[node]) > 0;
  };
  uint32_t largest = nodes[0];
  for (const uint32_t node : nodes)
    if (graph.nodes[node].squaredRadius > graph.nodes[largest].squaredRadius) largest = node;
  std::vector<char> beyond;
  for (const uint32_t node : nodes) beyond.push_back(isIn(isIn(1, largest) ? 0 : 1, node));
  return beyond;
}

struct Sample {
  ObjectVolume object;
  Segmentation segmentation;
  SegmentOptions options;
};

/// Grains of several manifolds.
Sample sampleOf(uint64_t seed) {
  Rng rng(seed);
  constexpr VolumeKind kKinds[] = {VolumeKind::ballUnion, VolumeKind::roughBalls,
                                   VolumeKind::blurredNoise, VolumeKind::boxUnion,
                                   VolumeKind::pinholes};
  Sample sample;
  sample.object = randomVolume(kKinds[seed % 5], boxAt(randomOrigin(rng), {26, 24, 22}), rng);
  sample.options.keepManifold = true;
  sample.options.tidy = int(seed % 3);
  sample.options.merge.mode = MergeMode(rng.below(4));
  sample.options.merge.strictness = rng.between(4, 14);
  sample.options.merge.theta = rng.chance(0.4) ? -0.95 : rng.chance(0.5) ? -0.5 : 1;
  sample.options.merge.delta = rng.below(5);
  if (rng.chance(0.3)) sample.options.gamma = 9;
  if (rng.chance(0.3)) sample.options.weights = VoxelWeights{1, 1, 4};
  sample.segmentation = segment(*toMask(sample.object), sample.options);
  return sample;
}

/// Some ten grains of several manifolds each.
Sample largeSample() {
  Rng rng(5);
  Sample sample;
  sample.object = randomVolume(VolumeKind::blurredNoise, boxAt({-20, 3, -9}, {40, 38, 36}), rng);
  sample.options.keepManifold = true;
  sample.options.merge.strictness = 10;
  sample.segmentation = segment(*toMask(sample.object), sample.options);
  REQUIRE(sample.segmentation.counts.grains >= 6);
  return sample;
}

EditedLabels editedSample(const Int32Grid& labels, const Sample& sample,
                          const std::vector<std::string>& texts) {
  return editLabels(labels, editsFrom(texts), sample.segmentation.manifold.get());
}

DenseVolume<int64_t> dense(const ObjectVolume& object, const Int32Grid& grid) {
  DenseVolume<int64_t> values(object.box());
  for (int i = 0; i < object.size(); ++i)
    if (object[i]) values[i] = grid.tree().getValue(object.coord(i));
  return values;
}

/// Two sides of a grain as the definition says, in all its voxels: 1, or 2 beyond the last join or
/// the weakest neck.
std::optional<DenseVolume<int64_t>> naiveHalves(const Sample& s, const DenseVolume<int64_t>& grains,
                                                int64_t grain, const Nodes& nodes,
                                                std::vector<Nodes>& halves) {
  const ManifoldGraph& graph = s.segmentation.graph;
  const DenseVolume<int64_t> manifold = dense(s.object, *s.segmentation.manifold);
  std::map<int64_t, int64_t> voxels;
  for (int i = 0; i < grains.size(); ++i)
    if (grains[i] == grain) ++voxels[manifold[i] - 1];
  std::vector<int64_t> counts;
  for (const uint32_t node : nodes) counts.push_back(voxels[node]);
  std::optional<std::vector<char>> beyond;
  if (s.options.merge.mode == MergeMode::score)
    beyond = naiveJoin(graph, s.options.merge.strictness, nodes, counts);
  if (!beyond) beyond = naiveNeck(graph, nodes, counts);
  if (!beyond) return std::nullopt;
  halves = {{}, {}};
  std::map<int64_t, int> sideOf;
  for (size_t i = 0; i < nodes.size(); ++i) {
    halves[size_t((*beyond)[i])].push_back(nodes[i]);
    sideOf[nodes[i]] = 1 + (*beyond)[i];
  }
  DenseVolume<int64_t> sides(s.object.box());
  const auto isGrain = [&](const Coord& p) { return grains.get(p, 0) == grain; };
  for (int i = 0; i < grains.size(); ++i)
    if (grains[i] == grain && sideOf.count(manifold[i] - 1)) sides[i] = sideOf[manifold[i] - 1];
  for (bool changed = true; changed;) {
    changed = false;
    const DenseVolume<int64_t> before = sides;
    for (int i = 0; i < sides.size(); ++i) {
      if (grains[i] != grain || before[i]) continue;
      int around[3] = {0, 0, 0};
      for (const Coord& step : kSixNeighbors) {
        const Coord q = sides.coord(i) + step;
        if (isGrain(q)) ++around[before[q]];
      }
      if (around[1] + around[2] == 0) continue;
      sides[i] = around[2] > around[1] ? 2 : 1;
      changed = true;
    }
  }
  std::vector<Coord> representatives;
  for (const Nodes& half : halves) {
    uint32_t best = half[0];
    for (const uint32_t node : half)
      if (graph.nodes[node].squaredRadius > graph.nodes[best].squaredRadius) best = node;
    representatives.push_back(graph.nodes[best].position);
  }
  for (int i = 0; i < sides.size(); ++i)
    if (grains[i] == grain && !sides[i]) sides[i] = 1;
  return oracleTidy(sides, representatives, s.options.tidy, graph.weights);
}

}  // namespace

TEST_CASE("grain_parts: a grain of a segmentation splits as defined", "[grain_parts]") {
  int splits = 0, singles = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    CAPTURE(seed);
    const Sample s = sampleOf(seed);
    const Segmentation& seg = s.segmentation;
    const DenseVolume<int64_t> grains = dense(s.object, *seg.grain);
    const Merging merging = oracleMerge(seg.graph, s.options.merge);
    const auto before = int32_t(seg.counts.grains);
    for (int32_t grain = 1; grain <= std::min(before, 4); ++grain) {
      Nodes nodes;
      for (uint32_t i = 0; i < merging.grainOfNode.size(); ++i)
        if (merging.grainOfNode[i] == grain) nodes.push_back(i);
      std::vector<Nodes> halves;
      const auto sides = naiveHalves(s, grains, grain, nodes, halves);
      const std::string text = "split " + std::to_string(grain);
      if (!sides) {
        ++singles;
        CHECK_THROWS_WITH(editedSample(*seg.grain, s, {text}),
                          text + ": grain " + std::to_string(grain) +
                              " is a single manifold: it cannot be split");
        continue;
      }
      ++splits;
      const EditedLabels result = editedSample(*seg.grain, s, {text});
      // The half with the grain's largest ball keeps its number; the other's is that of its own.
      const auto largest = [&](const Nodes& nodesOfHalf) {
        return *std::max_element(
            nodesOfHalf.begin(), nodesOfHalf.end(), [&](uint32_t a, uint32_t b) {
              return seg.graph.nodes[a].squaredRadius < seg.graph.nodes[b].squaredRadius;
            });
      };
      const int32_t other = before + int32_t(largest(halves[1])) + 1;
      REQUIRE(result.results[0].grains == std::vector<int32_t>{grain, other});
      DenseVolume<int64_t> expected = grains;
      for (int i = 0; i < expected.size(); ++i)
        if (grains[i] == grain) expected[i] = (*sides)[i] == 1 ? grain : other;
      REQUIRE(difference("labels", *result.labels, s.object, expected) == "");
      CHECK(result.grains == before + 1);
      CHECK(result.voxels == result.voxelsBefore);
      // Its inverse.
      const EditedLabels back = editedSample(
          *result.labels, s, {"merge " + std::to_string(grain) + " " + std::to_string(other)});
      REQUIRE(difference("labels", *back.labels, s.object, grains) == "");
    }
  }
  CHECK(splits > 35);
  CHECK(singles > 5);
}

TEST_CASE("grain_parts: every edit and its inverse give the same labels", "[grain_parts]") {
  int merges = 0, splits = 0, deep = 0;
  for (uint64_t seed = 101; seed <= 120; ++seed) {
    CAPTURE(seed);
    const Sample s = sampleOf(seed);
    Rng rng(seed);
    Int32Grid::Ptr labels = s.segmentation.grain->deepCopy();
    if (rng.chance(0.3) && s.segmentation.counts.grains > 2)
      labels = editedSample(*labels, s, {"drop 2"}).labels;
    struct Step {
      std::string digest, inverse;
    };
    std::vector<Step> steps;
    std::set<int32_t> joined;  // by an edit: to split one undoes all that joined it
    for (int n = 0; n < 14; ++n) {
      std::vector<int32_t> numbers;
      for (const auto& [number, voxels] : labelSizes(*labels))
        if (!joined.count(number)) numbers.push_back(number);
      if (numbers.empty()) break;
      const auto any = [&] { return numbers[size_t(rng.below(int(numbers.size())))]; };
      const int32_t a = any(), b = any();
      std::string text = "split " + std::to_string(a);
      if (a != b && rng.chance(0.3)) text = "merge " + std::to_string(a) + " " + std::to_string(b);
      INFO(text);
      EditedLabels result;
      try {
        result = editedSample(*labels, s, {text});
      } catch (const InvalidInput&) {
        continue;  // a single manifold
      }
      Step step{labelDigest(*labels), "split " + std::to_string(a)};
      if (text[0] == 'm') {
        joined.insert(a);
        ++merges;
      } else {
        const auto& parts = result.results[0].grains;
        REQUIRE(parts.size() == 2);
        REQUIRE(std::count(parts.begin(), parts.end(), a) == 1);
        step.inverse = "merge " + std::to_string(a) + " " +
                       std::to_string(parts[0] == a ? parts[1] : parts[0]);
        ++splits;
        deep += int(steps.size()) > 3;
      }
      steps.push_back(step);
      labels = result.labels;
    }
    while (!steps.empty()) {
      INFO(steps.back().inverse);
      labels = editedSample(*labels, s, {steps.back().inverse}).labels;
      REQUIRE(labelDigest(*labels) == steps.back().digest);
      steps.pop_back();
    }
  }
  CHECK(merges > 25);
  CHECK(splits > 35);
  CHECK(deep > 5);
}

TEST_CASE("grain_parts: what was merged comes apart at once", "[grain_parts]") {
  const Sample s = largeSample();
  const Int32Grid& grain = *s.segmentation.grain;
  const EditedLabels merged = editedSample(grain, s, {"merge 4 2", "merge 4 5 1"});
  const EditedLabels back = editedSample(*merged.labels, s, {"split 4"});
  CHECK(back.results[0].grains == std::vector<int32_t>{1, 2, 4, 5});
  CHECK(labelDigest(*back.labels) == labelDigest(grain));
  // In one go, too.
  const EditedLabels both = editedSample(grain, s, {"merge 4 2", "merge 4 5 1", "split 4"});
  CHECK(labelDigest(*both.labels) == labelDigest(grain));
}

TEST_CASE("grain_parts: after renumbering the pieces are the same, with other numbers",
          "[grain_parts]") {
  const Sample s = largeSample();
  const Int32Grid& grain = *s.segmentation.grain;
  const EditedLabels merged = editedSample(grain, s, {"merge 4 2", "drop 1", "renumber"});
  // 3, 4 with 2, 5 ... are 1, 2, 3 ...
  const EditedLabels back = editedSample(*merged.labels, s, {"split 2"});
  const auto& parts = back.results[0].grains;
  REQUIRE(parts.size() == 2);
  CHECK(back.grains == s.segmentation.counts.grains - 1);
  std::map<int32_t, std::set<int32_t>> met;
  for (auto voxel = grain.cbeginValueOn(); voxel; ++voxel)
    met[*voxel].insert(back.labels->tree().getValue(voxel.getCoord()));
  std::set<int32_t> numbers;
  for (const auto& [number, now] : met) {
    CHECK(now.size() == 1);
    numbers.insert(*now.begin());
  }
  CHECK(numbers.size() == met.size());
  CHECK(met[3] == std::set<int32_t>{1});
}

TEST_CASE("grain_parts: what no manifolds explain is refused", "[grain_parts]") {
  const Sample s = largeSample();
  const Int32Grid& grain = *s.segmentation.grain;
  const auto says = [&](const Int32Grid& labels, const Int32Grid& manifold,
                        const std::string& what) {
    CHECK_THROWS_WITH(editLabels(labels, editsFrom({"split 2"}), &manifold),
                      vdb_madf::test::Contains(what));
  };
  const Int32Grid& manifold = *s.segmentation.manifold;
  SECTION("a voxel more") {
    const auto labels = grain.deepCopy();
    labels->tree().setValueOn(s.object.box().max() + Coord(30), 2);
    says(*labels, manifold, "grain 2 is not made of manifolds");
  }
  SECTION("every other voxel of another grain") {
    const auto labels = grain.deepCopy();
    const auto sizes = labelSizes(grain);
    const auto largest =
        std::max_element(sizes.begin(), sizes.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    REQUIRE(largest->first != 2);
    for (auto voxel = labels->beginValueOn(); voxel; ++voxel) {
      const Coord p = voxel.getCoord();
      if (*voxel == largest->first && (p.x() + p.y() + p.z()) % 2) voxel.setValue(2);
    }
    says(*labels, manifold, "grain 2 is not made of manifolds");
  }
  SECTION("no graph") {
    const auto without = manifold.deepCopy();
    removeGraph(*without);
    says(grain, *without, "carries no graph of manifolds");
  }
  SECTION("other manifolds") {
    const auto changed = manifold.deepCopy();
    changed->tree().setValueOn(s.object.box().max() + Coord(30), 2);
    says(grain, *changed, "and its graph says");
  }
  SECTION("labels that do not say how they were merged") {
    const auto labels = grain.deepCopy();
    const auto saysWithout = [&](const std::vector<const char*>& keys) {
      for (const char* key : keys) {
        const auto less = labels->deepCopy();
        less->removeMeta(key);
        says(*less, manifold, "do not say by which options");
      }
    };
    saysWithout({"madf_merge", "madf_strictness", "madf_tidy"});
    describeMerging(*labels, {MergeMode::both}, 2, 9);
    saysWithout({"madf_theta", "madf_merge", "madf_adjacency", "madf_delta", "madf_tidy"});
    labels->insertMeta("madf_merge", openvdb::StringMetadata("own"));
    says(*labels, manifold, "do not say by which options");
    labels->insertMeta("madf_merge", openvdb::StringMetadata("both"));
    labels->insertMeta("madf_delta", openvdb::Int64Metadata(std::numeric_limits<int64_t>::max()));
    says(*labels, manifold, "delta is in eighths");
  }
  SECTION("interrupted") {
    StopAtOnce stop;
    CHECK_THROWS_AS(detail::GrainParts(manifold, grain, &stop), Interrupted);
    const detail::GrainParts parts(manifold, grain, nullptr);
    CHECK_THROWS_AS(parts.divide(grain, 2, &stop), Interrupted);
  }
}

TEST_CASE("grain_parts: manifolds that were edited have no graph", "[grain_parts]") {
  const Sample s = largeSample();
  const Int32Grid& manifold = *s.segmentation.manifold;
  REQUIRE(storedGraph(manifold));
  CHECK(storedGraph(*editLabels(manifold, {}).labels));
  CHECK_FALSE(storedGraph(*editLabels(manifold, editsFrom({"merge 1 2"})).labels));
  CHECK(storedGraph(manifold));
}

TEST_CASE("grain_parts: tiles and threads do not matter", "[grain_parts]") {
  const Sample s = largeSample();
  const auto run = [&](const Int32Grid& labels, int threads) {
    return labelDigest(
        *withThreads(threads, [&] {
           return editedSample(labels, s, {"merge 1 2", "split 3", "split 1", "split 4"});
         }).labels);
  };
  const auto tiled = s.segmentation.grain->deepCopy();
  tiled->tree().prune();
  const std::string expected = run(*s.segmentation.grain, 1);
  CHECK(run(*s.segmentation.grain, 4) == expected);
  CHECK(run(*tiled, 2) == expected);
}
