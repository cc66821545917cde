// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/verify/verify.h"

#include <openvdb/Metadata.h>

#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/random_case.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/remerge.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// The labels of a case, or null if it has none.
Int32Grid::Ptr labelsOf(const RandomCase& c, const MaskGrid& object) {
  try {
    return segment(object, optionsOf(c)).grain;
  } catch (const InvalidInput&) {
    return nullptr;
  }
}

std::string faultOf(const RandomCase& c) {
  const MaskGrid::Ptr object = maskOf(c);
  const Int32Grid::Ptr labels = labelsOf(c, *object);
  return labels ? verify(singleSlab(labels), *object).fault : "";
}

/// A sample of several grains, all of which touch others.
RandomCase grainyCase(uint64_t seed) {
  RandomCase c;
  Rng rng(seed);
  c.kind = VolumeKind::blurredNoise;
  c.object =
      randomVolume(VolumeKind::blurredNoise, CoordBBox(Coord(-5, 3, 6), Coord(18, 26, 29)), rng);
  c.domain = c.object.box();
  c.domainInMetadata = true;
  c.options.merge.strictness = 40;
  return c;
}

/// Pairs of face neighbors, each voxel labeled.
std::vector<std::pair<Coord, Coord>> touchingVoxels(const Int32Grid& labels) {
  std::vector<std::pair<Coord, Coord>> pairs;
  const auto at = labels.getConstAccessor();
  for (auto it = labels.tree().cbeginValueOn(); it; ++it)
    for (const Coord& step : kSixNeighbors) {
      const Coord p = it.getCoord(), q = p + step;
      if (at.isValueOn(q) && at.getValue(q) != it.getValue()) pairs.emplace_back(p, q);
    }
  return pairs;
}

bool sameLabels(const Int32Grid& a, const Int32Grid& b) {
  if (!a.tree().hasSameTopology(b.tree())) return false;
  for (auto it = a.tree().cbeginValueOn(); it; ++it)
    if (b.tree().getValue(it.getCoord()) != it.getValue()) return false;
  return true;
}

void relabel(Int32Grid& labels, const std::function<int32_t(int32_t)>& changed) {
  for (auto it = labels.tree().beginValueOn(); it; ++it) it.setValue(changed(it.getValue()));
}

}  // namespace

TEST_CASE("verify: what segment() makes of random volumes of every kind holds", "[verify]") {
  const uint64_t first = fromEnvironment("VDB_MADF_SEED", 0),
                 cases = fromEnvironment("VDB_MADF_CASES", 360);
  uint64_t judged = 0;
  for (uint64_t seed = first; seed < first + cases; ++seed) {
    RandomCase c = randomCase(
        seed, seed % 3 == 0 ? std::optional<Coord>(Coord(14, 12, 13)) : std::optional<Coord>());
    if (seed % 4 == 3) drawRegion(c);
    judged += labelsOf(c, *maskOf(c)) != nullptr;
    if (faultOf(c).empty()) continue;
    c = shrink(
        c, [](const RandomCase& smaller) { return !faultOf(smaller).empty(); }, 300);
    INFO(describe(c));
    REQUIRE(faultOf(c) == "");
  }
  CHECK(judged > cases * 9 / 10);
}

TEST_CASE("verify: labels with one fault are refused, and where it is is told", "[verify]") {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const RandomCase c = grainyCase(seed);
    const MaskGrid::Ptr object = maskOf(c);
    const Int32Grid::Ptr right = labelsOf(c, *object);
    REQUIRE(verify(singleSlab(right), *object).fault == "");
    const auto pairs = touchingVoxels(*right);
    REQUIRE(pairs.size() > 20);
    const auto wrong = [&](const std::function<void(Int32Grid&)>& change) {
      const Int32Grid::Ptr labels = right->deepCopy();
      change(*labels);
      const Verification found = verify(singleSlab(labels), *object);
      CHECK(found.fault != "");
      return found;
    };
    // Labels of single voxels.
    for (const size_t i : {size_t(0), pairs.size() / 3, pairs.size() / 2, pairs.size() - 1}) {
      const Coord p = pairs[i].first, q = pairs[i].second;
      const int32_t own = right->tree().getValue(p), other = right->tree().getValue(q);
      const Verification moved = wrong([&](Int32Grid& l) { l.tree().setValue(p, other); });
      CHECK(moved.differing == 1);
      std::ostringstream where;
      where << p << ", has grain " << other << " and should have grain " << own;
      CHECK_THAT(moved.fault, Contains(where.str()));
      CHECK(wrong([&](Int32Grid& l) { l.tree().setValueOff(p, 0); }).differing == 1);
      CHECK(wrong([&](Int32Grid& l) { l.tree().setValueOn(p, -own); }).differing == 1);
    }
    const auto background = [&] {
      Coord p = object->evalActiveVoxelBoundingBox().min();
      while (object->tree().isValueOn(p)) p.z() += 1;
      return p;
    }();
    CHECK(wrong([&](Int32Grid& l) { l.tree().setValue(background, 1); }).differing == 1);
    wrong([&](Int32Grid& l) { l.tree().setValueOn(background, 0); });
    CHECK(wrong([&](Int32Grid& l) { l.tree().setValue(Coord(99), 1); }).differing == 1);
    // Labels of grains.
    const int32_t a = right->tree().getValue(pairs[0].first),
                  b = right->tree().getValue(pairs[0].second);
    wrong([&](Int32Grid& l) {
      relabel(l, [&](int32_t g) { return g == a ? b : g == b ? a : g; });
    });
    wrong([&](Int32Grid& l) {
      relabel(l, [&](int32_t g) { return g == std::max(a, b) ? std::min(a, b) : g; });
    });
    wrong([&](Int32Grid& l) {
      relabel(l, [&](int32_t g) {
        return g == std::max(a, b) ? std::min(a, b) : g > std::max(a, b) ? g - 1 : g;
      });
      l.insertMeta("madf_grains", openvdb::Int64Metadata(*grainCount(l) - 1));
    });
    wrong([&](Int32Grid& l) { relabel(l, [](int32_t g) { return g + 1; }); });
    // Counts, and the domain.
    for (const char* key : {"madf_object_voxels", "madf_cavities", "madf_cavity_voxels",
                            "madf_medial_balls", "madf_kept_balls", "madf_critical_points",
                            "madf_largest_squared_distance", "madf_grains"}) {
      wrong([&](Int32Grid& l) {
        l.insertMeta(
            key, openvdb::Int64Metadata(l.getMetadata<openvdb::Int64Metadata>(key)->value() + 1));
      });
      wrong([&](Int32Grid& l) { l.removeMeta(key); });
    }
    wrong([&](Int32Grid& l) {
      CoordBBox box = *c.domain;
      box.max().x() += 1;
      setDomain(l, box);
    });
  }
}

TEST_CASE("verify: labels hold by other options only if these give the same", "[verify]") {
  const std::map<std::string, std::function<void(SegmentOptions&)>> changes{
      {"strictness", [](SegmentOptions& o) { o.merge.strictness = 3; }},
      {"stricter", [](SegmentOptions& o) { o.merge.strictness += 1. / 512; }},
      {"angle", [](SegmentOptions& o) { o.merge.mode = MergeMode::angle; }},
      {"neck", [](SegmentOptions& o) { o.merge.mode = MergeMode::neck; }},
      {"both", [](SegmentOptions& o) { o.merge.mode = MergeMode::both; }},
      {"gamma", [](SegmentOptions& o) { o.gamma = 20; }},
      {"closed", [](SegmentOptions& o) { o.boundary = Boundary::closed; }},
      {"fill-holes", [](SegmentOptions& o) { o.fillHoles = 0; }},
      {"tidy 0", [](SegmentOptions& o) { o.tidy = 0; }},
      {"tidy 1", [](SegmentOptions& o) { o.tidy = 1; }},
      {"min-grain", [](SegmentOptions& o) { o.merge.minGrain = 80; }},
      {"weights", [](SegmentOptions& o) {
         o.weights = VoxelWeights{4, 4, 9};
       }}};
  std::map<std::string, int> refused;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const RandomCase c = grainyCase(seed);
    const MaskGrid::Ptr object = maskOf(c);
    const Int32Grid::Ptr right = labelsOf(c, *object);
    for (const auto& [name, change] : changes) {
      RandomCase other = c;
      change(other.options);
      // The labels of the one, with what those of the other say of themselves.
      const Int32Grid::Ptr labels = labelsOf(other, *object)->deepCopy();
      CHECK(verify(singleSlab(labels), *object).fault == "");
      labels->setTree(right->tree().copy());
      const bool isSame = sameLabels(*right, *labelsOf(other, *object));
      INFO(name);
      CHECK(verify(singleSlab(labels), *object).fault.empty() == isSame);
      refused[name] += !isSame;
    }
  }
  for (const auto& change : changes)
    if (change.first != "stricter") CHECK(refused[change.first] > 0);
}

TEST_CASE("verify: what remerge() makes holds", "[verify]") {
  const RandomCase c = grainyCase(3);
  const MaskGrid::Ptr object = maskOf(c);
  const Segmentation s = segment(*object, optionsOf(c));
  for (const double strictness : {0., 5., 11., 30.}) {
    MergeOptions options;
    options.strictness = strictness;
    CHECK(verify(singleSlab(remerge(*s.manifold, options)), *object).fault == "");
  }
}

TEST_CASE("verify: labels in slabs are read one by one", "[verify]") {
  const RandomCase c = grainyCase(2);
  const MaskGrid::Ptr object = maskOf(c);
  const Int32Grid::Ptr labels = labelsOf(c, *object);
  LabelSlabs slabs;
  slabs.cuts = {0, 16, 24, 32};
  slabs.about = labels->copyWithNewTree();
  slabs.read = [&](size_t slab, Interrupter*) {
    const Int32Grid::Ptr part = labels->deepCopy();
    CoordBBox box = labels->evalActiveVoxelBoundingBox();
    box.min().z() = slabs.cuts[slab];
    box.max().z() = slabs.cuts[slab + 1] - 1;
    part->clip(box);
    return part;
  };
  CHECK(verify(slabs, *object).fault == "");
  slabs.cuts = {0, 16, 24};  // the last one is missing
  CHECK(verify(slabs, *object).differing > 0);
}

TEST_CASE("verify: labels that no definition gives are refused", "[verify]") {
  const RandomCase c = grainyCase(1);
  const MaskGrid::Ptr object = maskOf(c);
  const Int32Grid::Ptr right = labelsOf(c, *object);
  const auto refusal = [&](const std::function<void(Int32Grid&)>& change) -> std::string {
    const Int32Grid::Ptr labels = right->deepCopy();
    change(*labels);
    try {
      verify(singleSlab(labels), *object);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  for (const char* key : {"madf_gamma", "madf_boundary", "madf_fill_holes", "madf_tidy",
                          "madf_merge", "madf_strictness"})
    CHECK_THAT(refusal([&](Int32Grid& l) { l.removeMeta(key); }), Contains(key));
  CHECK_THAT(refusal([](Int32Grid& l) { describeOwnMerging(l, 2, 3); }), Contains("'own'"));
  CHECK_THAT(
      refusal([](Int32Grid& l) { l.insertMeta(kEditsKey, openvdb::StringMetadata("merge 1 2")); }),
      Contains("edited"));
  CHECK_THAT(
      refusal([](Int32Grid& l) { l.insertMeta("madf_track", openvdb::StringMetadata("0 0 0")); }),
      Contains("tracked"));
  CHECK_THAT(refusal([](Int32Grid& l) {
               l.removeMeta("madf_domain_min");
               l.removeMeta("madf_domain_max");
             }),
             Contains("domain"));
  const auto setWeights = [](Int32Grid& labels, int32_t w) {
    labels.insertMeta("madf_weights", openvdb::Vec3IMetadata({w, w, w}));
  };
  CHECK_THAT(refusal([&](Int32Grid& l) { setWeights(l, 0); }), Contains("positive"));
  const Int32Grid::Ptr far = right->deepCopy();
  setWeights(*far, INT32_MAX);
  CHECK_THAT(verify(singleSlab(far), *object).fault, Contains("32 bits"));
  CHECK_THAT(refusal([](Int32Grid& l) { l.insertMeta("madf_tidy", openvdb::Int64Metadata(1001)); }),
             Contains("1000 rounds"));
  StopAtOnce stop;
  CHECK_THROWS_AS(verify(singleSlab(right), *object, 0, &stop), Interrupted);
  CHECK_THROWS_AS(verify(singleSlab(right), *object, 32 * 24 * 24 * 24 - 1), InvalidInput);
  CHECK(verify(singleSlab(right), *object, 32 * 24 * 24 * 24).fault == "");
}
