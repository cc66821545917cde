// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Areas of unions of grains, put together join by join, against those of labels that were joined.

#include "vdb_madf/measure/detail/joined_areas.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/random_volume.h"
#include "vdb_madf/measure/detail/leaf_surface.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::JoinedAreas;
using detail::NamedJoin;

namespace {

/// Cells of random points in a body, labels 1 to their number.
LabelMap cells(Rng& rng, const CoordBBox& box, int count, double filled) {
  std::vector<Coord> seeds;
  for (int i = 0; i < count; ++i)
    seeds.emplace_back(rng.between(box.min().x(), box.max().x()),
                       rng.between(box.min().y(), box.max().y()),
                       rng.between(box.min().z(), box.max().z()));
  LabelMap voxels;
  for (auto p = box.begin(); p != box.end(); ++p) {
    if (!rng.chance(filled)) continue;
    const auto away = [&](const Coord& seed) {
      return ((*p).asVec3d() - seed.asVec3d()).lengthSqr();
    };
    const auto nearest =
        std::min_element(seeds.begin(), seeds.end(),
                         [&](const Coord& a, const Coord& b) { return away(a) < away(b); });
    voxels[*p] = int32_t(nearest - seeds.begin()) + 1;
  }
  // Without gaps in the numbers.
  std::map<int32_t, int32_t> number;
  for (const auto& [p, label] : voxels) number.emplace(label, 0);
  int32_t next = 0;
  for (auto& [label, its] : number) its = ++next;
  for (auto& [p, label] : voxels) label = number.at(label);
  return voxels;
}

/// One join of any two names after another.
std::vector<NamedJoin> randomJoins(Rng& rng, std::vector<uint32_t> names) {
  std::vector<NamedJoin> joins;
  while (names.size() > 1) {
    const size_t kept = size_t(rng.below(int(names.size()))),
                 gone = size_t(rng.below(int(names.size())));
    if (kept == gone) continue;
    joins.push_back({names[kept], names[gone]});
    names.erase(names.begin() + std::ptrdiff_t(gone));
  }
  return joins;
}

/// The name of each name after so many joins.
std::vector<uint32_t> namesAfter(const std::vector<NamedJoin>& joins, size_t made, size_t count) {
  std::vector<uint32_t> names(count);
  std::iota(names.begin(), names.end(), 0u);
  for (size_t join = made; join-- > 0;) names[joins[join].gone] = names[joins[join].kept];
  return names;
}

/// Sums of what is known before all joins, and of what they add.
class Sums {
 public:
  Sums(const JoinedAreas& joined, const std::vector<NamedJoin>& joins,
       const std::vector<uint32_t>& nameOfLabel, const Measurements& parts)
      : joined_(joined), joins_(joins), nameOfLabel_(nameOfLabel), parts_(parts) {}

  /// How many numbers are not those of labels that were joined, called by their name and 1 more.
  size_t wrong(size_t made, const std::vector<uint32_t>& now, const Measurements& expected) const {
    std::map<std::pair<uint32_t, uint32_t>, JoinedAreas::Areas> areas, faces;
    const auto add = [](auto& to, uint32_t one, uint32_t two, const auto& from, int sign) {
      if (one == two) return;
      for (size_t i = 0; i < 3; ++i) to[std::minmax(one, two)][i] += sign * from[i];
    };
    for (const JoinedAreas::Contact& contact : joined_.contacts) {
      const uint32_t one = now[nameOf(contact.first)], two = now[nameOf(contact.second)];
      add(areas, one, two, contact.areas, 1);
      add(faces, one, two, contact.faces, one < two ? 1 : -1);
    }
    for (const JoinedAreas::Change& change : joined_.changes)
      if (change.join < made)
        add(areas, now[joins_[change.join].kept], now[change.other], change.areas, 1);
    size_t wrong = 0;
    const detail::VoxelShape voxel{expected.edges};
    for (const BondMeasures& bond : expected.bonds) {
      const std::pair<uint32_t, uint32_t> pair(bond.first - 1, bond.second - 1);
      wrong += detail::bondArea(areas[pair], voxel) != bond.area;
      openvdb::Vec3d normal;
      for (int k = 0; k < 3; ++k) normal[k] = double(faces[pair][size_t(k)]) * voxel.faceArea(k);
      wrong += normal.normalize(0) && normal != bond.normal;
    }
    std::map<uint32_t, double> free;
    for (const GrainMeasures& part : parts_.grains) free[now[nameOf(part.id)]] += part.freeArea;
    for (size_t join = 0; join < made; ++join)
      free[now[joins_[join].kept]] += double(joined_.freeAreas[join]) / detail::kAreaUnit;
    for (const GrainMeasures& grain : expected.grains)
      wrong += std::abs(free.at(uint32_t(grain.id) - 1) - grain.freeArea) > 1e-9;
    return wrong;
  }

 private:
  uint32_t nameOf(int32_t label) const { return nameOfLabel_[size_t(label) - 1]; }

  const JoinedAreas& joined_;
  const std::vector<NamedJoin>& joins_;
  const std::vector<uint32_t>& nameOfLabel_;
  const Measurements& parts_;
};

/// Stretches voxels along z.
Int32Grid::Ptr gridOf(const LabelMap& voxels, double edge) {
  const auto grid = labelGrid(voxels);
  const auto transform = openvdb::math::Transform::createLinearTransform(1);
  transform->preScale({1, 1, edge});
  grid->setTransform(transform);
  return grid;
}

}  // namespace

TEST_CASE("joined_areas: are those of joined labels, after any number of joins", "[joined_areas]") {
  for (const uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    CAPTURE(seed);
    Rng rng(seed);
    const CoordBBox box({-5, 3, -9}, {14, 21, 12});
    const LabelMap voxels = cells(rng, box, seed == 6 ? 40 : 14, seed % 2 ? 0.8 : 1);
    const double edge = seed == 3 ? 2.5 : 1;
    MeasureOptions options;
    if (seed != 4) options.domain = box;
    const auto labels = gridOf(voxels, edge);
    const Measurements parts = measure(*labels, options);
    std::vector<uint32_t> names(parts.grains.size() + 1), nameOfLabel;
    std::iota(names.begin(), names.end(), 0u);
    for (const uint32_t name : names)
      if (name != 2) nameOfLabel.push_back(name);  // 2 has no voxel
    const std::vector<NamedJoin> joins = randomJoins(rng, names);
    detail::JoinedAreasCounter counter(options.domain, detail::VoxelShape{{1, 1, edge}},
                                       nameOfLabel, joins);
    // In two slabs, or in one.
    const detail::LabelLeaves leaves(*labels, nullptr);
    if (seed == 1) {
      counter.add(leaves, {0, 64}, nullptr);
      counter.add(leaves, {-64, 0}, nullptr);
    } else {
      counter.add(leaves, {}, nullptr);
    }
    const JoinedAreas joined = counter.areas();
    CHECK_FALSE(joined.changes.empty());
    CHECK(std::is_sorted(joined.changes.begin(), joined.changes.end(),
                         [](const auto& a, const auto& b) { return a.join < b.join; }));
    const Sums sums(joined, joins, nameOfLabel, parts);
    for (size_t made = seed % 4; made <= joins.size(); made += 4) {  // measuring takes time
      CAPTURE(made);
      const std::vector<uint32_t> now = namesAfter(joins, made, names.size());
      LabelMap united = voxels;
      for (auto& [p, label] : united) label = int32_t(now[nameOfLabel[size_t(label) - 1]]) + 1;
      CHECK(sums.wrong(made, now, measure(*gridOf(united, edge), options)) == 0);
    }
  }
}

TEST_CASE("joined_areas: without joins, nothing changes", "[joined_areas]") {
  const auto labels = labelGrid(twoBalls({3, 4, 5}, 9));
  std::vector<uint32_t> names{0, 1, 2, 3, 4, 5, 6};
  detail::JoinedAreasCounter counter(std::nullopt, {}, names, {});
  counter.add({*labels, nullptr}, {}, nullptr);
  const JoinedAreas joined = counter.areas();
  REQUIRE(joined.contacts.size() == 1);
  CHECK(joined.contacts[0].first == 3);
  CHECK(joined.contacts[0].second == 7);
  CHECK(joined.changes.empty());
  CHECK(joined.freeAreas.empty());
}
