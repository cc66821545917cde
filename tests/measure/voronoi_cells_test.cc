// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <array>
#include <map>
#include <set>
#include <tuple>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

Measurements measureCells(const Int32Grid& labels) {
  MeasureOptions options;
  options.cells = true;
  return measure(labels, options);
}

/// Volume, neighbors, at the face of the domain.
using Cells = std::map<int32_t, std::tuple<double, int, bool>>;

Cells cellsOf(const Measurements& measured) {
  Cells cells;
  for (const GrainMeasures& grain : measured.grains)
    cells[grain.id] = {grain.cell->volume, grain.cell->neighbors, grain.cell->atDomainFace};
  return cells;
}

/// By the definition: each voxel of the domain looks at all voxels.
Cells cellsByDefinition(const LabelMap& voxels, const Domain& domain,
                        const std::array<int, 3>& weights, double voxelVolume) {
  std::map<Coord, int32_t> cellAt;
  const CoordBBox box = domain.box();
  for (auto p = box.begin(); p; ++p) {
    if (!domain.isInside(*p)) continue;
    std::pair<int, int32_t> least{1 << 30, 0};
    for (const auto& [q, label] : voxels) {
      int squared = 0;
      for (size_t i = 0; i < 3; ++i)
        squared += weights[i] * (q[i] - (*p)[int(i)]) * (q[i] - (*p)[int(i)]);
      least = std::min(least, {squared, label});
    }
    cellAt[*p] = least.second;
  }
  std::map<int32_t, int64_t> sizes;
  std::map<int32_t, std::set<int32_t>> neighbors;
  std::set<int32_t> atFace;
  for (const auto& [p, label] : cellAt) {
    ++sizes[label];
    for (int i = 0; i < 6; ++i) {
      Coord beside = p;
      beside[i / 2] += i % 2 ? 1 : -1;
      const auto other = cellAt.find(beside);
      if (other == cellAt.end())
        atFace.insert(label);
      else if (other->second != label)
        neighbors[label].insert(other->second);
    }
  }
  Cells cells;
  for (const auto& [label, size] : sizes)
    cells[label] = {voxelVolume * double(size), int(neighbors[label].size()), atFace.count(label)};
  return cells;
}

}  // namespace

TEST_CASE("voronoi_cells: each voxel is its nearest grain's, by brute force", "[voronoi_cells]") {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Coord origin(-5, 6, -11 + int(seed));
    // From a single voxel in the box to a third of it, where ties abound.
    const LabelMap voxels = randomLabels(seed, origin, 11, 2 + int(seed), 1 + int(seed) * 3);
    if (voxels.empty()) continue;
    const auto labels = labelGrid(voxels);
    std::array<int, 3> weights{1, 1, 1};
    double volume = 1;
    if (seed % 3 == 1) {  // edges 2, 2, 3: squares of 4, 4, 9, volume 1.5 of the shortest
      labels->setTransform(openvdb::math::Transform::createLinearTransform(
          openvdb::Mat4d(2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1)));
      weights = {4, 4, 9};
      volume = 1.5;
    }
    Domain domain(CoordBBox(origin.offsetBy(-2), origin.offsetBy(13, 12, 14)));
    if (seed % 4 == 2) {  // a region with a hole
      MaskTree region;
      region.fill(domain.box(), true);
      CoordBBox hole(origin.offsetBy(-1), origin.offsetBy(4));
      for (auto p = hole.begin(); p; ++p)
        if (!voxels.count(*p)) region.setValueOff(*p);
      domain = Domain(region);
    }
    CAPTURE(seed);
    if (seed % 4 == 3)
      domain = Domain(labels->evalActiveVoxelBoundingBox());  // what stands for an unknown one
    else
      setDomain(*labels, domain);
    CHECK(cellsOf(measureCells(*labels)) == cellsByDefinition(voxels, domain, weights, volume));
  }
}

TEST_CASE("voronoi_cells: balls on a lattice have cubes", "[voronoi_cells]") {
  constexpr int kPeriod = 9, kBalls = 4;
  LabelMap voxels;
  for (int i = 0; i < kBalls * kBalls * kBalls; ++i) {
    const Coord center(i / 16 * kPeriod + kPeriod / 2, i / 4 % 4 * kPeriod + kPeriod / 2,
                       i % 4 * kPeriod + kPeriod / 2);
    const CoordBBox reach(center.offsetBy(-3), center.offsetBy(3));
    for (auto p = reach.begin(); p; ++p) {
      const Coord d = *p - center;
      if (d.x() * d.x() + d.y() * d.y() + d.z() * d.z() <= 10) voxels[*p] = 100 - i;
    }
  }
  const auto labels = labelGrid(voxels);
  setDomain(*labels, CoordBBox(Coord(0), Coord(kPeriod * kBalls - 1)));
  const Measurements measured = measureCells(*labels);
  int within = 0;
  for (const GrainMeasures& grain : measured.grains) {
    CHECK(grain.cell->volume == kPeriod * kPeriod * kPeriod);
    CHECK(grain.localSolidFraction() == grain.volume / (kPeriod * kPeriod * kPeriod));
    CHECK(grain.cell->atDomainFace == (grain.cell->neighbors < 6));
    within += !grain.cell->atDomainFace;
  }
  CHECK(within == 8);
  CHECK_FALSE(measure(*labels).grains.front().cell);
}

TEST_CASE("voronoi_cells: nothing to measure, and domains that are too large", "[voronoi_cells]") {
  CHECK(measureCells(*Int32Grid::create(0)).grains.empty());
  const auto labels = labelGrid({{{1, 2, 3}, 1}});
  CHECK(cellsOf(measureCells(*labels)) == Cells{{1, {1.0, 0, true}}});
  setDomain(*labels, CoordBBox(Coord(0), Coord(50000, 9, 9)));
  CHECK_THROWS_WITH(measureCells(*labels), vdb_madf::test::Contains("the domain is too large"));
}
