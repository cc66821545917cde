// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What a page says of the grains at the strictnesses of its slider.

#include "vdb_madf/report/detail/grain_levels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/random_volume.h"
#include "support/report_page.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/remerge.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// What a page says of the grains at the strictnesses of its slider, read by the descriptions in
/// grain_levels.h.
class PageLevels {
 public:
  explicit PageLevels(const Page& page)
      : about_(page.json("about").at("levels")), joins_(page.bytes("joins")) {
    const std::string leaves = page.bytes("leaves");
    REQUIRE(about_["tables"]["grains"]["columns"][0] == Json{{"name", "voxels"}, {"exact", true}});
    for (size_t leaf = 0; leaf < leafCount(); ++leaf) {
      uint64_t bits = 0;
      for (size_t plane = 0; plane < 8; ++plane)
        bits |= uint64_t(uint8_t(leaves.at(plane * leafCount() + leaf))) << (8 * plane);
      double voxels = 0;
      std::memcpy(&voxels, &bits, sizeof voxels);
      voxels_.push_back(int64_t(voxels));
    }
    REQUIRE(joins_.size() == 4 * leafCount() + 12 * joinCount());
  }

  size_t leafCount() const { return about_.at("leaves"); }
  /// Among the labels, of a leaf from 1 on.
  int32_t ownGrain(size_t leaf) const { return int32_t(number(0, leafCount(), leaf - 1)); }

  /// By number; made join by join.
  std::vector<int64_t> grainVoxels(double strictness) const {
    std::map<uint32_t, int64_t> grains;  // by name
    uint32_t place = 0;
    for (const int64_t voxels : voxels_) {
      while (isEmpty(place)) grains[place++] = 0;
      grains[place++] = voxels;
    }
    for (const uint32_t empty : about_.at("empty")) grains.emplace(empty, 0);
    const size_t kept = 4 * leafCount(), gone = kept + 4 * joinCount();
    for (size_t i = 0; i < joinCount(); ++i) {
      const auto least = int32_t(number(gone + 4 * joinCount(), joinCount(), i));
      if (least < std::lround(512 * strictness)) break;
      const auto from = grains.find(number(gone, joinCount(), i));
      REQUIRE(from != grains.end());
      grains.at(number(kept, joinCount(), i)) += from->second;
      grains.erase(from);
    }
    std::vector<int64_t> result;
    for (const auto& [name, voxels] : grains)
      if (voxels > 0) result.push_back(voxels);
    return result;
  }

 private:
  size_t joinCount() const { return about_.at("joins"); }
  bool isEmpty(uint32_t place) const {
    const auto empty = about_.at("empty").get<std::vector<uint32_t>>();
    return std::find(empty.begin(), empty.end(), place) != empty.end();
  }
  /// Of planes of 32 bits.
  uint32_t number(size_t at, size_t count, size_t i) const {
    uint32_t value = 0;
    for (size_t plane = 0; plane < 4; ++plane)
      value |= uint32_t(uint8_t(joins_.at(at + plane * count + i))) << (8 * plane);
    return value;
  }

  Json about_;
  std::string joins_;
  std::vector<int64_t> voxels_;
};

Segmentation withManifolds(double strictness) {
  Rng rng(5);
  const CoordBBox box = boxAt({-10, 3, 5}, {44, 40, 36});
  SegmentOptions options;
  options.keepManifold = true;
  options.merge.strictness = strictness;
  return segment(*toMask(randomVolume(VolumeKind::blurredNoise, box, rng)), options);
}

/// Without what takes time here.
Page writePlain(const Int32Grid::ConstPtr& labels, const Int32Grid::ConstPtr& manifold) {
  ReportOptions options;
  if (manifold) options.manifold = manifold;
  options.maxTriangles = 0;
  options.pictureEdge = 16;
  return write(labels, options);
}

std::vector<int64_t> voxelsOfLabels(const Int32Grid& labels) {
  std::map<int32_t, int64_t> voxels;
  for (auto value = labels.cbeginValueOn(); value; ++value)
    voxels[*value] += int64_t(value.getVoxelCount());
  std::vector<int64_t> result;
  for (const auto& [label, count] : voxels) {
    REQUIRE(label == int32_t(result.size()) + 1);
    result.push_back(count);
  }
  return result;
}

}  // namespace

TEST_CASE("report: with manifolds, its grains at any strictness are those of remerge", "[report]") {
  NEEDS_PAGE();
  for (const double own : {11.0, 15.25}) {
    const Segmentation grains = withManifolds(own);
    const Page page = writePlain(grains.grain, grains.manifold);
    const PageLevels levels(page);
    const double highest = std::max(own, 14.0);
    CHECK(levels.leafCount() == levels.grainVoxels(highest).size());
    CHECK(levels.grainVoxels(highest).size() > levels.grainVoxels(8).size());
    for (const double strictness : {8.0, 9.1, 10.0, 11.0, 12.7, 14.0, highest}) {
      MergeOptions merge;
      merge.strictness = strictness;
      CHECK(levels.grainVoxels(strictness) == voxelsOfLabels(*remerge(*grains.manifold, merge, 0)));
    }
    CHECK(page.bytes("grains") == measurementTexts(measure(*grains.grain)).grains);

    // The leaves of the slices make the grains of the labels, before these are tidied.
    MergeOptions merge;
    merge.strictness = own;
    const auto untidied = remerge(*grains.manifold, merge, 0);
    const Json about = page.json("about").at("slices");
    const Coord min(about["min"][0], about["min"][1], about["min"][2]),
        size(about["size"][0], about["size"][1], about["size"][2]);
    size_t i = 0, wrong = 0;
    const std::vector<uint64_t> voxels = sliceVoxels(page);
    for (int z = 0; z < size.z(); ++z)
      for (int y = 0; y < size.y(); ++y)
        for (int x = 0; x < size.x(); ++x, ++i) {
          const int32_t label = untidied->tree().getValue(min + Coord(x, y, z));
          wrong += label != (voxels[i] == 0 ? 0 : levels.ownGrain(voxels[i]));
        }
    CHECK(i == voxels.size());
    CHECK(wrong == 0);
  }
}

TEST_CASE("report: a piece in a cavity, which has no voxels, joins and names a grain", "[report]") {
  NEEDS_PAGE();
  const auto manifold = Int32Grid::create(0);
  manifold->setName("manifold");
  manifold->fill({{0, 0, 0}, {4, 9, 9}}, 1);
  manifold->fill({{0, 20, 0}, {3, 29, 9}}, 2);
  ManifoldGraph graph;
  graph.nodes = {{{0, 0, 0}, 90, 500}, {{0, 20, 0}, 80, 400}, {{0, 40, 0}, 100, 0, 300}};
  graph.edges = {{0, 2, 100, 81, true}};
  setGraph(*manifold, graph);
  const auto labels = remerge(*manifold);
  const PageLevels levels(writePlain(labels, manifold));
  CHECK(levels.grainVoxels(14) == std::vector<int64_t>{500, 400});
  CHECK(levels.grainVoxels(11) == std::vector<int64_t>{400, 500});
  CHECK(levels.ownGrain(1) == 2);
  CHECK(levels.ownGrain(2) == 1);
}

TEST_CASE("report: manifolds that are not those of the labels change nothing", "[report]") {
  NEEDS_PAGE();
  const Segmentation grains = withManifolds(11);
  MergeOptions both;
  both.mode = MergeMode::both;
  const auto otherwise = remerge(*grains.manifold, both);
  const auto edited = grains.grain->deepCopy();
  edited->insertMeta(kEditsKey, openvdb::StringMetadata("merge 1 2"));
  const auto others = balls();
  describeMerging(*others, {}, 2, 2);
  for (const auto& labels : {otherwise, edited, others, balls()})
    CHECK(writePlain(labels, grains.manifold).text == writePlain(labels, nullptr).text);
  CHECK(writePlain(grains.grain, grains.manifold).has("joins"));
}
