// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Bodies of known size, drawn in space and sampled by voxels that are no cubes.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "support/runs.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/measure/grain_network.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/segmentation/segment.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

const std::vector<Vec3d> kShapes = {{1, 1, 3}, {3, 1, 1}, {1, 3, 1}, {1, 1.5, 2}, {3, 3, 1}};

/// How right areas have to be: means and worst of errors.
struct Shape {
  Vec3d edges;
  double mean, worst;
};
const std::vector<Shape> kAreas = {{{1, 1, 3}, 0.03, 0.06}, {{3, 1, 1}, 0.03, 0.06},
                                   {{1, 3, 1}, 0.03, 0.06}, {{1, 1.5, 2}, 0.03, 0.06},
                                   {{3, 3, 1}, 0.04, 0.08}, {{1, 1, 5}, 0.06, 0.12},
                                   {{1, 1, 10}, 0.15, 0.3}};

std::string nameOf(const char* what, const Vec3d& edges) {
  char text[80];
  std::snprintf(text, sizeof text, "%s, voxels of %g : %g : %g", what, edges[0], edges[1],
                edges[2]);
  return text;
}

/// Labels by a function of places in space, in shortest edges, around the origin.
template <typename LabelOf>
Int32Grid::Ptr draw(const Vec3d& edges, double halfEdge, const LabelOf& labelOf) {
  Coord corner;
  for (int i = 0; i < 3; ++i) corner[i] = int(std::ceil(halfEdge / edges[i])) + 1;
  const auto grid = drawLabels({Coord(0) - corner, corner},
                               [&](const Vec3d& p) { return labelOf(Vec3d(p * edges)); });
  setProportions(*grid, {edges[0], edges[1], edges[2]});
  return grid;
}

/// Six balls around the origin that overlap, cut at the planes between them.
struct OverlappingBalls {
  std::array<Vec3d, 6> centers{Vec3d{-9.1, -0.3, 0.7}, {8.3, 1.2, -2.4},  {0.4, 9.7, 3.1},
                               {-1.3, -8.8, 4.2},      {2.2, 0.9, -11.3}, {0.8, 1.1, 9.4}};
  double radius = 8.3;

  int32_t operator()(const Vec3d& p) const {
    int32_t nearest = 0;
    for (size_t i = 1; i < centers.size(); ++i)
      if ((p - centers[i]).lengthSqr() < (p - centers[size_t(nearest)]).lengthSqr())
        nearest = int32_t(i);
    return (p - centers[size_t(nearest)]).lengthSqr() < radius * radius ? nearest + 1 : 0;
  }
};

Int32Grid::Ptr drawOverlappingBalls(const Vec3d& edges) {
  return draw(edges, 24, OverlappingBalls());
}

/// The same labels, of voxels that are cubes.
Int32Grid::Ptr asCubes(const Int32Grid& labels) {
  const auto cubes = labels.deepCopy();
  cubes->setTransform(openvdb::math::Transform::createLinearTransform());
  return cubes;
}

double distance(const Coord& a, const Coord& b, const Vec3d& edges) {
  return ((a - b).asVec3d() * edges).length();
}

}  // namespace

TEST_CASE("unequal_voxels: balls have the size that they have in space", "[unequal_voxels]") {
  Rng rng(5);
  for (const Vec3d& edges : kShapes) {
    for (int i = 0; i < 3; ++i) {
      const double radius = 14 + 6 * rng.unit();
      const Vec3d center = randomPoint(rng) * edges;
      const auto grain = measure(*draw(edges, radius + 4, [&](const Vec3d& p) {
                           return (p - center).lengthSqr() < radius * radius;
                         })).grains.at(0);
      CAPTURE(edges, radius);
      CHECK(grain.volume == Approx(4. / 3 * M_PI * radius * radius * radius).epsilon(0.01));
      CHECK(grain.equivalentDiameter == Approx(2 * radius).epsilon(0.01));
      CHECK(grain.freeArea == Approx(4 * M_PI * radius * radius).epsilon(0.02));
      CHECK(grain.sphericity.value() == Approx(1).epsilon(0.02));
      CHECK((grain.centroid * edges - center).length() < 0.1);
      for (const double length : grain.ellipsoid.values)
        CHECK(length == Approx(2 * radius).epsilon(0.02));
      // A voxel whose center is off by half an edge, and whose neighbors count by their centers.
      CHECK(std::abs(grain.inscribedRadius - radius) < 2);
      CHECK(grain.cutArea == 0);
    }
  }
}

TEST_CASE("unequal_voxels: ellipsoids have the size that they have in space", "[unequal_voxels]") {
  Rng rng(6);
  for (const Vec3d& edges : kShapes) {
    for (int i = 0; i < 3; ++i) {
      // Turned about a random axis: two half axes are equal.
      const double along = 30, across = 15;
      const Vec3d axis = randomDirection(rng), center = randomPoint(rng) * edges;
      const auto grain = measure(*draw(edges, along + 4, [&](const Vec3d& p) {
                           const double a = (p - center).dot(axis);
                           const double r2 = (p - center).lengthSqr() - a * a;
                           return a * a / (along * along) + r2 / (across * across) < 1;
                         })).grains.at(0);
      const double e = std::sqrt(1 - across * across / (along * along));
      const double area = 2 * M_PI * across * across * (1 + along / (across * e) * std::asin(e));
      CAPTURE(edges, axis);
      CHECK(grain.volume == Approx(4. / 3 * M_PI * along * across * across).epsilon(0.01));
      CHECK(grain.freeArea == Approx(area).epsilon(0.02));
      CHECK(grain.ellipsoid.values[0] == Approx(2 * along).epsilon(0.01));
      CHECK(grain.ellipsoid.values[1] == Approx(2 * across).epsilon(0.02));
      CHECK(grain.ellipsoid.values[2] == Approx(2 * across).epsilon(0.02));
      CHECK(std::abs(grain.ellipsoid.axes[0].dot(axis)) > 0.999);
    }
  }
}

TEST_CASE("unequal_voxels: interfaces have their area, direction and curvature",
          "[unequal_voxels][long]") {
  Rng rng(7);
  for (const auto& [edges, mean, worst] : kAreas) {
    const double longest = std::max({edges[0], edges[1], edges[2]});
    Errors areas, free, curvatures;
    for (int i = 0; i < 8; ++i) {
      const double radius = 16 + 6 * rng.unit();
      const Vec3d center = randomPoint(rng) * edges, normal = randomDirection(rng);
      const auto inBall = [&](const Vec3d& p) {
        return (p - center).lengthSqr() < radius * radius;
      };
      const Measurements halves = measure(*draw(edges, radius + 4, [&](const Vec3d& p) {
        return inBall(p) ? (normal.dot(p - center) < 0 ? 1 : 2) : 0;
      }));
      const BondMeasures bond = halves.bonds.at(0);
      const double disc = M_PI * radius * radius;
      areas.add(bond.area, disc);
      for (const GrainMeasures& part : halves.grains) free.add(part.freeArea, 2 * disc);
      CHECK(bond.normal.dot(normal) > 1 - 2e-4 * longest * longest);
      CHECK((bond.centroid * edges - center).length() < 0.4 * longest);
      CHECK(bond.flatness < longest * longest / 6);
      CHECK(bond.equivalentRadius == Approx(std::sqrt(bond.area / M_PI)));
      CHECK(std::abs(bond.curvature.value().mean) < 0.02);
      // A ball within another grain.
      const BondMeasures around = measure(*draw(edges, radius + 9, [&](const Vec3d& p) {
                                    return inBall(p) ? 1 : 2;
                                  })).bonds.at(0);
      curvatures.add(around.curvature.value().mean, 1 / radius);
    }
    CAPTURE(edges);
    report(nameOf("discs in balls", edges), areas);
    report(nameOf("halves of balls", edges), free);
    report(nameOf("curvatures of balls", edges), curvatures);
    CHECK(areas.mean() < mean);
    CHECK(areas.worst() < worst);
    CHECK(free.mean() < mean);
    CHECK(free.worst() < worst);
    CHECK(curvatures.mean() < 2 * mean);
    CHECK(curvatures.worst() < 2 * worst);
  }
}

TEST_CASE("unequal_voxels: free planes have their area", "[unequal_voxels][long]") {
  Rng rng(8);
  for (const auto& [unequal, mean, worst] : kAreas) {
    const auto& edges = unequal;  // for a lambda
    Errors errors;
    for (int i = 0; i < 24; ++i) {
      // Through four walls of a tall box.
      const int along = i % 3, a = (along + 1) % 3, b = (along + 2) % 3;
      const double angle = 2 * M_PI * rng.unit(), slope = i / 24.0, offset = 3 * rng.unit();
      Coord corner;
      for (int axis = 0; axis < 3; ++axis)
        corner[axis] = int((axis == along ? 40 : 24) / edges[axis]);
      const CoordBBox box(Coord(0) - corner, corner);
      const auto labels = drawLabels(box, [&](const Vec3d& voxel) {
        const Vec3d p = voxel * edges;
        return p[along] < offset + slope * (std::cos(angle) * p[a] + std::sin(angle) * p[b]);
      });
      setProportions(*labels, {edges[0], edges[1], edges[2]});
      MeasureOptions options;
      options.domain = box;
      const double section = box.dim()[a] * edges[a] * box.dim()[b] * edges[b];
      errors.add(measure(*labels, options).grains.at(0).freeArea,
                 section * std::sqrt(1 + slope * slope));
    }
    CAPTURE(edges);
    report(nameOf("free planes", edges), errors);
    CHECK(errors.mean() < mean);
    CHECK(errors.worst() < worst);
  }
}

TEST_CASE("unequal_voxels: permuted axes permute what is measured", "[unequal_voxels]") {
  const Vec3d edges(1, 1.4, 2.7);
  const auto labels = drawOverlappingBalls(edges);
  const Measurements m = measure(*labels);
  REQUIRE(m.bonds.size() > 8);
  const std::vector<std::array<int, 3>> orders = {{1, 2, 0}, {2, 0, 1}, {1, 0, 2}};
  for (const auto& order : orders) {
    const auto permuted = [&](const auto& from) {
      auto to = from;
      for (int i = 0; i < 3; ++i) to[i] = from[order[size_t(i)]];
      return to;
    };
    const auto turned = Int32Grid::create(0);
    auto accessor = turned->getAccessor();
    for (auto value = labels->cbeginValueOn(); value; ++value)
      accessor.setValue(permuted(value.getCoord()), *value);
    const Vec3d turnedEdges = permuted(edges);
    setProportions(*turned, {turnedEdges[0], turnedEdges[1], turnedEdges[2]});
    const Measurements other = measure(*turned);
    REQUIRE(other.grains.size() == m.grains.size());
    REQUIRE(other.bonds.size() == m.bonds.size());
    for (size_t i = 0; i < m.grains.size(); ++i) {
      const GrainMeasures &a = m.grains[i], &b = other.grains[i];
      CHECK(b.volume == Approx(a.volume));
      CHECK(b.freeArea == Approx(a.freeArea).epsilon(1e-6));
      CHECK(b.sharedArea == Approx(a.sharedArea).epsilon(1e-6));
      CHECK(b.inscribedRadius == Approx(a.inscribedRadius));
      CHECK((b.centroid - permuted(a.centroid)).length() < 1e-9);
      for (size_t k = 0; k < 3; ++k) {
        CHECK(b.ellipsoid.values[k] == Approx(a.ellipsoid.values[k]));
        CHECK(std::abs(b.ellipsoid.axes[k].dot(permuted(a.ellipsoid.axes[k]))) == Approx(1));
      }
    }
    for (size_t i = 0; i < m.bonds.size(); ++i) {
      const BondMeasures &a = m.bonds[i], &b = other.bonds[i];
      CHECK(b.area == Approx(a.area).epsilon(1e-6));
      CHECK(b.faceArea == Approx(a.faceArea));
      CHECK(b.flatness == Approx(a.flatness));
      CHECK((b.normal - permuted(a.normal)).length() < 1e-9);
    }
    for (size_t k = 0; k < 3; ++k)
      CHECK(other.sample.correlationLengths[k].value() ==
            Approx(m.sample.correlationLengths[size_t(order[k])].value()));
  }
}

TEST_CASE("unequal_voxels: the shape of voxels changes no count", "[unequal_voxels]") {
  const auto labels = drawOverlappingBalls({1, 1, 3});
  const Measurements m = measure(*labels), cubes = measure(*asCubes(*labels));
  CHECK(m.edges == Vec3d(1, 1, 3));
  CHECK(cubes.edges == Vec3d(1));
  for (size_t i = 0; i < m.grains.size(); ++i) {
    const GrainMeasures &a = m.grains[i], &b = cubes.grains[i];
    CHECK(a.voxels == b.voxels);
    CHECK(a.volume == 3 * b.volume);
    CHECK(a.box == b.box);
    CHECK(a.centroid == b.centroid);
    CHECK(a.coordination == b.coordination);
    CHECK(a.atDomainFace == b.atDomainFace);
  }
  for (size_t i = 0; i < m.bonds.size(); ++i) {
    CHECK(m.bonds[i].faces == cubes.bonds[i].faces);
    CHECK(m.bonds[i].patches == cubes.bonds[i].patches);
    CHECK(m.bonds[i].centroid == cubes.bonds[i].centroid);
  }
  const SampleMeasures &a = m.sample, &b = cubes.sample;
  CHECK(a.objectFraction == b.objectFraction);
  CHECK(a.objectVolume == 3 * b.objectVolume);
  CHECK(a.specificSurface == Approx(a.freeArea / a.objectVolume));
  CHECK(a.eulerCharacteristic == b.eulerCharacteristic);
  CHECK(a.components == b.components);
  for (size_t k = 0; k < 3; ++k)
    CHECK(a.correlationLengths[k].value() ==
          Approx((k == 2 ? 3 : 1) * b.correlationLengths[k].value()));
}

TEST_CASE("unequal_voxels: boxes are as large as the cubes that they consist of",
          "[unequal_voxels]") {
  const auto labels = drawOverlappingBalls({1, 1, 2});
  const auto split = Int32Grid::create(0);
  auto accessor = split->getAccessor();
  for (auto value = labels->cbeginValueOn(); value; ++value)
    for (int part = 0; part < 2; ++part) {
      const Coord p = value.getCoord();
      accessor.setValue({p.x(), p.y(), 2 * p.z() + part}, *value);
    }
  MeasureOptions options;  // of the six grains, some are cut
  const CoordBBox domain = labels->evalActiveVoxelBoundingBox();
  options.domain = domain;
  const Measurements m = measure(*labels, options);
  options.domain = CoordBBox(Coord(domain.min().x(), domain.min().y(), 2 * domain.min().z()),
                             Coord(domain.max().x(), domain.max().y(), 2 * domain.max().z() + 1));
  const Measurements cubes = measure(*split, options);
  double cut = 0;
  for (size_t i = 0; i < m.grains.size(); ++i) {
    const GrainMeasures &a = m.grains[i], &b = cubes.grains[i];
    cut += a.cutArea;
    CHECK(a.volume == b.volume);
    CHECK(a.cutArea == b.cutArea);
    CHECK((a.centroid * Vec3d(1, 1, 2) + Vec3d(0, 0, 0.5) - b.centroid).length() < 1e-9);
    for (size_t k = 0; k < 3; ++k) {
      CHECK(a.ellipsoid.values[k] == Approx(b.ellipsoid.values[k]));
      CHECK((a.ellipsoid.axes[k] - b.ellipsoid.axes[k]).length() < 1e-6);
    }
    CHECK(a.freeArea == Approx(b.freeArea).epsilon(0.1));
  }
  CHECK(cut > 50);
  for (size_t i = 0; i < m.bonds.size(); ++i) {
    CHECK(m.bonds[i].faceArea == cubes.bonds[i].faceArea);
    CHECK((m.bonds[i].normal - cubes.bonds[i].normal).length() < 1e-9);
  }
}

TEST_CASE("unequal_voxels: representatives are those of the metric", "[unequal_voxels]") {
  const Vec3d edges(1, 1.4, 2.4);
  const auto labels = drawOverlappingBalls(edges);
  const Measurements m = measure(*labels);
  CoordBBox around = labels->evalActiveVoxelBoundingBox();
  around.expand(1);
  const auto accessor = labels->getConstAccessor();
  std::vector<Coord> background;
  for (auto p = around.begin(); p; ++p)
    if (accessor.getValue(*p) == 0) background.push_back(*p);
  const auto radiusAt = [&](const Coord& p) {
    double least = 1e9;
    for (const Coord& q : background) least = std::min(least, distance(p, q, edges));
    return least;
  };
  for (const GrainMeasures& grain : m.grains) {
    CHECK(grain.inscribedRadius == Approx(radiusAt(grain.representative.value())));
    // No voxel lies deeper; every seventh is looked at.
    int i = 0;
    for (auto p = grain.box.begin(); p; ++p)
      if (accessor.getValue(*p) == grain.id && ++i % 7 == 0)
        REQUIRE(radiusAt(*p) < grain.inscribedRadius + 1e-9);
  }
  for (const BondMeasures& bond : m.bonds) {
    const GrainMeasures &a = m.grains.at(size_t(bond.first) - 1),
                        &b = m.grains.at(size_t(bond.second) - 1);
    const double d = distance(*a.representative, *b.representative, edges);
    const double r = a.inscribedRadius, s = b.inscribedRadius;
    CHECK(bond.distance.value() == Approx(d));
    CHECK(bond.cosAlpha.value() == Approx((d * d - r * r - s * s) / (2 * r * s)));
  }
}

TEST_CASE("unequal_voxels: a segmentation is measured as its labels, with any number of threads",
          "[unequal_voxels]") {
  const auto labels = drawOverlappingBalls({1, 1, 2.5});
  const auto object = MaskGrid::create(false);
  object->setTransform(labels->transform().copy());
  object->tree().topologyUnion(labels->tree());
  SegmentOptions options;
  options.merge.strictness = 13;
  const Segmentation segmentation = segment(*object, options);
  REQUIRE(segmentation.weights == VoxelWeights{4, 4, 25});
  const auto cells = [](const Measurements& m) {
    std::vector<double> values;
    for (const auto& columns : {grainColumns(m.grains), bondColumns(m.bonds)})
      for (const MeasureColumn& column : columns)
        for (const double value : column.values) values.push_back(std::isnan(value) ? -1 : value);
    return values;
  };
  const auto expected = cells(withThreads(1, [&] { return measure(*segmentation.grain); }));
  REQUIRE(expected.size() > 200);
  CHECK(expected == cells(withThreads(2, [&] { return measure(*segmentation.grain); })));
  CHECK(expected == cells(measure(segmentation)));
}

TEST_CASE("unequal_voxels: columns and networks lie in the world", "[unequal_voxels]") {
  const Vec3d edges(0.001, 0.0005, 0.0015);
  const auto labels = drawOverlappingBalls({2, 1, 3});
  setVoxelSize(*labels, VoxelSize(std::array<double, 3>{1e-6, 0.5e-6, 1.5e-6}));
  const Measurements m = measure(*labels);
  const GrainNetwork network = grainNetwork(*labels);
  for (const MeasureColumn& column : grainColumns(m.grains)) {
    if (column.name == "id") continue;
    const auto found =
        std::find_if(network.grainColumns.begin(), network.grainColumns.end(),
                     [&](const GrainNetwork::Column& own) { return own.name == column.name; });
    REQUIRE(found != network.grainColumns.end());
    CAPTURE(column.name);
    for (size_t i = 0; i < m.grains.size(); ++i) {
      const bool isBox = column.name.compare(0, 4, "box_") == 0;
      const int axis = int(column.name.back() - 'x');
      const double expected =
          isBox ? column.values[i] * edges[axis] : scaled(column, column.values[i], edges);
      CHECK(found->values[i] == Approx(expected));
    }
  }
  for (size_t i = 0; i < m.grains.size(); ++i) {
    CHECK((network.centers[i] - m.grains[i].centroid * edges).length() < 1e-12);
    CHECK(network.grainColumns.at(1).name == "volume");
    CHECK(network.grainColumns[1].values[i] ==
          Approx(double(m.grains[i].voxels) * edges[0] * edges[1] * edges[2]));
  }
}
