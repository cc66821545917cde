// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/edits/detail/grain_parts.h"

#include <openvdb/Metadata.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "support/catch.h"
#include "support/edits.h"
#include "support/oracle.h"
#include "support/random_case.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/edits/detail/last_join.h"
#include "vdb_madf/edits/detail/weakest_neck.h"
#include "vdb_madf/edits/edit_labels.h"
#include "vdb_madf/labels/label_digest.h"
#include "vdb_madf/labels/label_sizes.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

using Nodes = std::vector<uint32_t>;

/// By the definition: classes as sets, tops looked up anew, sides by walking.
std::optional<std::vector<char>> naiveNeck(const ManifoldGraph& graph, const Nodes& nodes,
                                           const std::vector<int64_t>& voxels) {
  struct Link {
    size_t a, b;
    int height, order;
    double narrower;
  };
  const auto place = [&](uint32_t node) {
    return size_t(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
  };
  std::vector<Link> links;
  for (const auto& edge : graph.edges)
    if (place(edge.first) < nodes.size() && place(edge.second) < nodes.size())
      links.push_back({place(edge.first), place(edge.second), std::max(0, edge.saddleHeight),
                       int(links.size()), 0});
  std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) {
    return a.height != b.height ? a.height > b.height : a.order < b.order;
  });
  std::vector<std::set<size_t>> classes;
  for (size_t i = 0; i < nodes.size(); ++i) classes.push_back({i});
  const auto top = [&](const std::set<size_t>& members) {
    int largest = 0;
    for (const size_t i : members) largest = std::max(largest, graph.nodes[nodes[i]].squaredRadius);
    return largest;
  };
  std::vector<Link> tree;
  for (Link link : links) {
    const auto with = [&](size_t i) {
      return std::find_if(classes.begin(), classes.end(),
                          [&](const auto& c) { return c.count(i); });
    };
    if (with(link.a) == with(link.b)) continue;
    const std::set<size_t> a = *with(link.a), b = *with(link.b);
    link.narrower = std::sqrt(double(std::min(top(a), top(b)))) - std::sqrt(double(link.height));
    tree.push_back(link);
    with(link.a)->insert(b.begin(), b.end());
    classes.erase(std::find(classes.begin(), classes.end(), b));
  }
  REQUIRE(classes.size() == 1);
  size_t largest = 0;
  for (size_t i = 1; i < nodes.size(); ++i)
    if (graph.nodes[nodes[i]].squaredRadius > graph.nodes[nodes[largest]].squaredRadius)
      largest = i;
  std::optional<std::vector<char>> best;
  double most = 0;
  int lowest = 0;
  for (size_t without = 0; without < tree.size(); ++without) {
    std::vector<char> beyond(nodes.size(), 1);
    beyond[largest] = 0;
    for (bool changed = true; changed;) {
      changed = false;
      for (size_t i = 0; i < tree.size(); ++i) {
        if (i == without || beyond[tree[i].a] == beyond[tree[i].b]) continue;
        beyond[tree[i].a] = beyond[tree[i].b] = 0;
        changed = true;
      }
    }
    int64_t here = 0, there = 0;
    for (size_t i = 0; i < nodes.size(); ++i) (beyond[i] ? there : here) += voxels[i];
    if (here == 0 || there == 0) continue;
    const Link& link = tree[without];
    if (best && (link.narrower < most || (link.narrower == most && link.height > lowest))) continue;
    best = beyond;
    most = link.narrower;
    lowest = link.height;
  }
  return best;
}

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

TEST_CASE("grain_parts: the weakest neck, drawn by hand", "[grain_parts]") {
  // Two large balls, a bump on the first that hardly sticks out, and one without voxels.
  ManifoldGraph graph;
  graph.nodes = {
      {{0, 0, 0}, 400, 9}, {{0, 0, 9}, 9, 2}, {{0, 0, 30}, 441, 9}, {{0, 0, 60}, 900, 0}};
  graph.edges = {{0, 1, 1, 8, true}, {0, 2, 1, 385, true}, {1, 3, 1, 2, true}};
  using Sides = std::vector<char>;
  CHECK(detail::beyondWeakestNeck(graph, {0, 1, 2}, {9, 2, 9}) == Sides{1, 1, 0});
  CHECK(detail::beyondWeakestNeck(graph, {0, 1}, {9, 2}) == Sides{0, 1});
  CHECK(detail::beyondWeakestNeck(graph, {0, 1, 2, 3}, {9, 2, 9, 0}) == Sides{0, 0, 1, 0});
  CHECK_FALSE(detail::beyondWeakestNeck(graph, {1, 3}, {2, 0}));
  CHECK_FALSE(detail::beyondWeakestNeck(graph, {2}, {9}));
  CHECK_FALSE(detail::beyondWeakestNeck(graph, {}, {}));
  // Without an edge.
  CHECK(detail::beyondWeakestNeck(graph, {1, 2}, {2, 9}) == Sides{1, 0});
}

TEST_CASE("grain_parts: the weakest neck of random graphs", "[grain_parts]") {
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    ManifoldGraph graph;
    const int count = rng.between(1, 9);
    for (int i = 0; i < count; ++i) graph.nodes.push_back({Coord(i, 0, 0), rng.between(1, 12), 0});
    for (uint32_t i = 0; i < uint32_t(count); ++i)
      for (uint32_t j = i + 1; j < uint32_t(count); ++j)
        if (j == i + 1 || rng.chance(0.3))
          graph.edges.push_back({i, j, 1, rng.between(-2, 9), false});
    Nodes nodes;
    std::vector<int64_t> voxels;
    const int first = rng.below(count);
    for (int i = first; i < count; ++i) {
      nodes.push_back(uint32_t(i));
      voxels.push_back(rng.chance(0.3) ? 0 : rng.between(1, 5));
    }
    REQUIRE(detail::beyondWeakestNeck(graph, nodes, voxels) == naiveNeck(graph, nodes, voxels));
  }
}

TEST_CASE("grain_parts: the last join, drawn by hand", "[grain_parts]") {
  // Five manifolds; the second and the fourth are of one class.
  ManifoldGraph graph;
  for (const int top : {9, 16, 25, 4, 36}) graph.nodes.push_back({{0, 0, top}, top, 3});
  Hierarchy hierarchy;
  hierarchy.classOfNode = {0, 1, 2, 1, 3};
  hierarchy.classes = {{0, 9, 3, 0}, {1, 16, 6, 0}, {2, 25, 3, 0}, {4, 36, 3, 0}};
  hierarchy.joins = {{0, 1, 900}, {2, 3, 800}, {1, 3, 700}};
  using Sides = std::vector<char>;
  const auto sides = [&](const Nodes& nodes, const std::vector<int64_t>& voxels) {
    return detail::beyondLastJoin(graph, hierarchy, nodes, voxels);
  };
  CHECK(sides({0, 1, 2, 3, 4}, {3, 3, 3, 3, 3}) == Sides{1, 1, 0, 1, 0});
  CHECK(sides({0, 1, 3}, {3, 3, 3}) == Sides{1, 0, 0});
  CHECK(sides({2, 4}, {3, 3}) == Sides{1, 0});
  // What has no voxels makes no side.
  CHECK(sides({0, 1, 2, 3, 4}, {3, 3, 0, 0, 0}) == Sides{0, 1, 0, 1, 0});
  CHECK(sides({0, 2, 4}, {0, 3, 3}) == Sides{0, 1, 0});
  CHECK_FALSE(sides({1, 3}, {3, 3}));
  CHECK_FALSE(sides({0}, {3}));
  CHECK_FALSE(sides({}, {}));
  hierarchy.joins.pop_back();
  CHECK_FALSE(sides({0, 1, 2, 3, 4}, {3, 3, 3, 3, 3}));
  CHECK(sides({0, 1}, {3, 3}) == Sides{1, 0});
}

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
