// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Samples whose domain is a region.

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "support/oracle.h"
#include "support/random_case.h"
#include "support/runs.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/method/voxel_weights.h"
#include "vdb_madf/segmentation/segment.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Labels 1 to 5 of an object: the Voronoi cells of five of its voxels.
DenseVolume<int64_t> randomCells(const ObjectVolume& object, Rng& rng) {
  std::vector<Coord> voxels, seeds;
  for (int i = 0; i < object.size(); ++i)
    if (object[i]) voxels.push_back(object.coord(i));
  for (int i = 0; i < 5 && !voxels.empty(); ++i)
    seeds.push_back(voxels[size_t(rng.below(int(voxels.size())))]);
  DenseVolume<int64_t> labels(object.box());
  for (const Coord& p : voxels) {
    const auto apart = [&](size_t i) { return (p - seeds[i]).asVec3d().lengthSqr(); };
    size_t best = 0;
    for (size_t i = 1; i < seeds.size(); ++i)
      if (apart(i) < apart(best)) best = i;
    labels[p] = int64_t(best) + 1;
  }
  return labels;
}

/// A voxel face: its center doubled, and 2 * axis, + 1 if it points down.
struct Face {
  Coord center;
  int side;
};

/// Each face counts by the cosine between its axis and the mean of the normals of the faces within
/// 2.5 voxels, weighted by 2.5^2 - distance^2; those that point the opposite way are left out. In
/// units of 2^-20.
double naiveArea(const std::vector<Face>& faces) {
  int64_t area = 0;
  for (const Face& face : faces) {
    Vec3d normal(0);
    for (const Face& other : faces) {
      const double weight = 25 - (other.center - face.center).asVec3d().lengthSqr();
      if (weight > 0 && other.side != (face.side ^ 1))
        normal[other.side / 2] += other.side % 2 ? -weight : weight;
    }
    const double along = normal[face.side / 2] * (face.side % 2 ? -1 : 1);
    if (along > 0) area += int64_t((1 << 20) * (along / normal.length()) + 0.5);
  }
  return double(area) / (1 << 20);
}

struct NaiveGrain {
  int64_t cutFaces = 0;
  bool atWall = false;
  double freeArea = 0;
};

std::map<int32_t, NaiveGrain> naiveGrains(const DenseVolume<int64_t>& labels,
                                          const OracleDomain& domain, bool open) {
  std::map<int32_t, NaiveGrain> grains;
  std::map<int32_t, std::vector<Face>> faces;
  for (int i = 0; i < labels.size(); ++i) {
    if (!labels[i]) continue;
    const Coord p = labels.coord(i);
    NaiveGrain& grain = grains[int32_t(labels[i])];
    for (int side = 0; side < 6; ++side) {
      Coord step(0);
      step[side / 2] = side % 2 ? -1 : 1;
      const Coord q = p + step;
      const bool outside = !domain.isInside(q);
      grain.atWall = grain.atWall || outside;
      if (outside && open)
        ++grain.cutFaces;
      else if (!labels.get(q, 0))
        faces[int32_t(labels[i])].push_back({p + q, side});
    }
  }
  for (auto& [label, grain] : grains) grain.freeArea = naiveArea(faces[label]);
  return grains;
}

/// All that the tables hold, bit by bit.
std::string bits(const std::vector<MeasureColumn>& columns) {
  std::string all;
  for (const MeasureColumn& column : columns) {
    all += column.name;
    for (const double value : column.values) {
      char bytes[sizeof value];
      std::memcpy(bytes, &value, sizeof value);
      all.append(bytes, sizeof value);
    }
  }
  return all;
}

bool sameTables(const Measurements& a, const Measurements& b) {
  return bits(grainColumns(a.grains)) == bits(grainColumns(b.grains)) &&
         bits(bondColumns(a.bonds)) == bits(bondColumns(b.bonds));
}

Measurements measureIn(const Int32Grid& labels, const Domain& domain,
                       Boundary boundary = Boundary::open) {
  MeasureOptions options;
  options.domain = domain;
  options.boundary = boundary;
  return measure(labels, options);
}

/// The voxels of a box where inside(Vec3d).
template <typename Inside>
Domain regionIn(const CoordBBox& box, const Inside& inside) {
  MaskTree tree(false);
  for (auto p = box.begin(); p; ++p)
    if (inside((*p).asVec3d())) tree.setValueOn(*p);
  return Domain(tree);
}

/// A cylinder along z through the origin.
Domain roundCore(double radius, int halfLength) {
  const int side = int(std::ceil(radius));
  return regionIn({Coord(-side, -side, -halfLength), Coord(side, side, halfLength)},
                  [&](const Vec3d& p) { return p[0] * p[0] + p[1] * p[1] < radius * radius; });
}

/// The labels within a domain.
Int32Grid::Ptr cut(const Int32Grid& labels, const Domain& domain) {
  auto result = Int32Grid::create(0);
  for (auto p = labels.cbeginValueOn(); p; ++p)
    if (domain.isInside(p.getCoord())) result->tree().setValue(p.getCoord(), *p);
  return result;
}

}  // namespace

TEST_CASE("measure_region: by the definitions on random labels in random regions",
          "[measure_region]") {
  int regions = 0, cutGrains = 0, freeGrains = 0, innerGrains = 0, bonds = 0;
  for (uint64_t seed = 1; seed <= 240; ++seed) {
    Rng rng(seed);
    RandomCase c =
        randomCase(seed, Coord(rng.between(3, 13), rng.between(3, 13), rng.between(3, 13)));
    if (!c.domain) c.domain = c.object.box();
    drawRegion(c);
    if (!c.region || objectBox(c.object).empty()) continue;
    const bool open = seed % 3 != 0;
    INFO((open ? "open, " : "closed, ") << describe(c));
    const DenseVolume<int64_t> labels = randomCells(c.object, rng);
    const OracleDomain domain = *oracleDomainOf(c);
    const Int32Grid::Ptr grid = toGrid(c.object, labels);
    setDomain(*grid, *domainOf(c));
    setBoundary(*grid, open ? Boundary::open : Boundary::closed);
    MeasureOptions options;
    options.bondRadii = true;
    const Measurements m = withThreads(c.threads, [&] { return measure(*grid, options); });

    const std::map<int32_t, NaiveGrain> expected = naiveGrains(labels, domain, open);
    REQUIRE(m.grains.size() == expected.size());
    for (const GrainMeasures& grain : m.grains) {
      CAPTURE(grain.id);
      const NaiveGrain& naive = expected.at(grain.id);
      REQUIRE(grain.cutArea == double(naive.cutFaces));
      REQUIRE(grain.freeArea == naive.freeArea);
      REQUIRE(grain.atDomainFace == naive.atWall);
      cutGrains += grain.cutArea > 0;
      freeGrains += grain.freeArea > 0;
      innerGrains += !grain.atDomainFace;
    }
    if (countObject(c.object) < countObject(*c.region)) {
      const auto distance = oracleDistance(c.object, open, domain);
      for (const GrainMeasures& grain : m.grains) {
        int64_t deepest = 0;
        for (int i = 0; i < labels.size(); ++i)
          if (labels[i] == grain.id) deepest = std::max(deepest, distance[i]);
        REQUIRE(grain.inscribedRadius == std::sqrt(double(deepest)));
        REQUIRE(distance[*grain.representative] == deepest);
      }
      for (const BondMeasures& bond : m.bonds) {
        int64_t deepest = 0;
        for (auto p = labels.box().begin(); p; ++p)
          for (int axis = 0; axis < 3; ++axis) {
            Coord upper = *p;
            ++upper[axis];
            if (!labels.box().isInside(upper)) continue;
            const auto [low, high] = std::minmax({labels[*p], labels[upper]});
            if (low != bond.first || high != bond.second) continue;
            deepest = std::max(deepest, std::min(distance[*p], distance[upper]));
          }
        REQUIRE(bond.inscribedRadius.value() == std::sqrt(double(deepest)));
        ++bonds;
      }
    }
    REQUIRE(m.sample.regionVoxels.value_or(countObject(*c.region)) == countObject(*c.region));
    REQUIRE(m.sample.box == objectBox(*c.region));
    REQUIRE(m.sample.objectFraction ==
            double(countObject(c.object)) / double(countObject(*c.region)));
    ++regions;
  }
  CHECK(regions > 100);
  CHECK(cutGrains > 100);
  CHECK(bonds > 100);
  CHECK(freeGrains > 100);
  CHECK(innerGrains > 20);
}

TEST_CASE("measure_region: one that fills its box gives the numbers of the box",
          "[measure_region]") {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const CoordBBox box = boxAt({-9, 2, 30}, {22, 27, 25});
    const ObjectVolume object = randomVolume(VolumeKind::blurredNoise, box, rng);
    const Int32Grid::Ptr labels = toGrid(object, randomCells(object, rng));
    auto tree = std::make_shared<MaskTree>(false);
    tree->fill(box, true);
    if (seed % 2) tree->voxelizeActiveTiles();
    const Boundary boundary = seed < 3 ? Boundary::open : Boundary::closed;
    const Measurements whole = measureIn(*labels, box, boundary);
    REQUIRE(whole.bonds.size() > 2);
    CHECK_FALSE(whole.sample.regionVoxels.has_value());
    const Domain region(tree, box);
    REQUIRE_FALSE(region.isBox());
    const Measurements m = measureIn(*labels, region, boundary);
    CHECK(sameTables(m, whole));
    CHECK(m.sample.regionVoxels == int64_t(box.volume()));
    CHECK(m.sample.objectFraction == whole.sample.objectFraction);
    CHECK(m.sample.correlationLengths == whole.sample.correlationLengths);
    CHECK(m.sample.correlationLengths[0].has_value());
    CHECK(m.sample.eulerCharacteristic == whole.sample.eulerCharacteristic);
  }
}

TEST_CASE("measure_region: far from its wall nothing is other than in a box", "[measure_region]") {
  Rng rng(3);
  const ObjectVolume object =
      randomVolume(VolumeKind::blurredNoise, boxAt(Coord(-13), Coord(26)), rng);
  const Int32Grid::Ptr labels = toGrid(object, randomCells(object, rng));
  const Domain core = roundCore(24, 21);
  const Measurements whole = measureIn(*labels, core.box()), round = measureIn(*labels, core);
  REQUIRE(whole.bonds.size() > 2);
  CHECK(sameTables(round, whole));
  CHECK(round.sample.freeArea == whole.sample.freeArea);
  CHECK(round.sample.objectFraction ==
        Approx(whole.sample.objectFraction * double(core.box().volume()) /
               double(core.voxelCount())));
}

TEST_CASE("measure_region: what the wall does not touch stays as it was", "[measure_region]") {
  // Small balls on a lattice, each with a cap of its own.
  const CoordBBox block(Coord(-30, -30, -20), Coord(30, 30, 20));
  const auto lattice = drawLabels(block, [](const Vec3d& p) {
    Vec3d q;
    int label = 1;
    for (int i = 0; i < 3; ++i) {
      const int cell = int(std::floor((p[i] + 40) / 8.0));
      q[i] = p[i] + 40 - 8 * cell - 3.7;
      label = label * 16 + cell;
    }
    return q.lengthSqr() < 11 ? 2 * label + (q[0] > 1) : 0;
  });
  const Domain core = roundCore(29, 20);
  const Measurements before = measureIn(*lattice, block),
                     after = measureIn(*cut(*lattice, core), core);
  std::map<int32_t, const GrainMeasures*> whole;
  for (const GrainMeasures& grain : before.grains) whole[grain.id] = &grain;
  int inner = 0, cutOff = 0;
  for (const GrainMeasures& grain : after.grains) {
    const GrainMeasures& uncut = *whole.at(grain.id);
    cutOff += grain.voxels < uncut.voxels;
    if (grain.voxels < uncut.voxels) CHECK(grain.atDomainFace);
    if (grain.atDomainFace) continue;
    ++inner;
    CHECK(grain.cutArea == 0);
    CHECK(grain.voxels == uncut.voxels);
    CHECK(grain.freeArea == uncut.freeArea);
    CHECK(grain.coordination == uncut.coordination);
    CHECK(grain.ellipsoid.values == uncut.ellipsoid.values);
  }
  CHECK(inner > 200);
  CHECK(cutOff > 50);
}

TEST_CASE("measure_region: a segmentation measures as its labels do, with any threads",
          "[measure_region]") {
  Rng rng(5);
  const Domain core = roundCore(24, 24);
  const ObjectVolume block = randomVolume(VolumeKind::blurredNoise, core.box(), rng);
  const MaskGrid::Ptr object = toMask(block);
  object->tree().topologyIntersection(*core.region());
  SegmentOptions options;
  options.domain = core;
  options.fillHoles = options.tidy = 0;  // then the graph tells the representatives
  const Segmentation grains = segment(*object, options);
  const Measurements expected = withThreads(1, [&] { return measure(*grains.grain); });
  REQUIRE(expected.open);
  REQUIRE(expected.sample.regionVoxels == int64_t(core.voxelCount()));
  REQUIRE(expected.grains.size() > 20);
  CHECK(sameTables(measure(grains), expected));
  for (const int threads : {2, 4}) {
    const Measurements m = withThreads(threads, [&] { return measure(*grains.grain); });
    CHECK(sameTables(m, expected));
    CHECK(m.sample.correlationLengths == expected.sample.correlationLengths);
  }
}

TEST_CASE("measure_region: a plane across a round core is an ellipse", "[measure_region]") {
  const double radius = 24.3;
  const Domain core = roundCore(radius, 40);
  for (const Vec3d& slope :
       {Vec3d(0, 0, 1), Vec3d(0.2, 0.1, 1), Vec3d(1, 0, 1), Vec3d(-0.7, 0.9, 1)}) {
    Vec3d n = slope;
    n.normalize();
    CAPTURE(n);
    const auto labels =
        cut(*drawLabels(core.box(), [&](const Vec3d& p) { return n.dot(p) < 0.3 ? 1 : 0; }), core);
    const double truth = M_PI * radius * radius / n[2];
    const Measurements open = measureIn(*labels, core),
                       closed = measureIn(*labels, core, Boundary::closed);
    CHECK(open.grains.at(0).freeArea == Approx(truth).epsilon(0.05));
    CHECK(open.grains.at(0).cutArea > 2 * M_PI * radius * 40);  // faces in steps: 4 / pi of it
    CHECK(open.sample.objectFraction == Approx(0.5).epsilon(0.02));
    CHECK(open.sample.specificSurface == open.sample.freeArea / double(labels->activeVoxelCount()));
    CHECK(closed.grains.at(0).cutArea == 0);
    CHECK(closed.grains.at(0).freeArea ==
          Approx(truth + M_PI * radius * radius + 2 * M_PI * radius * 40.5).epsilon(0.05));
  }
}

TEST_CASE("measure_region: a bond that the wall cuts ends there", "[measure_region]") {
  const double radius = 20.4;
  const Domain core = roundCore(radius, 16);
  for (const double angle : {0.0, 0.4, M_PI / 4}) {
    CAPTURE(angle);
    const Vec3d n(std::cos(angle), std::sin(angle), 0);
    // Two grains that fill the core but for its ends.
    const auto labels = cut(*drawLabels(core.box(),
                                        [&](const Vec3d& p) {
                                          if (std::abs(p[2]) > 12) return 0;
                                          return n.dot(p) < 0.3 ? 1 : 2;
                                        }),
                            core);
    const Measurements m = measureIn(*labels, core);
    REQUIRE(m.bonds.size() == 1);
    CHECK(m.bonds[0].area == Approx(2 * radius * 25).epsilon(0.05));
  }
}

namespace {

/// Edges whose weights are small whole numbers.
struct UnequalVoxels {
  Vec3d edges;  ///< the shortest is 1
  VoxelWeights weights;
};
const std::vector<UnequalVoxels> kUnequal = {
    {{1, 1, 3}, {1, 1, 9}}, {{1.5, 1, 2}, {9, 4, 16}}, {{2, 5, 1}, {4, 25, 1}}};

Measurements measureVoxels(const Int32Grid& labels, const Vec3d& edges, const Domain& domain) {
  const auto grid = labels.deepCopy();
  setProportions(*grid, {edges[0], edges[1], edges[2]});
  return measureIn(*grid, domain);
}

}  // namespace

TEST_CASE("measure_region: of unequal voxels, by the definitions on random labels",
          "[measure_region]") {
  int cutGrains = 0, innerGrains = 0;
  for (uint64_t seed = 1; seed <= 150; ++seed) {
    Rng rng(seed);
    RandomCase c =
        randomCase(seed, Coord(rng.between(3, 12), rng.between(3, 12), rng.between(3, 12)));
    if (!c.domain) c.domain = c.object.box();
    drawRegion(c);
    if (!c.region || objectBox(c.object).empty()) continue;
    const UnequalVoxels& unequal = kUnequal[seed % kUnequal.size()];
    const auto& edges = unequal.edges;
    INFO("edges " << edges << ", " << describe(c));
    const DenseVolume<int64_t> labels = randomCells(c.object, rng);
    const OracleDomain domain = *oracleDomainOf(c);
    const Int32Grid::Ptr grid = toGrid(c.object, labels);
    const Measurements m =
        withThreads(c.threads, [&] { return measureVoxels(*grid, edges, *domainOf(c)); });
    std::map<int32_t, double> cutAreas;
    for (int i = 0; i < labels.size(); ++i)
      for (int side = 0; labels[i] && side < 6; ++side)
        if (!domain.isInside(labels.coord(i) + kSixNeighbors[size_t(side)]))
          cutAreas[int32_t(labels[i])] += edges[0] * edges[1] * edges[2] / edges[side / 2];
    for (const GrainMeasures& grain : m.grains) {
      CAPTURE(grain.id);
      const double cutArea = cutAreas.count(grain.id) ? cutAreas.at(grain.id) : 0;
      REQUIRE(grain.cutArea == Approx(cutArea));
      REQUIRE(grain.atDomainFace == (cutArea > 0));
      REQUIRE(grain.volume == Approx(double(grain.voxels) * edges[0] * edges[1] * edges[2]));
      cutGrains += cutArea > 0;
      innerGrains += cutArea == 0;
    }
    REQUIRE(m.sample.objectFraction ==
            double(countObject(c.object)) / double(countObject(*c.region)));
    if (countObject(c.object) == countObject(*c.region)) continue;
    const auto distance = oracleDistance(c.object, true, domain, unequal.weights);
    for (const GrainMeasures& grain : m.grains) {
      int64_t deepest = 0;
      for (int i = 0; i < labels.size(); ++i)
        if (labels[i] == grain.id) deepest = std::max(deepest, distance[i]);
      REQUIRE(grain.inscribedRadius ==
              Approx(std::sqrt(double(deepest) / double(unequal.weights.least()))));
    }
  }
  CHECK(cutGrains > 100);
  CHECK(innerGrains > 10);
}

TEST_CASE("measure_region: of unequal voxels, a plane across a round core is an ellipse",
          "[measure_region]") {
  const double radius = 24.3, halfLength = 36;
  for (const Vec3d& edges : {Vec3d(1, 1, 3), Vec3d(3, 1, 1), Vec3d(1.5, 1, 2)}) {
    Coord corner;
    for (int axis = 0; axis < 3; ++axis)
      corner[axis] = int((axis == 2 ? halfLength : radius + 1) / edges[axis]);
    const Domain core = regionIn({Coord(0) - corner, corner}, [&](const Vec3d& voxel) {
      const Vec3d p = voxel * edges;
      return p[0] * p[0] + p[1] * p[1] < radius * radius;
    });
    const double length = (2 * corner.z() + 1) * edges[2];
    for (const Vec3d& slope : {Vec3d(0, 0, 1), Vec3d(0.2, 0.1, 1), Vec3d(-0.5, 0.6, 1)}) {
      Vec3d n = slope;
      n.normalize();
      CAPTURE(edges, n);
      const auto labels = cut(*drawLabels(core.box(),
                                          [&](const Vec3d& voxel) {
                                            return n.dot(Vec3d(voxel * edges)) < 0.3 ? 1 : 0;
                                          }),
                              core);
      const Measurements m = measureVoxels(*labels, edges, core);
      const GrainMeasures& grain = m.grains.at(0);
      CHECK(grain.freeArea == Approx(M_PI * radius * radius / n[2]).epsilon(0.07));
      CHECK(grain.volume == Approx(M_PI * radius * radius * length / 2).epsilon(0.05));
      CHECK(m.sample.objectFraction == Approx(0.5).epsilon(0.05));
      CHECK(m.sample.specificSurface == Approx(grain.freeArea / grain.volume));
      // The wall in steps, 4 / pi of it, and the lower end.
      CHECK(grain.cutArea == Approx(4 * radius * length + M_PI * radius * radius).epsilon(0.06));
    }
  }
}
