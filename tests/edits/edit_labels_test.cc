// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What needs no manifolds; splitting: grain_parts_test.cc.

#include "vdb_madf/edits/edit_labels.h"

#include <openvdb/Metadata.h>

#include <cmath>
#include <set>

#include "support/catch.h"
#include "support/edits.h"
#include "support/label_shapes.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/label_digest.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

EditedLabels edited(const Int32Grid& labels, const std::vector<std::string>& texts) {
  return editLabels(labels, editsFrom(texts));
}

constexpr double kEdge = 2e-6;

/// By the definition: faces counted anew for each grain that joins another.
LabelMap naiveJoin(LabelMap voxels, int64_t least) {
  for (;;) {
    std::set<std::pair<int64_t, int32_t>> small;
    for (const auto& [label, size] : volumes(voxels))
      if (size < least) small.emplace(size, label);
    int32_t from = 0, to = 0;
    for (const auto& [size, label] : small) {
      std::map<int32_t, int> faces;
      for (const auto& [p, own] : voxels)
        for (int side = 0; side < 6 && own == label; ++side) {
          Coord next = p;
          next[side / 2] += side % 2 ? 1 : -1;
          const auto other = voxels.find(next);
          if (other != voxels.end() && other->second != label) ++faces[other->second];
        }
      if (faces.empty()) continue;
      from = label;
      for (const auto& [other, count] : faces)  // ascending
        if (to == 0 || count > faces[to]) to = other;
      break;
    }
    if (from == 0) return voxels;
    for (auto& [p, label] : voxels)
      if (label == from) label = to;
  }
}

/// By the definition, voxel by voxel.
LabelMap naiveEdit(const LabelMap& voxels, const Edit& edit, const std::optional<Domain>& domain) {
  if (edit.kind == Edit::Kind::joinBelow) return naiveJoin(voxels, edit.voxels);
  std::set<int32_t> numbers, atFaces;
  CoordBBox box;
  for (const auto& [p, label] : voxels) {
    numbers.insert(label);
    box.expand(p);
  }
  for (const auto& [p, label] : voxels)
    for (int side = 0; side < 6; ++side) {
      Coord next = p;
      next[side / 2] += side % 2 ? 1 : -1;
      if (domain ? !domain->isInside(next) : !box.isInside(next)) atFaces.insert(label);
    }
  const auto sizes = volumes(voxels);
  const auto has = [&](int32_t label) {
    return std::count(edit.grains.begin(), edit.grains.end(), label) > 0;
  };
  const auto diameter = [&](int32_t label) {
    return std::cbrt(double(sizes.at(label)) * kEdge * kEdge * kEdge * 6 / M_PI);
  };
  LabelMap result;
  for (const auto& [p, label] : voxels) {
    int32_t now = label;
    switch (edit.kind) {
      case Edit::Kind::merge:
        if (has(label)) now = edit.grains[0];
        break;
      case Edit::Kind::drop:
        if (has(label)) now = 0;
        break;
      case Edit::Kind::keep:
        if (!has(label)) now = 0;
        break;
      case Edit::Kind::minVoxels:
        if (sizes.at(label) < edit.voxels) now = 0;
        break;
      case Edit::Kind::maxVoxels:
        if (sizes.at(label) > edit.voxels) now = 0;
        break;
      case Edit::Kind::minDiameter:
        if (diameter(label) < edit.diameter) now = 0;
        break;
      case Edit::Kind::maxDiameter:
        if (diameter(label) > edit.diameter) now = 0;
        break;
      case Edit::Kind::dropAtFaces:
        if (atFaces.count(label)) now = 0;
        break;
      case Edit::Kind::renumber:
        now = 1 + int32_t(std::distance(numbers.begin(), numbers.find(label)));
        break;
      case Edit::Kind::split:
      case Edit::Kind::joinBelow:
      case Edit::Kind::strictness:
        break;
    }
    if (now) result[p] = now;
  }
  return result;
}

Edit randomEdit(std::mt19937& random, const LabelMap& voxels) {
  const auto sizes = volumes(voxels);
  std::vector<int32_t> labels;
  for (const auto& [label, size] : sizes) labels.push_back(label);
  std::shuffle(labels.begin(), labels.end(), random);
  labels.resize(std::min<size_t>(labels.size(), 2 + random() % 2));
  Edit edit;
  edit.kind = Edit::Kind(1 + random() % 10);  // not split
  if (edit.kind == Edit::Kind::merge && labels.size() < 2) edit.kind = Edit::Kind::drop;
  if (edit.kind == Edit::Kind::keep)  // most of them
    for (const auto& [label, size] : sizes)
      if (!std::count(labels.begin(), labels.end(), label)) edit.grains.push_back(label);
  if (edit.kind == Edit::Kind::merge || edit.kind == Edit::Kind::drop) edit.grains = labels;
  if (edit.grains.empty() && edit.kind <= Edit::Kind::keep) edit.kind = Edit::Kind::renumber;
  const int64_t size = sizes.at(labels[0]) + int64_t(random() % 3) - 1;
  edit.voxels = size;
  edit.diameter = std::cbrt((double(size) - 0.5) * 6 / M_PI) * kEdge;
  return edit;
}

void requireSame(const Int32Grid& labels, const LabelMap& expected) {
  REQUIRE(labels.activeVoxelCount() == expected.size());
  for (const auto& [p, label] : expected) REQUIRE(labels.tree().getValue(p) == label);
}

std::string editsOf(const openvdb::GridBase& grid) {
  return grid.metaValue<std::string>(kEditsKey);
}

}  // namespace

TEST_CASE("edit_labels: as the definition, edit after edit", "[edit_labels]") {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    // Sparse, so that not every grain is at a face.
    LabelMap voxels = randomLabels(seed, Coord(-9, 5, -3), 14, 40, 3 + int(seed % 9));
    const auto labels = labelGrid(voxels);
    setVoxelSize(*labels, VoxelSize{kEdge});
    std::optional<Domain> domain;
    if (seed % 3 == 1) domain = CoordBBox(Coord(-10, 5, -3), Coord(4, 40, 11));
    if (seed % 3 == 2) {
      MaskTree region;
      for (int x = -9; x < 5; ++x)
        for (int y = 5; y < 19; ++y)
          for (int z = -3; z < 11; ++z)
            if (x + y + z < 26 || voxels.count({x, y, z})) region.setValueOn(Coord(x, y, z));
      domain = Domain(region);
    }
    if (domain) setDomain(*labels, *domain);
    const std::string before = labelDigest(*labels);
    std::vector<Edit> list;
    LabelMap expected = voxels;
    int64_t dropped = 0;
    for (int n = 0; n < 5 && !expected.empty(); ++n) {
      list.push_back(randomEdit(random, expected));
      expected = naiveEdit(expected, list.back(), domain);
    }
    std::string texts;
    for (const Edit& edit : list) texts += (texts.empty() ? "" : "; ") + toString(edit);
    CAPTURE(texts);
    const EditedLabels result = editLabels(*labels, list);
    requireSame(*result.labels, expected);
    CHECK(result.voxelsBefore == int64_t(voxels.size()));
    CHECK(result.voxels == int64_t(expected.size()));
    CHECK(result.grainsBefore == int64_t(volumes(voxels).size()));
    CHECK(result.grains == int64_t(volumes(expected).size()));
    for (const EditResult& edit : result.results) dropped += edit.droppedVoxels;
    CHECK(dropped == result.voxelsBefore - result.voxels);
    CHECK(editsOf(*result.labels) == texts);
    CHECK(storedDomain(*result.labels) == domain);
    CHECK(result.labels->transform() == labels->transform());
    CHECK(labelDigest(*labels) == before);
    CHECK_FALSE((*labels)[kEditsKey]);
  }
}

TEST_CASE("edit_labels: what it says of each edit", "[edit_labels]") {
  LabelMap voxels = twoBalls({0, 0, 0}, 5);  // 3 and 7
  voxels[{40, 0, 0}] = voxels[{40, 0, 1}] = 12;
  voxels[{50, 0, 0}] = 20;
  const auto labels = labelGrid(voxels);
  const EditedLabels result =
      edited(*labels, {"merge 7 3", "min-voxels 2", "drop 12", "renumber", "min-voxels 0"});
  REQUIRE(result.results.size() == 5);
  CHECK(result.results[0].grains == std::vector<int32_t>{7});
  CHECK(result.results[0].droppedGrains == 0);
  CHECK(result.results[1].droppedGrains == 1);
  CHECK(result.results[1].droppedVoxels == 1);
  CHECK(result.results[2].droppedVoxels == 2);
  CHECK(result.results[4].droppedGrains == 0);
  CHECK(result.labels->tree().getValue(Coord(0)) == 1);
  CHECK(result.grains == 1);
  // After those that were there.
  const EditedLabels again = edited(*result.labels, {"drop 1"});
  CHECK(editsOf(*again.labels) == editsOf(*result.labels) + "; drop 1");
  CHECK(again.labels->empty());
  CHECK(edited(*again.labels, {"renumber", "drop-at-faces", "min-voxels 3"}).grains == 0);
  CHECK_FALSE((*edited(*labels, {}).labels)[kEditsKey]);
}

TEST_CASE("edit_labels: small grains join what they touch most", "[edit_labels]") {
  LabelMap voxels = twoBalls({0, 0, 0}, 5);  // 3 and 7
  const auto before = volumes(voxels);
  for (const int z : {5, 6, 7}) voxels[{0, 0, z}] = z == 5 ? 1 : 2;  // a thorn on 3, in two parts
  voxels[{40, 0, 0}] = 5;                                            // which touches none
  const auto labels = labelGrid(voxels);
  const EditedLabels result = edited(*labels, {"join-below 0", "join-below 2", "join-below 27"});
  std::vector<int64_t> joined;
  for (const EditResult& edit : result.results) joined.push_back(edit.joinedGrains);
  CHECK(joined == std::vector<int64_t>{0, 1, 1});
  CHECK(result.results[1].grains == std::vector<int32_t>{2});
  CHECK(result.results[2].grains == std::vector<int32_t>{3});
  CHECK(result.grains == 3);
  CHECK(result.voxels == result.voxelsBefore);
  requireSame(*result.labels, naiveJoin(voxels, 27));
  CHECK(volumes(naiveJoin(voxels, 27)) ==
        std::map<int32_t, int64_t>{{3, before.at(3) + 3}, {5, 1}, {7, before.at(7)}});
  CHECK_THROWS_WITH(
      edited(*labels, {"join-below 2", "drop 1"}),
      vdb_madf::test::Equals("drop 1: there is no grain 1 any more, after 'join-below 2'"));
}

TEST_CASE("edit_labels: counts of a segmentation stay true or go", "[edit_labels]") {
  const auto labels = labelGrid(twoBalls({0, 0, 0}, 5));
  const auto count = [](const EditedLabels& e, const char* key) {
    const auto value = e.labels->getMetadata<openvdb::Int64Metadata>(key);
    return value ? value->value() : -1;
  };
  CHECK(count(edited(*labels, {"drop 3"}), "madf_grains") == -1);
  for (const char* key :
       {"madf_grains", "madf_object_voxels", "madf_leaves", "madf_medial_balls", "madf_gamma"})
    labels->insertMeta(key, openvdb::Int64Metadata(99));
  const EditedLabels merged = edited(*labels, {"merge 3 7"}), dropped = edited(*labels, {"drop 3"});
  CHECK(count(merged, "madf_grains") == 1);
  CHECK(count(merged, "madf_object_voxels") == 99);
  CHECK(count(merged, "madf_medial_balls") == 99);
  CHECK(count(dropped, "madf_grains") == 1);
  CHECK(count(dropped, "madf_object_voxels") == int64_t(dropped.labels->activeVoxelCount()));
  CHECK(count(dropped, "madf_leaves") == int64_t(dropped.labels->tree().leafCount()));
  CHECK(count(dropped, "madf_medial_balls") == -1);
  CHECK(count(dropped, "madf_gamma") == 99);
}

TEST_CASE("edit_labels: tiles, and values that are no labels", "[edit_labels]") {
  const auto labels = labelGrid({{{-1, 0, 0}, 5}, {{-2, 0, 0}, 6}, {{-3, 0, 0}, -4}});
  labels->fill(CoordBBox(Coord(0), Coord(127)), 5);
  labels->fill(CoordBBox(Coord(128, 0, 0), Coord(135, 7, 7)), 6);
  REQUIRE(labels->tree().activeTileCount() > 0);
  const EditedLabels merged = edited(*labels, {"merge 6 5"});
  CHECK(merged.labels->activeVoxelCount() == 2 + 512 + 128 * 128 * 128);
  CHECK(merged.labels->tree().getValue(Coord(100)) == 6);
  CHECK(merged.grains == 1);
  const EditedLabels dropped = edited(*labels, {"drop 5"});
  CHECK(dropped.labels->activeVoxelCount() == 1 + 512);
  CHECK(dropped.labels->tree().getValue(Coord(130, 1, 1)) == 6);
  // The box of the grains that are left is 1 x 8 x 8 voxels and more: all are at its faces.
  CHECK(edited(*labels, {"drop 5", "drop-at-faces"}).labels->empty());
}

TEST_CASE("edit_labels: what is not there is refused, and why", "[edit_labels]") {
  const auto labels = labelGrid(twoBalls({0, 0, 0}, 4));  // 3 and 7
  const auto says = [&](const std::vector<std::string>& texts, const std::string& what) {
    CAPTURE(texts, what);
    CHECK_THROWS_WITH(edited(*labels, texts), vdb_madf::test::Equals(what));
  };
  says({"drop 4"}, "drop 4: there is no grain 4");
  says({"merge 3 7", "drop 7"}, "drop 7: there is no grain 7 any more, after 'merge 3 7'");
  says({"keep 3", "keep 3", "merge 3 7"},
       "merge 3 7: there is no grain 7 any more, after 'keep 3'");
  says({"min-voxels 1000000", "drop 3"},
       "drop 3: there is no grain 3 any more, after 'min-voxels 1000000'");
  says({"renumber", "drop 3"}, "drop 3: there is no grain 3");
  says({"split 3"}, "split 3: there are no manifolds to split grains by: segment again");
  CHECK_THROWS_WITH(
      edited(*labels, {"min-diameter 1um"}),
      vdb_madf::test::StartsWith("min-diameter 1um: the size of the voxels is unknown"));
  says({"strictness 10.5", "drop 3"},
       "strictness 10.5: these labels do not say that they were merged by score: edit those that "
       "'vdb_madf remerge --strictness 10.5' makes");
  MergeOptions merging;
  merging.strictness = 11;
  describeMerging(*labels, merging, 2, 2);
  says({"strictness 10.5", "drop 3"},
       "strictness 10.5: these labels were merged with the strictness 11: edit those that "
       "'vdb_madf remerge --strictness 10.5' makes");
  CHECK(edited(*labels, {"strictness 11", "drop 3"}).grains == 1);
  // Edits that were not made of texts are checked, too.
  Edit edit;
  edit.kind = Edit::Kind::merge;
  for (const std::vector<int32_t>& grains : {std::vector<int32_t>{}, {3}, {3, 3}}) {
    edit.grains = grains;
    CHECK_THROWS_AS(editLabels(*labels, {edit}), InvalidInput);
  }
  edit.kind = Edit::Kind::split;
  edit.grains = {};
  CHECK_THROWS_AS(editLabels(*labels, {edit}), InvalidInput);
  edit.kind = Edit::Kind::minDiameter;
  edit.diameter = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(editLabels(*labels, {edit}), InvalidInput);
  StopAtOnce stop;
  CHECK_THROWS_AS(editLabels(*labels, editsFrom({"merge 3 7"}), nullptr, &stop), Interrupted);
}

TEST_CASE("edit_labels: the same for any number of threads", "[edit_labels]") {
  const auto labels = labelGrid(randomLabels(4, Coord(-30), 60, 300, 30));
  const auto texts = editsFrom({"merge 9 12 14", "min-voxels 200", "drop-at-faces", "renumber"});
  const auto one = withThreads(1, [&] { return editLabels(*labels, texts); });
  const auto four = withThreads(4, [&] { return editLabels(*labels, texts); });
  CHECK(labelDigest(*one.labels) == labelDigest(*four.labels));
}
