// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// track() with a motion, on labels; on features: match_grains_test.cc.

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/label_slabs.h"
#include "support/moved_grains.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/label_digest.h"
#include "vdb_madf/labels/label_sizes.h"
#include "vdb_madf/matching/track.h"
#include "vdb_madf/method/boundary.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Balls that touch, as labels; where their centers go, and their numbers.
LabelMap drawnBalls(const std::vector<openvdb::Vec3d>& centers, const std::vector<int32_t>& numbers,
                    double radius) {
  std::map<Coord, std::pair<double, int32_t>> nearest;
  for (size_t n = 0; n < centers.size(); ++n) {
    const int reach = int(radius) + 1;
    const Coord middle = Coord::round(centers[n]);
    for (int x = -reach; x <= reach; ++x)
      for (int y = -reach; y <= reach; ++y)
        for (int z = -reach; z <= reach; ++z) {
          const Coord p = middle.offsetBy(x, y, z);
          const double squared = (p.asVec3d() - centers[n]).lengthSqr();
          if (squared > radius * radius) continue;
          const auto [at, isNew] = nearest.try_emplace(p, squared, numbers[n]);
          if (!isNew) at->second = std::min(at->second, {squared, numbers[n]});
        }
  }
  LabelMap voxels;
  for (const auto& [p, owner] : nearest) voxels[p] = owner.second;
  return voxels;
}

/// Slabs of 24 layers in which all labels lie.
std::vector<int> layersOf(const Int32Grid& labels) {
  const CoordBBox box = labels.evalActiveVoxelBoundingBox();
  std::vector<int> cuts{box.min().z() & ~7};
  while (cuts.back() <= box.max().z()) cuts.push_back(cuts.back() + 24);
  return cuts;
}

/// All that track() says, and the labels that follow.
std::string madeBy(const AnyLabels& before, const AnyLabels& after, const TrackOptions& options) {
  const Tracks tracks = track(before, after, options);
  std::ostringstream text;
  text.precision(17);
  for (const auto* side : {&tracks.before, &tracks.after})
    for (const TrackedGrain& grain : *side)
      text << grain.grain << ' ' << toString(grain.fate) << ' ' << grain.voxels << ' '
           << grain.links << ' ' << grain.partner << ' ' << grain.track << '\n';
  for (const GrainMove& move : tracks.moves)
    text << move.confidence << ' ' << move.center << ' ' << move.displacement << ' ' << move.miss
         << '\n';
  for (const auto* side : {&tracks.bondsBefore, &tracks.bondsAfter})
    for (const TrackedBond& bond : *side)
      text << bond.first << ' ' << bond.second << ' ' << bond.faces << ' ' << toString(bond.fate)
           << '\n';
  const AnyLabels labels = trackedLabels(after, tracks);
  text << aboutOf(labels).metaValue<std::string>(kTrackKey) << '\n';
  std::map<int32_t, int64_t> voxels;
  const auto add = [&](const Int32Grid& some) {
    for (const auto& [number, count] : labelSizes(some)) voxels[number] += count;
  };
  if (const auto* const slabs = std::get_if<LabelSlabs>(&labels))
    for (size_t slab = 0; slab < slabs->slabCount(); ++slab) add(*slabs->read(slab, nullptr));
  else
    add(*std::get<Int32Grid::ConstPtr>(labels));
  for (const auto& [number, count] : voxels) text << number << ' ' << count << '\n';
  return text.str();
}

}  // namespace

TEST_CASE("track: bonds are followed through a motion", "[track_motion]") {
  // Balls that touch in pairs; later all is turned, shortened and moved.
  Dice dice(4);
  std::vector<openvdb::Vec3d> before, after;
  std::vector<int32_t> numbers, later;
  const openvdb::Mat3d turn = turnAbout({0, 0, 1}, 15);
  openvdb::Mat3d stretch = openvdb::Mat3d::identity();
  stretch(2, 2) = 0.88;
  int pair = 0;
  for (const openvdb::Vec3d& middle : packed(std::vector<double>(36, 12), dice)) {
    // The bonds of the pairs 0 to 2 break: the first ends up near, the others far. The second ball
    // of pair 3 goes, pair 4 is bonded anew, and less is left of the bond of pair 5.
    const double first = pair == 4 ? 6.5 : 4.5, second = pair == 0                ? 5.9
                                                         : pair == 1 || pair == 2 ? 7.5
                                                         : pair == 5              ? 4.9
                                                                                  : 4.5;
    for (const double side : {-1., 1.}) {
      before.push_back(middle + openvdb::Vec3d(side * first, 0, 0));
      after.push_back(turn * (stretch * middle + openvdb::Vec3d(side * second, 0, 0)) +
                      openvdb::Vec3d(90, -40, 7));
      numbers.push_back(int32_t(numbers.size()) + 1);
      later.push_back(100 - numbers.back());
    }
    ++pair;
  }
  const auto a = labelGrid(drawnBalls(before, numbers, 5));
  auto there = after;
  auto thereNumbers = later;
  there.erase(there.begin() + 7);
  thereNumbers.erase(thereNumbers.begin() + 7);
  const auto b = labelGrid(drawnBalls(there, thereNumbers, 5));
  setDomain(*a, CoordBBox(Coord(-30), Coord(120)));
  setDomain(*b, CoordBBox(Coord(-100), Coord(250)));
  for (const MotionKind kind : {MotionKind::rigid, MotionKind::affine, MotionKind::free}) {
    CAPTURE(toString(kind));
    TrackOptions options;
    options.motion = MatchOptions{kind, {}};
    const Tracks tracks = track(*a, *b, options);
    REQUIRE(tracks.moves.size() == tracks.before.size());
    for (size_t n = 0; n < tracks.before.size(); ++n) {
      const TrackedGrain& grain = tracks.before[n];
      CAPTURE(grain.grain);
      CHECK(grain.partner == (grain.grain == 8 ? 0 : later[n]));
      CHECK(grain.fate == (grain.grain == 8 ? GrainFate::lost : GrainFate::kept));
      if (grain.partner)
        CHECK((tracks.moves[n].displacement - (after[n] - before[n])).length() < 0.3);
    }
    for (const TrackedGrain& grain : tracks.after) {
      CHECK(grain.fate == GrainFate::kept);
      CHECK(grain.track == 100 - grain.grain);
    }
    std::map<std::string, int> fates;
    for (const TrackedBond& bond : tracks.bondsBefore) {
      ++fates[toString(bond.fate)];
      if (bond.first == 1 && bond.second == 2) CHECK(bond.fate == BondFate::detached);
      if (bond.first == 3 && bond.second == 4) CHECK(bond.fate == BondFate::separated);
      if (bond.first == 5 && bond.second == 6) CHECK(bond.fate == BondFate::separated);
      if (bond.first == 7 && bond.second == 8) CHECK(bond.fate == BondFate::unmatched);
      if (bond.first > 10 && bond.second == bond.first + 1 && bond.first % 2)
        CHECK(bond.fate == BondFate::kept);
    }
    const BrokenBonds broken = brokenBonds(tracks);
    CHECK(broken.broken == fates["detached"] + fates["separated"]);
    CHECK(broken.kept == fates["kept"]);
    CHECK(broken.unknown == fates["unmatched"] + fates["undecided"]);
    bool isNew = false;
    for (const TrackedBond& bond : tracks.bondsAfter)
      isNew = isNew || (bond.fate == BondFate::created && bond.first == 90 && bond.second == 91);
    CHECK(isNew);
    CHECK(madeBy(inSlabs(a, layersOf(*a)), inSlabs(b, layersOf(*b)), options) ==
          madeBy(a, b, options));
    // What has fewer faces than a bond, or than a rough surface hides, is undecided.
    options.minFaces = 14;
    const auto undecided = [&] {
      std::set<std::pair<int32_t, int32_t>> bonds;
      for (const TrackedBond& bond : track(*a, *b, options).bondsBefore)
        if (bond.fate == BondFate::undecided && bond.second == bond.first + 1)
          bonds.insert({bond.first, bond.second});
      return bonds;
    };
    using Bonds = std::set<std::pair<int32_t, int32_t>>;
    CHECK(undecided() == Bonds{{11, 12}});
    options.sureFaces = 1000;
    CHECK(undecided() == Bonds{{1, 2}, {3, 4}, {5, 6}, {11, 12}});
    for (const TrackedBond& bond : track(*a, *b, options).bondsAfter)
      CHECK(bond.fate != BondFate::created);
    // A bond that gains faces is not made, if there were some.
    options.sureFaces = 0;
    for (const TrackedBond& bond : track(*b, *a, options).bondsAfter)
      if (bond.first == 11 && bond.second == 12) CHECK(bond.fate == BondFate::undecided);
    CHECK(brokenBonds(tracks, 1000).all() == 0);
    options = TrackOptions();
    options.motion = MatchOptions{kind, {}};
    // With a gap that reaches them all, none is separated.
    options.gap = kMaxGap;
    for (const TrackedBond& bond : track(*a, *b, options).bondsBefore)
      CHECK(bond.fate != BondFate::separated);
    const auto named = trackedLabels(*b, tracks);
    CHECK(named->tree().getValue(Coord::round(after[20])) == 21);
  }
  // Of a part of the sample the rest is outside, not lost; and from there it is followed back.
  TrackOptions options;
  options.motion = MatchOptions{};
  LabelMap visible;
  std::vector<double> along;
  for (const openvdb::Vec3d& center : after) along.push_back(center.x());
  std::sort(along.begin(), along.end());
  const int cut = int(along[along.size() * 7 / 10]);
  for (const auto& [p, label] : drawnBalls(there, thereNumbers, 5))
    if (p.x() <= cut) visible[p] = label;
  const auto part = labelGrid(visible);
  const CoordBBox box(Coord(-100), Coord(cut, 250, 250));
  MaskTree region;
  region.denseFill(box, true);
  region.setValueOn(Coord(250));  // its box has all
  for (const Domain& domain : {Domain(box), Domain(region)}) {
    setDomain(*part, domain);
    for (const auto& [first, second] : {std::pair(a, part), std::pair(part, a)}) {
      const Tracks tracks = track(*first, *second, options);
      const auto& whole = first == a ? tracks.before : tracks.after;
      const auto outside = std::count_if(whole.begin(), whole.end(), [](const TrackedGrain& g) {
        return g.fate == GrainFate::outside;
      });
      CHECK(outside > 10);
      int seen = 0, kept = 0;
      for (const TrackedGrain& grain : whole) {
        CAPTURE(grain.grain);
        if (after[size_t(grain.grain) - 1].x() > cut + 6) CHECK(grain.fate == GrainFate::outside);
        if (after[size_t(grain.grain) - 1].x() > cut - 7) continue;
        ++seen;
        kept += grain.fate == GrainFate::kept;
      }
      CHECK(kept > 0.8 * seen);
    }
  }
  options.gap = 0;
  CHECK_THROWS_AS(track(*a, *b, options), InvalidInput);
  options.gap = 2;
  options.sureFaces = -1;
  CHECK_THROWS_AS(track(*a, *b, options), InvalidInput);
  options.sureFaces = 16;
  CHECK_THROWS_WITH(track(*a, *labelGrid(twoBalls({0, 0, 0}, 5)), options),
                    vdb_madf::test::Contains("no motion is found"));
}

TEST_CASE("track: what a scan cuts of grains is no motion of theirs", "[track_motion]") {
  Dice dice(9);
  std::vector<openvdb::Vec3d> centers;
  for (const openvdb::Vec3d& center : packed(std::vector<double>(250, 5.5), dice))
    centers.push_back(center);
  std::vector<int32_t> numbers(centers.size());
  std::iota(numbers.begin(), numbers.end(), 1);
  const LabelMap drawn = drawnBalls(centers, numbers, 5);
  const CoordBBox box(Coord(4), Coord(62));
  const auto seen = [&](const Coord& shift) {
    LabelMap voxels;
    for (const auto& [p, label] : drawn)
      if (box.isInside(p + shift)) voxels[p + shift] = label;
    const auto labels = labelGrid(voxels);
    setDomain(*labels, box);
    return labels;
  };
  const Coord shift(2, -3, 1);
  const auto before = seen(Coord(0)), after = seen(shift);
  TrackOptions options;
  options.motion = MatchOptions{};
  const Tracks tracks = track(*before, *after, options);
  REQUIRE(tracks.whole);
  CHECK((tracks.whole->shift - shift.asVec3d()).length() < 1e-9);
  int cut = 0, strained = 0;
  for (const GrainMove& move : tracks.moves) {
    if (move.confidence == 0) continue;
    cut += move.isCut;
    if (!move.isCut || move.gradient) CHECK((move.displacement - shift.asVec3d()).length() < 1e-9);
    if (!move.gradient) continue;
    ++strained;
    CHECK(std::abs(strainOf(*move.gradient).volumetric) < 1e-9);
  }
  CHECK(cut > 20);
  CHECK(strained > 40);
  // All that is seen in one scan alone is so at its faces.
  for (const auto* side : {&tracks.before, &tracks.after})
    for (const TrackedGrain& grain : *side)
      CHECK((grain.fate == GrainFate::kept || grain.fate == GrainFate::outside));
  // Where the boundary is closed, nothing is cut.
  for (const auto& labels : {before, after}) setBoundary(*labels, Boundary::closed);
  for (const GrainMove& move : track(*before, *after, options).moves) CHECK_FALSE(move.isCut);
}

TEST_CASE("track: of labels in slabs the domain and a motion have to be known", "[track_motion]") {
  const auto labels = labelGrid(twoBalls({0, 0, 0}, 5));
  const LabelSlabs slabs = inSlabs(labels, {-8, 0, 8, 16});
  TrackOptions options;
  CHECK_THROWS_WITH(track(slabs, labels, options), vdb_madf::test::Contains("with a motion alone"));
  options.motion = MatchOptions{};
  CHECK_THROWS_WITH(track(labels, slabs, options), vdb_madf::test::Contains("domain"));
}

TEST_CASE("track: grains that split or merge in a motion are told", "[track_motion]") {
  Dice dice(6);
  std::vector<openvdb::Vec3d> before, after;
  std::vector<int32_t> numbers;
  const openvdb::Mat3d turn = turnAbout({0, 0, 1}, 20);
  for (const openvdb::Vec3d& middle : packed(std::vector<double>(40, 12), dice))
    for (const double side : {-4.5, 4.5}) {
      before.push_back(middle + openvdb::Vec3d(side, 0, 0));
      after.push_back(turn * before.back() + openvdb::Vec3d(30, 5, -8));
      numbers.push_back(int32_t(numbers.size()) + 1);
    }
  const auto whole = labelGrid(drawnBalls(before, numbers, 5));
  LabelMap changed = drawnBalls(after, numbers, 5);
  for (auto& [p, label] : changed) {
    const double along =
        label <= 80 ? (p.asVec3d() - after[size_t(label) - 1]).dot(turn * openvdb::Vec3d(1, 0, 0))
                    : 0;
    if (label == 21 && along > 0) label = 121;    // halves
    if (label == 31 && along > 1.5) label = 131;  // a smaller part
    if (label == 42) label = 41;
    if (label == 52 && along > 4) label = 152;    // a crumb
    if (label == 61 && along > 3.2) label = 161;  // what is at its bond
  }
  const auto parts = labelGrid(changed);
  for (const auto& labels : {whole, parts}) setDomain(*labels, CoordBBox(Coord(-100), Coord(200)));
  TrackOptions options;
  options.motion = MatchOptions{};
  for (const bool isMirrored : {false, true}) {
    CAPTURE(isMirrored);
    const Tracks tracks =
        isMirrored ? track(*parts, *whole, options) : track(*whole, *parts, options);
    if (isMirrored)
      CHECK(madeBy(inSlabs(parts, layersOf(*parts)), whole, options) ==
            madeBy(parts, whole, options));
    else
      CHECK(madeBy(whole, inSlabs(parts, layersOf(*parts)), options) ==
            madeBy(whole, parts, options));
    const GrainFate apart = isMirrored ? GrainFate::merged : GrainFate::split,
                    together = isMirrored ? GrainFate::split : GrainFate::merged;
    const auto expected = [&](int32_t grain) {
      const bool isApart = grain == 21 || grain == 121 || grain == 31 || grain == 131;
      return isApart ? apart : grain == 41 || grain == 42 ? together : GrainFate::kept;
    };
    for (const auto* side : {&tracks.before, &tracks.after})
      for (const TrackedGrain& grain : *side) {
        CAPTURE(side == &tracks.before, grain.grain);
        if (grain.grain < 150) CHECK(grain.fate == expected(grain.grain));
        CHECK((moveOf(tracks)(grain) != nullptr) == (grain.fate == GrainFate::kept));
        if (grain.fate == GrainFate::kept) CHECK(grain.track == grain.grain);
      }
    for (const TrackedBond& bond : tracks.bondsBefore) {
      if (bond.first == 41 && bond.second == 42) CHECK(bond.fate == BondFate::inside);
      if (bond.first == 61 && bond.second == 62) CHECK(bond.fate == BondFate::undecided);
    }
  }
}
