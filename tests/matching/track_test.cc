// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/track.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <tuple>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/label_digest.h"
#include "vdb_madf/matching/detail/rigid_shift.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

LabelMap moved(const LabelMap& voxels, const Coord& shift) {
  LabelMap result;
  for (const auto& [p, label] : voxels) result[p + shift] = label;
  return result;
}

/// Those in a domain that has moved.
LabelMap within(const LabelMap& voxels, const std::optional<Domain>& domain,
                const Coord& shift = Coord(0)) {
  LabelMap result;
  for (const auto& [p, label] : voxels)
    if (!domain || domain->isInside(p - shift)) result[p] = label;
  return result;
}

int64_t common(const LabelMap& before, const LabelMap& after, const Coord& shift) {
  return std::count_if(before.begin(), before.end(),
                       [&](const auto& voxel) { return after.count(voxel.first + shift) > 0; });
}

/// Every shift, in the order of the definition.
Coord naiveShift(const LabelMap& before, const LabelMap& after, int most) {
  std::tuple<int64_t, int, Coord> best{1, 0, {}};
  for (int x = -most; x <= most; ++x)
    for (int y = -most; y <= most; ++y)
      for (int z = -most; z <= most; ++z) {
        const std::tuple<int64_t, int, Coord> here{
            -common(before, after, {x, y, z}), x * x + y * y + z * z, {x, y, z}};
        best = std::min(best, here);
      }
  return std::get<2>(best);
}

/// Voxels that cluster: cells of a few random points within a random union of balls.
LabelMap cells(unsigned seed, int side, int count) {
  std::mt19937 random(seed);
  std::vector<Coord> centers;
  const auto place = [&] { return int(random() % unsigned(side)); };
  for (int n = 0; n < count; ++n) centers.emplace_back(place(), place(), place());
  LabelMap voxels;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z) {
        int best = 0, least = 1 << 30;
        for (int n = 0; n < count; ++n) {
          const Coord d = centers[size_t(n)] - Coord(x, y, z);
          const int away = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
          if (away < least) std::tie(best, least) = std::pair(n, away);
        }
        if (least < side * side / 30) voxels[Coord(x - 7, y + 3, z - side)] = 3 * best + 2;
      }
  return voxels;
}

/// The part of a box that is in a cylinder along z through its middle.
Domain withoutCorners(const Domain& domain) {
  const CoordBBox& box = domain.box();
  const Coord twice = box.min() + box.max(), dim = box.dim();
  MaskTree region;
  for (auto p = box.begin(); p; ++p) {
    const int x = 2 * (*p).x() - twice.x(), y = 2 * (*p).y() - twice.y();
    if (x * x + y * y <= dim.x() * dim.y()) region.setValueOn(*p);
  }
  return Domain(region);
}

/// Leaves what a scan shows.
void cut(Int32Grid& grid, LabelMap& voxels, const Domain& domain) {
  voxels = within(voxels, domain);
  grid.clear();
  for (const auto& [p, label] : voxels) grid.tree().setValueOn(p, label);
  setDomain(grid, domain);
}

using Linked = std::map<int32_t, std::set<int32_t>>;

/// By the definitions of track.h, voxel by voxel.
void requireAsDefined(const Tracks& tracks, const LabelMap& before, const LabelMap& after,
                      const std::optional<Domain>& domainBefore,
                      const std::optional<Domain>& domainAfter, const TrackOptions& options) {
  const Coord& shift = tracks.shift;
  const LabelMap a = within(moved(before, shift), domainAfter),
                 b = within(after, domainBefore, shift);
  const auto sizesA = volumes(a), sizesB = volumes(b);
  std::map<std::pair<int32_t, int32_t>, int64_t> overlaps;
  for (const auto& [p, label] : a)
    if (const auto other = b.find(p); other != b.end()) ++overlaps[{label, other->second}];
  Linked fromA, fromB;
  int64_t both = 0;
  REQUIRE(tracks.overlaps.size() == overlaps.size());
  size_t row = 0;
  for (const auto& [pair, voxels] : overlaps) {
    const bool isLink = double(voxels) >= options.share * double(std::min(sizesA.at(pair.first),
                                                                          sizesB.at(pair.second)));
    const GrainOverlap& overlap = tracks.overlaps[row++];
    REQUIRE(overlap.before == pair.first);
    REQUIRE(overlap.after == pair.second);
    REQUIRE(overlap.voxels == voxels);
    REQUIRE(overlap.isLink == isLink);
    both += voxels;
    if (!isLink) continue;
    fromA[pair.first].insert(pair.second);
    fromB[pair.second].insert(pair.first);
  }
  CHECK(tracks.commonVoxels == both);
  CHECK(tracks.voxelsBefore == int64_t(a.size()));
  CHECK(tracks.voxelsAfter == int64_t(b.size()));

  const auto checkGrains = [&](const std::vector<TrackedGrain>& grains, const LabelMap& all,
                               const std::map<int32_t, int64_t>& shared, const Linked& own,
                               const Linked& other, bool isBefore) {
    const auto sizes = volumes(all);
    REQUIRE(grains.size() == sizes.size());
    size_t n = 0;
    for (const auto& [number, voxels] : sizes) {
      CAPTURE(isBefore, number);
      const TrackedGrain& grain = grains[n++];
      REQUIRE(grain.grain == number);
      CHECK(grain.voxels == voxels);
      CHECK(grain.sharedVoxels == (shared.count(number) ? shared.at(number) : 0));
      const std::set<int32_t> links = own.count(number) ? own.at(number) : std::set<int32_t>();
      CHECK(grain.links == int64_t(links.size()));
      int32_t partner = 0;
      int64_t most = 0;
      for (const auto& [pair, count] : overlaps)
        if ((isBefore ? pair.first : pair.second) == number && count > most)
          std::tie(partner, most) = std::pair(isBefore ? pair.second : pair.first, count);
      CHECK(grain.partner == partner);
      CHECK(grain.overlapVoxels == most);
      std::string fate = isBefore ? "vanished" : "new";
      if (!shared.count(number)) fate = "outside";
      if (links.size() > 1) fate = isBefore ? "split" : "merged";
      if (links.size() == 1) {
        fate = "kept";
        if (other.at(*links.begin()).size() > 1) fate = isBefore ? "merged" : "split";
      }
      CHECK(toString(grain.fate) == fate);
    }
  };
  checkGrains(tracks.before, before, sizesA, fromA, fromB, true);
  checkGrains(tracks.after, after, sizesB, fromB, fromA, false);

  // Numbers, pair by pair.
  std::map<int32_t, int32_t> numbers;
  std::set<int32_t> used;
  for (;;) {
    std::tuple<int64_t, int32_t, int32_t> best{0, 0, 0};
    for (const auto& [first, linked] : fromA)
      for (const int32_t second : linked)
        if (!used.count(first) && !numbers.count(second))
          best = std::min(best, {-overlaps.at({first, second}), first, second});
    if (std::get<0>(best) == 0) break;
    numbers[std::get<2>(best)] = std::get<1>(best);
    used.insert(std::get<1>(best));
  }
  int32_t last = before.empty() ? 0 : volumes(before).rbegin()->first;
  for (const auto& [number, voxels] : volumes(after))
    if (!numbers.count(number)) numbers[number] = ++last;
  for (const TrackedGrain& grain : tracks.after) CHECK(grain.track == numbers.at(grain.grain));
  for (const TrackedGrain& grain : tracks.before) CHECK(grain.track == grain.grain);

  const auto contacts = [&](const LabelMap& voxels) {
    std::map<std::pair<int32_t, int32_t>, int64_t> faces;
    for (const auto& [p, label] : voxels)
      for (int axis = 0; axis < 3; ++axis) {
        Coord next = p;
        ++next[axis];
        if (const auto other = voxels.find(next); other != voxels.end() && other->second != label)
          ++faces[std::minmax(label, other->second)];
      }
    for (auto pair = faces.begin(); pair != faces.end();)
      pair = pair->second < options.minFaces ? faces.erase(pair) : std::next(pair);
    return faces;
  };
  const auto bondsA = contacts(before), bondsB = contacts(after), sharedA = contacts(a),
             sharedB = contacts(b);
  const auto checkBonds = [&](const std::vector<TrackedBond>& bonds, const auto& own,
                              const auto& shared, const auto& there, const Linked& links,
                              const std::string& lost) {
    REQUIRE(bonds.size() == own.size());
    size_t n = 0;
    for (const auto& [pair, faces] : own) {
      const TrackedBond& bond = bonds[n++];
      REQUIRE(bond.first == pair.first);
      REQUIRE(bond.second == pair.second);
      REQUIRE(bond.faces == faces);
      std::string fate = "unmatched";
      if (links.count(pair.first) && links.count(pair.second)) {
        const auto &first = links.at(pair.first), &second = links.at(pair.second);
        fate = lost;
        for (const int32_t x : first)
          if (second.count(x)) fate = "inside";
        for (const int32_t x : first)
          for (const int32_t y : second)
            if (x != y && there.count(std::minmax(x, y))) fate = "kept";
      }
      if (!shared.count(pair)) fate = "outside";
      CHECK(bond.sharedFaces <= faces);
      if (shared.count(pair)) CHECK(bond.sharedFaces == shared.at(pair));
      CHECK(toString(bond.fate) == fate);
    }
  };
  checkBonds(tracks.bondsBefore, bondsA, sharedA, sharedB, fromA, "broken");
  checkBonds(tracks.bondsAfter, bondsB, sharedB, sharedA, fromB, "new");
}

/// Some of the grains are merged, dropped, halved, renumbered, and loose voxels are added.
LabelMap changed(LabelMap voxels, std::mt19937& random) {
  std::vector<int32_t> labels;
  for (const auto& [label, size] : volumes(voxels)) labels.push_back(label);
  std::shuffle(labels.begin(), labels.end(), random);
  std::map<int32_t, int32_t> edited;  // the label of each one; none: it is dropped
  for (size_t i = 1; i < labels.size(); ++i) edited[labels[i]] = labels[i == 2 ? 1 : i];
  if (random() % 2)
    for (auto& [label, after] : edited) after = 1 + (after - 1) * 7 % 400;
  const int32_t halved = labels[random() % 2 ? 1 : 3];
  LabelMap result;
  for (const auto& [p, label] : voxels)
    if (edited.count(label)) result[p] = label == halved && p.x() % 16 < 4 ? 500 : edited.at(label);
  for (int n = 0; n < 6; ++n)
    result[voxels.begin()->first.offsetBy(int(random() % 20), int(random() % 20), -3)] = 700 + n;
  return result;
}

}  // namespace

TEST_CASE("track: the shift is the best of all", "[track]") {
  for (unsigned seed = 1; seed <= 24; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    const LabelMap before = randomLabels(seed, Coord(-11, 4, 90), 9, 5, 4 + int(seed * 4));
    const auto some = [&] { return int(random() % 7) - 3; };
    LabelMap after = moved(before, {some(), some(), some()});
    for (auto voxel = after.begin(); voxel != after.end();)
      voxel = random() % 4 == 0 ? after.erase(voxel) : std::next(voxel);
    if (seed % 5 == 0) after = randomLabels(seed + 100, Coord(-11, 4, 91), 9, 5, 20);
    const auto a = detail::labelledVoxels(*labelGrid(before)),
               b = detail::labelledVoxels(*labelGrid(after));
    for (const int most : {0, 1, 3}) {
      const Coord expected = naiveShift(before, after, most);
      CHECK(detail::findShift(a, b, most, nullptr) == expected);
      CHECK(detail::commonVoxels(a, b, expected, nullptr) == common(before, after, expected));
    }
    for (int n = 0; n < 20; ++n) {
      const Coord shift(int(random() % 60) - 30, int(random() % 60) - 30, some());
      CHECK(detail::commonVoxels(a, b, shift, nullptr) == common(before, after, shift));
    }
  }
}

TEST_CASE("track: a long shift is found", "[track]") {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    const LabelMap before = cells(seed, 40, 30);
    const int most = seed % 2 ? 10 : 25;
    const auto some = [&] { return int(random() % unsigned(2 * most + 1)) - most; };
    const Coord shift(some(), some(), some());
    LabelMap after = moved(before, shift);
    for (auto voxel = after.begin(); voxel != after.end();)  // another part of it is seen
      voxel = voxel->first.x() < shift.x() ? after.erase(voxel) : std::next(voxel);
    TrackOptions options;
    options.maxShift = most;
    CHECK(track(*labelGrid(before), *labelGrid(after), options).shift == shift);
  }
}

TEST_CASE("track: as defined, on samples that were moved and edited", "[track]") {
  std::map<std::string, int> fates, bonds;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    LabelMap before = cells(seed, 22, 14 + int(seed % 9)), after = changed(before, random);
    if (seed % 2) std::swap(before, after);
    const Coord shift(int(random() % 7) - 3, int(random() % 7) - 3, int(random() % 7) - 3);
    after = moved(after, shift);
    TrackOptions options;
    options.maxShift = 3;
    options.minFaces = 1 + int(seed % 3) * 4;
    if (seed % 4 == 0) options.share = seed % 8 ? 0.9 : 0.2;
    if (seed % 5 == 0) options.shift = Coord(int(random() % 30) - 15, 1, 0);
    std::optional<Domain> domainBefore, domainAfter;
    const auto a = labelGrid(before), b = labelGrid(after);
    if (seed % 3 > 0) {
      domainBefore = CoordBBox(Coord(-7, 3, -22), Coord(14, 24, -1));
      if (seed % 2) domainBefore = withoutCorners(*domainBefore);
      cut(*a, before, *domainBefore);
    }
    if (seed % 3 > 1) {  // the faces of what is seen lie elsewhere: some grains are cut or gone
      domainAfter = CoordBBox(Coord(-7, 9, -30), Coord(11, 30, -1));
      if (seed % 4 < 2) domainAfter = withoutCorners(*domainAfter);
      cut(*b, after, *domainAfter);
    }
    const Tracks tracks = track(*a, *b, options);
    CHECK(tracks.shift == options.shift.value_or(shift));
    requireAsDefined(tracks, before, after, domainBefore, domainAfter, options);
    for (const auto* side : {&tracks.before, &tracks.after})
      for (const TrackedGrain& grain : *side) ++fates[toString(grain.fate)];
    for (const auto* side : {&tracks.bondsBefore, &tracks.bondsAfter})
      for (const TrackedBond& bond : *side) ++bonds[toString(bond.fate)];

    const auto named = trackedLabels(*b, tracks);
    REQUIRE(named->activeVoxelCount() == after.size());
    std::map<int32_t, int32_t> numbers;
    for (const TrackedGrain& grain : tracks.after) numbers[grain.grain] = grain.track;
    for (const auto& [p, label] : after) REQUIRE(named->tree().getValue(p) == numbers.at(label));
    CHECK(storedDomain(*named) == storedDomain(*b));
  }
  for (const char* fate : {"kept", "split", "merged", "vanished", "new", "outside"}) {
    CAPTURE(fate);
    CHECK(fates[fate] > 3);
  }
  for (const char* fate : {"kept", "broken", "new", "inside", "unmatched", "outside"}) {
    CAPTURE(fate);
    CHECK(bonds[fate] > 0);
  }
}

TEST_CASE("track: what was edited is told", "[track]") {
  // A row of grains of 4 voxels; 1 and 2 become one, 4 goes, 5 comes apart, 9 is new.
  const auto row = [](const std::vector<int32_t>& labels, int first) {
    LabelMap voxels;
    for (size_t i = 0; i < labels.size(); ++i)
      if (labels[i]) voxels[Coord(0, 0, first + int(i))] = labels[i];
    return labelGrid(voxels);
  };
  const auto a = row({1, 1, 1, 1, 2, 2, 2, 3, 3, 3, 3, 4, 4, 5, 5, 5, 5, 6, 6, 6}, 0);
  const auto b = row({7, 7, 7, 7, 7, 7, 7, 8, 8, 8, 8, 0, 0, 5, 5, 1, 1, 6, 6, 6, 0, 9}, 40);
  TrackOptions options;
  options.shift = Coord(0, 0, 40);
  const Tracks tracks = track(*a, *b, options);
  std::string before, after, bonds;
  for (const TrackedGrain& g : tracks.before)
    before += std::to_string(g.grain) + " " + toString(g.fate) + "; ";
  for (const TrackedGrain& g : tracks.after)
    after +=
        std::to_string(g.grain) + " " + toString(g.fate) + " as " + std::to_string(g.track) + "; ";
  CHECK(before == "1 merged; 2 merged; 3 kept; 4 vanished; 5 split; 6 kept; ");
  CHECK(after ==
        "1 split as 5; 5 split as 7; 6 kept as 6; 7 merged as 1; 8 kept as 3; 9 new as 8; ");
  for (const TrackedBond& bond : tracks.bondsBefore)
    bonds += std::to_string(bond.first) + "-" + std::to_string(bond.second) + " " +
             toString(bond.fate) + "; ";
  CHECK(bonds == "1-2 inside; 2-3 kept; 3-4 unmatched; 4-5 unmatched; 5-6 kept; ");
}

TEST_CASE("track: numbers are not used again in a series", "[track]") {
  const auto grain = [](int32_t number, int place) {
    return labelGrid({{Coord(place), number}, {Coord(place, place, place + 1), number}});
  };
  TrackOptions still;
  still.shift = Coord(0);
  const auto second = grain(3, 20);
  const auto tracked = trackedLabels(*second, track(*grain(8, 0), *second, still));
  CHECK(tracked->tree().getValue(Coord(20)) == 9);
  const auto third = labelGrid({});
  const auto none = trackedLabels(*third, track(*tracked, *third, still));
  const auto fourth = grain(1, 40);
  CHECK(track(*none, *fourth, still).after[0].track == 10);
  none->insertMeta(kLastTrackKey, openvdb::Int64Metadata(2147483647));
  CHECK_THROWS_WITH(track(*none, *fourth, still), vdb_madf::test::Contains("no numbers left"));
  none->insertMeta(kLastTrackKey, openvdb::Int64Metadata(-5));
  CHECK(track(*none, *fourth, still).after[0].track == 1);
}

TEST_CASE("track: labels without voxels, and with tiles", "[track]") {
  const auto none = Int32Grid::create(0), balls = labelGrid(twoBalls({0, 0, 0}, 5));
  const Tracks empty = track(*none, *none);
  CHECK(empty.shift == Coord(0));
  CHECK(empty.before.empty());
  CHECK(track(*balls, *none).before.size() == 2);
  CHECK(track(*none, *balls).after[0].track == 1);
  const auto tiles = Int32Grid::create(0);
  tiles->fill(CoordBBox(Coord(0), Coord(127)), 4);
  tiles->fill(CoordBBox(Coord(128, 0, 0), Coord(135, 127, 127)), 9);
  REQUIRE(tiles->tree().activeTileCount() > 0);
  const Tracks self = track(*tiles, *tiles);
  CHECK(self.shift == Coord(0));
  CHECK(self.commonVoxels == 136 * 128 * 128);
  REQUIRE(self.bondsBefore.size() == 1);
  CHECK(self.bondsBefore[0].faces == 128 * 128);
  CHECK(self.bondsBefore[0].fate == BondFate::kept);
}

TEST_CASE("track: options out of range are refused, and work can be stopped", "[track]") {
  const auto balls = labelGrid(twoBalls({0, 0, 0}, 5));
  const auto refused = [&](const std::function<void(TrackOptions&)>& change) {
    TrackOptions options;
    change(options);
    CHECK_THROWS_AS(track(*balls, *balls, options), InvalidInput);
  };
  refused([](TrackOptions& o) { o.maxShift = -1; });
  refused([](TrackOptions& o) { o.maxShift = kMaxShift + 1; });
  for (const double share : {0.0, -0.5, 1.01, std::nan("")})
    refused([&](TrackOptions& o) { o.share = share; });
  refused([](TrackOptions& o) { o.minFaces = -1; });
  // What is not looked at.
  refused([](TrackOptions& o) { o.gap = 3; });
  refused([](TrackOptions& o) { o.sureFaces = 100; });
  refused([](TrackOptions& o) {
    o.motion = MatchOptions{};
    o.share = 0.9;
  });
  refused([](TrackOptions& o) {
    o.motion = MatchOptions{};
    o.maxShift = 0;
  });
  refused([](TrackOptions& o) { o.shift = Coord(0, 1 << 30, 0); });
  StopAtOnce stop;
  CHECK_THROWS_AS(track(*balls, *balls, {}, &stop), Interrupted);
}

TEST_CASE("track: the same for any number of threads", "[track]") {
  const LabelMap before = cells(3, 48, 40);
  std::mt19937 random(5);
  const auto a = labelGrid(before), b = labelGrid(moved(changed(before, random), {5, -7, 2}));
  const auto run = [&](int threads) {
    return withThreads(threads, [&] {
      const Tracks tracks = track(*a, *b);
      return std::pair(labelDigest(*trackedLabels(*b, tracks)), tracks.shift);
    });
  };
  CHECK(run(1) == run(4));
  CHECK(run(2).second == Coord(5, -7, 2));
}
