// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The table of grains: bodies whose measures are known.

#include <map>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// A rotation: the columns are the new axes.
struct Frame {
  Vec3d u, v, w;
  explicit Frame(Rng& rng) : u(randomDirection(rng)) {
    v = u.cross(randomDirection(rng));
    v.normalize();
    w = u.cross(v);
  }
};

Int32Grid::Ptr ellipsoid(const Vec3d& center, const Frame& frame, const Vec3d& semiAxes) {
  return drawLabels(cubeAround(semiAxes[0] + 3), [&](const Vec3d& p) {
    const Vec3d q = p - center;
    const double a = q.dot(frame.u) / semiAxes[0], b = q.dot(frame.v) / semiAxes[1],
                 c = q.dot(frame.w) / semiAxes[2];
    return a * a + b * b + c * c < 1 ? 7 : 0;
  });
}

/// Random labels in blobs: the Voronoi cells of a few points, cut by a random object.
Int32Grid::Ptr blobs(Rng& rng, const CoordBBox& box) {
  const ObjectVolume object = randomVolume(VolumeKind::blurredNoise, box, rng);
  std::vector<Vec3d> seeds;
  for (int i = 0; i < 9; ++i) {
    Vec3d seed = randomPoint(rng);
    for (int k = 0; k < 3; ++k) seed[k] = box.min()[k] + seed[k] * box.dim()[k];
    seeds.push_back(seed);
  }
  return drawLabels(box, [&](const Vec3d& p) {
    if (!object[Coord::round(p)]) return 0;
    size_t best = 0;
    for (size_t i = 1; i < seeds.size(); ++i)
      if ((p - seeds[i]).lengthSqr() < (p - seeds[best]).lengthSqr()) best = i;
    return int(3 * best + 2);
  });
}

void requireSameGrain(const GrainMeasures& a, const GrainMeasures& b, const Coord& shift) {
  CHECK(a.voxels == b.voxels);
  CHECK((a.centroid + shift.asVec3d() - b.centroid).length() < 1e-9);
  CHECK(a.box.min() + shift == b.box.min());
  CHECK(a.freeArea == b.freeArea);
  CHECK(a.sharedArea == b.sharedArea);
  CHECK(a.ellipsoid.values[0] == Approx(b.ellipsoid.values[0]));
  CHECK(a.ellipsoid.values[2] == Approx(b.ellipsoid.values[2]));
  CHECK(a.representative.value() + shift == b.representative.value());
  CHECK(a.inscribedRadius == b.inscribedRadius);
  CHECK(a.coordination == b.coordination);
}

}  // namespace

TEST_CASE("measure_grains: a box", "[measure_grains]") {
  const CoordBBox box(Coord(-3, 5, 100), Coord(16, 16, 107));  // 20 x 12 x 8
  const auto labels = drawLabels(box, [](const Vec3d&) { return 4; });
  const GrainMeasures grain = measure(*labels).grains.at(0);
  CHECK(grain.id == 4);
  CHECK(grain.voxels == 20 * 12 * 8);
  CHECK(grain.centroid == Vec3d(6.5, 10.5, 103.5));
  CHECK(grain.box == box);
  CHECK(grain.equivalentDiameter == Approx(std::cbrt(6 * 1920 / M_PI)));
  // Side a has the moment a^2 / 12, half axis h the moment h^2 / 5.
  CHECK(grain.ellipsoid.values[0] == Approx(20 * std::sqrt(5.0 / 3)));
  CHECK(grain.ellipsoid.values[1] == Approx(12 * std::sqrt(5.0 / 3)));
  CHECK(grain.ellipsoid.values[2] == Approx(8 * std::sqrt(5.0 / 3)));
  CHECK((grain.ellipsoid.axes[0] - Vec3d(1, 0, 0)).length() < 1e-9);
  CHECK((grain.ellipsoid.axes[1] - Vec3d(0, 1, 0)).length() < 1e-9);
  CHECK((grain.ellipsoid.axes[2] - Vec3d(0, 0, 1)).length() < 1e-9);
  // Edges are rounded off a little.
  const double faces = 2 * (20 * 12 + 12 * 8 + 8 * 20);
  CHECK(grain.freeArea == Approx(faces).epsilon(0.1));
  CHECK(grain.freeArea < faces);
  CHECK(grain.sharedArea == 0);
  CHECK(grain.coordination == 0);
  // Four voxels from the nearest background; of all those the first.
  CHECK(grain.inscribedRadius == 4);
  CHECK(grain.representative.value() == Coord(0, 8, 103));
}

TEST_CASE("measure_grains: ellipsoids in any position", "[measure_grains]") {
  Rng rng(11);
  for (int i = 0; i < 6; ++i) {
    const Frame frame(rng);
    const Vec3d semiAxes{20 + 4 * rng.unit(), 13 + 2 * rng.unit(), 8 + 2 * rng.unit()};
    const Vec3d center = randomPoint(rng);
    const GrainMeasures grain = measure(*ellipsoid(center, frame, semiAxes)).grains.at(0);
    CHECK(double(grain.voxels) ==
          Approx(4 * M_PI / 3 * semiAxes[0] * semiAxes[1] * semiAxes[2]).epsilon(0.01));
    CHECK((grain.centroid - center).length() < 0.1);
    for (int k = 0; k < 3; ++k)
      CHECK(grain.ellipsoid.values[size_t(k)] == Approx(2 * semiAxes[k]).epsilon(0.01));
    CHECK(std::abs(grain.ellipsoid.axes[0].dot(frame.u)) > 0.999);
    CHECK(std::abs(grain.ellipsoid.axes[2].dot(frame.w)) > 0.999);
    for (const Vec3d& axis : grain.ellipsoid.axes) {
      CHECK(axis.length() == Approx(1));
      CHECK(std::max({axis[0], axis[1], axis[2]}) >= -std::min({axis[0], axis[1], axis[2]}) - 1e-6);
    }
    CHECK(grain.inscribedRadius == Approx(semiAxes[2]).margin(1));
    CHECK((grain.representative->asVec3d() - center).length() < 3);
    CHECK(grain.sphericity.value() < 0.95);
  }
}

TEST_CASE("measure_grains: the sphericity of a few voxels is not known", "[measure_grains]") {
  for (const int edge : {1, 2, 3, 4}) {
    LabelMap voxels;  // one grain in the other
    for (const Coord& p : cube(edge + 8, Coord(-4))) voxels[p] = 1;
    for (const Coord& p : cube(edge)) voxels[p] = 2;
    const GrainMeasures grain = measure(*labelGrid(voxels)).grains.at(1);
    CHECK(grain.sphericity.has_value() == (edge >= 3));
    CHECK(grain.sphericity.value_or(0) <= 1);
  }
}

TEST_CASE("measure_grains: a ball is round", "[measure_grains]") {
  const auto labels =
      drawLabels(cubeAround(17), [](const Vec3d& p) { return p.lengthSqr() < 15.2 * 15.2; });
  const GrainMeasures grain = measure(*labels).grains.at(0);
  CHECK(grain.equivalentDiameter == Approx(2 * 15.2).epsilon(0.005));
  CHECK(grain.sphericity.value() == Approx(1).epsilon(0.01));
  CHECK(grain.ellipsoid.values[2] / grain.ellipsoid.values[0] == Approx(1).epsilon(0.005));
  CHECK(grain.representative.value() == Coord(0));
  CHECK(grain.inscribedRadius == Approx(15.2).margin(0.8));
}

TEST_CASE("measure_grains: by the definitions on random labels", "[measure_grains]") {
  for (int seed = 1; seed <= 6; ++seed) {
    Rng rng{uint64_t(seed)};
    const CoordBBox box = boxAt(Coord(-13 * seed, 5, -3), Coord(26, 19, 30));
    const auto labels = blobs(rng, box);
    const Measurements m = measure(*labels);
    CAPTURE(seed);

    struct Naive {
      int64_t voxels = 0;
      Vec3d sum{0}, squares{0};
      double xy = 0;
      CoordBBox box;
    };
    std::map<int32_t, Naive> naive;
    std::map<std::pair<int32_t, int32_t>, int64_t> faces;
    for (auto p = labels->cbeginValueOn(); p; ++p) {
      const Coord at = p.getCoord();
      Naive& grain = naive[*p];
      ++grain.voxels;
      const Vec3d q = at.asVec3d();
      grain.sum += q;
      grain.squares += q * q;
      grain.xy += q[0] * q[1];
      grain.box.expand(at);
      for (const Coord& step : kSixNeighbors) {
        const int32_t other = labels->tree().getValue(at + step);
        if (other > *p) ++faces[{*p, other}];
      }
    }
    REQUIRE(m.grains.size() == naive.size());
    std::map<int32_t, int> coordination;
    std::map<int32_t, double> shared;
    REQUIRE(m.bonds.size() == faces.size());
    for (const BondMeasures& bond : m.bonds) {
      CHECK(bond.faces == faces.at({bond.first, bond.second}));
      CHECK(bond.area > 0);
      CHECK(bond.area <= 1.1 * double(bond.faces));
      for (const int32_t id : {bond.first, bond.second}) {
        ++coordination[id];
        shared[id] += bond.area;
      }
    }
    int64_t voxels = 0;
    for (const GrainMeasures& grain : m.grains) {
      const Naive& other = naive.at(grain.id);
      const double n = double(other.voxels);
      CHECK(grain.voxels == other.voxels);
      CHECK((grain.centroid - other.sum / n).length() < 1e-9);
      CHECK(grain.box == other.box);
      CHECK(grain.coordination == coordination[grain.id]);
      CHECK(grain.sharedArea == Approx(shared[grain.id]));
      // The trace and the xy element of the inertia, put together again from the axes.
      double trace = 0, xy = 0;
      for (size_t k = 0; k < 3; ++k) {
        const double moment = grain.ellipsoid.values[k] * grain.ellipsoid.values[k] / 20;
        trace += moment;
        xy += moment * grain.ellipsoid.axes[k][0] * grain.ellipsoid.axes[k][1];
      }
      const Vec3d mean = other.sum / n, spread = other.squares / n - mean * mean;
      CHECK(trace == Approx(spread[0] + spread[1] + spread[2] + 0.25));
      CHECK(xy == Approx(other.xy / n - mean[0] * mean[1]).margin(1e-6));
      voxels += grain.voxels;
    }
    CHECK(voxels == int64_t(labels->activeVoxelCount()));
    CHECK(m.sample.objectVoxels == voxels);
  }
}

TEST_CASE("measure_grains: moves with the labels", "[measure_grains]") {
  Rng rng(21);
  const CoordBBox box = boxAt(Coord(2, -3, 4), Coord(24, 24, 24));
  const auto labels = blobs(rng, box);
  const Measurements m = measure(*labels);
  REQUIRE(m.grains.size() > 3);
  for (const Coord& shift : {Coord(1, 2, 3), Coord(-8, 5, 7), Coord(-1000, 4096, -77)}) {
    auto moved = Int32Grid::create(0);
    for (auto p = labels->cbeginValueOn(); p; ++p) moved->tree().setValue(p.getCoord() + shift, *p);
    const Measurements other = measure(*moved);
    REQUIRE(other.grains.size() == m.grains.size());
    for (size_t i = 0; i < m.grains.size(); ++i)
      requireSameGrain(m.grains[i], other.grains[i], shift);
    REQUIRE(other.bonds.size() == m.bonds.size());
    for (size_t i = 0; i < m.bonds.size(); ++i) {
      CHECK(other.bonds[i].area == m.bonds[i].area);
      CHECK((other.bonds[i].normal - m.bonds[i].normal).length() < 1e-12);
      CHECK(other.bonds[i].flatness == Approx(m.bonds[i].flatness).margin(1e-9));
      CHECK(other.bonds[i].patches == m.bonds[i].patches);
    }
  }
}

TEST_CASE("measure_grains: turns with the labels", "[measure_grains]") {
  Rng rng(22);
  const auto labels = blobs(rng, boxAt(Coord(2, -3, 4), Coord(24, 24, 24)));
  auto turned = Int32Grid::create(0);  // x, y, z become y, z, -x
  const auto turn = [](const Vec3d& p) { return Vec3d(p[1], p[2], -p[0]); };
  for (auto p = labels->cbeginValueOn(); p; ++p)
    turned->tree().setValue(Coord::round(turn(p.getCoord().asVec3d())), *p);
  const Measurements a = measure(*labels), b = measure(*turned);
  REQUIRE(a.grains.size() == b.grains.size());
  for (size_t i = 0; i < a.grains.size(); ++i) {
    CHECK(a.grains[i].freeArea == Approx(b.grains[i].freeArea));
    CHECK((turn(a.grains[i].centroid) - b.grains[i].centroid).length() < 1e-9);
    const Vec3d low = turn(a.grains[i].box.min().asVec3d()),
                high = turn(a.grains[i].box.max().asVec3d());
    CHECK(b.grains[i].box == CoordBBox(Coord::round(openvdb::math::minComponent(low, high)),
                                       Coord::round(openvdb::math::maxComponent(low, high))));
    for (size_t k = 0; k < 3; ++k) {
      CHECK(a.grains[i].ellipsoid.values[k] == Approx(b.grains[i].ellipsoid.values[k]));
      CHECK(std::abs(turn(a.grains[i].ellipsoid.axes[k]).dot(b.grains[i].ellipsoid.axes[k])) ==
            Approx(1));
    }
    CHECK(a.grains[i].inscribedRadius == b.grains[i].inscribedRadius);
  }
  REQUIRE(a.bonds.size() == b.bonds.size());
  for (size_t i = 0; i < a.bonds.size(); ++i) {
    CHECK(a.bonds[i].area == Approx(b.bonds[i].area));
    CHECK((turn(a.bonds[i].normal) - b.bonds[i].normal).length() < 1e-9);
    CHECK((turn(a.bonds[i].centroid) - b.bonds[i].centroid).length() < 1e-9);
  }
}

TEST_CASE("measure_grains: the faces of an open domain are no surface", "[measure_grains]") {
  // A ball cut in half by the domain.
  const CoordBBox domain(Coord(0, -20, -20), Coord(20));
  const auto labels =
      drawLabels(domain, [](const Vec3d& p) { return p.lengthSqr() < 14.5 * 14.5 ? 1 : 0; });
  MeasureOptions options;
  options.domain = domain;
  const GrainMeasures open = measure(*labels, options).grains.at(0);
  int disc = 0;
  for (auto p = domain.begin(); p; ++p)
    disc += (*p).x() == 0 && (*p).asVec3d().lengthSqr() < 14.5 * 14.5;
  CHECK(open.cutArea == disc);
  REQUIRE(open.cuts.size() == 1);
  CHECK(open.cuts[0].axis == 0);
  CHECK_FALSE(open.cuts[0].isUpper);
  CHECK(open.cuts[0].area == disc);
  CHECK(open.cuts[0].centroid == Vec3d(-0.5, 0, 0));
  CHECK(open.freeArea == Approx(2 * M_PI * 14.5 * (14.5 + 0.5)).epsilon(0.01));
  CHECK(open.atDomainFace);
  CHECK(open.inscribedRadius == Approx(14.5).margin(0.8));  // the ball goes on beyond
  options.boundary = Boundary::closed;
  const GrainMeasures closed = measure(*labels, options).grains.at(0);
  CHECK(closed.cutArea == 0);
  CHECK(closed.freeArea == Approx(open.freeArea + disc).epsilon(0.03));
  CHECK(closed.inscribedRadius < 9);
  options.domain = CoordBBox(Coord(-20), Coord(20));
  CHECK_FALSE(measure(*labels, options).grains.at(0).atDomainFace);
}

TEST_CASE("measure_grains: which grains touch a face of the domain", "[measure_grains]") {
  MeasureOptions options;
  options.domain = CoordBBox(Coord(-5), Coord(5));
  for (int axis = 0; axis < 3; ++axis)
    for (const int at : {-5, -4, 4, 5}) {
      Coord voxel(0);
      voxel[axis] = at;
      auto labels = Int32Grid::create(0);
      labels->tree().setValue(voxel, 1);
      const GrainMeasures grain = measure(*labels, options).grains.at(0);
      CAPTURE(axis, at);
      CHECK(grain.atDomainFace == (std::abs(at) == 5));
      CHECK(grain.cutArea == (std::abs(at) == 5 ? 1 : 0));
    }
}

TEST_CASE("measure_grains: tiles, values without meaning, and nothing at all", "[measure_grains]") {
  auto tiled = Int32Grid::create(0);
  tiled->fill(CoordBBox(Coord(0), Coord(15)), 3, true);
  tiled->tree().prune();
  REQUIRE(tiled->tree().activeTileCount() > 0);
  const GrainMeasures block = measure(*tiled).grains.at(0);
  CHECK(block.voxels == 4096);
  auto plain = Int32Grid::create(0);
  plain->fill(CoordBBox(Coord(0), Coord(15)), 3, true);
  plain->tree().voxelizeActiveTiles();
  plain->tree().setValue(Coord(40), -2);
  plain->tree().setValueOff(Coord(0, 0, 16), 9);
  const Measurements m = measure(*plain);
  REQUIRE(m.grains.size() == 1);
  CHECK(m.grains[0].freeArea == block.freeArea);

  const Measurements nothing = measure(*Int32Grid::create(0));
  CHECK(nothing.grains.empty());
  CHECK(nothing.bonds.empty());
  CHECK(nothing.sample.objectVoxels == 0);

  // The whole of an open domain: no background to be inscribed in.
  MeasureOptions options;
  options.domain = CoordBBox(Coord(0), Coord(15));
  const GrainMeasures whole = measure(*tiled, options).grains.at(0);
  CHECK_FALSE(whole.representative.has_value());
  CHECK(whole.freeArea == 0);
  CHECK(whole.cutArea == 6 * 256);
  options.domain = CoordBBox(Coord(0), Coord(14));
  CHECK_THROWS_AS(measure(*tiled, options), InvalidInput);
}
