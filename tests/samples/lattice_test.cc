// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Samples of voxels that are no cubes: the bodies of cubes, looked at in other places.

#include "vdb_madf/samples/detail/lattice.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/samples.h"
#include "vdb_madf/samples/detail/placement.h"
#include "vdb_madf/samples/pack.h"
#include "vdb_madf/samples/scan.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::Ball;
using openvdb::Vec3d;

const std::vector<Vec3d> kVoxelShapes = {{1, 1, 3}, {2, 1, 1}, {1, 1.7, 2.5}, {5.25, 1, 1.01}};

VoxelSize micrometers(const Vec3d& edges) {
  return VoxelSize({edges[0] / 1e6, edges[1] / 1e6, edges[2] / 1e6});
}

template <typename Options>
Options sample(const Coord& size, int count) {
  Options options;
  options.size = size;
  options.count = count;
  options.minRadius = 6;
  options.maxRadius = 10;
  options.seed = 5;
  return options;
}

/// Where a voxel is, in shortest edges: a cube at the corner of the box is at 0.
Vec3d placeOf(const Coord& p, const Vec3d& edges) {
  return (p.asVec3d() + Vec3d(0.5)) * edges - Vec3d(0.5);
}

/// By the definitions, voxel by voxel: the label is that of the body of least value, which is below
/// `limit` in the object.
template <typename Value>
void requireBodies(const Sample& sample, const Coord& size, const Vec3d& edges, size_t count,
                   double limit, const Value& value) {
  const CoordBBox box = storedDomain(*sample.object)->box();
  CHECK(box.min() == Coord(0));
  for (int axis = 0; axis < 3; ++axis)
    CHECK(box.dim()[axis] == int(std::ceil(size[axis] / edges[axis])));
  size_t wrong = 0;
  std::set<int32_t> owners;
  for (auto p = box.begin(); p; ++p) {
    const Vec3d place = placeOf(*p, edges);
    size_t best = 0;
    for (size_t i = 1; i < count; ++i)
      if (value(i, place) < value(best, place)) best = i;
    const int32_t label = value(best, place) < limit ? int32_t(best) + 1 : 0;
    wrong += sample.truth->tree().getValue(*p) != label;
    wrong += sample.object->tree().isValueOn(*p) != (label > 0);
    if (label > 0) owners.insert(label);
  }
  CHECK(wrong == 0);
  CHECK(owners.size() == count);  // else numbers differ
  CHECK(sample.truth->tree().hasSameTopology(sample.object->tree()));
  CHECK(labelsOf(*sample.truth) == owners);
}

double powerAt(const Ball& ball, const Vec3d& p) {
  return (p - Vec3d(ball.x, ball.y, ball.z)).lengthSqr() - ball.radius * ball.radius;
}

/// Voxels of 1 : 1 : 3 are every third slice of cubes, from the second.
void requireThirdSlices(const Sample& cubes, const Sample& third) {
  const CoordBBox box = storedDomain(*third.object)->box();
  CHECK(storedDomain(*cubes.object)->box().dim().z() == 3 * box.dim().z());
  size_t wrong = 0;
  for (auto p = box.begin(); p; ++p) {
    const Coord q((*p).x(), (*p).y(), 3 * (*p).z() + 1);
    wrong += cubes.object->tree().isValueOn(q) != third.object->tree().isValueOn(*p);
    wrong += cubes.truth->tree().getValue(q) != third.truth->tree().getValue(*p);
  }
  CHECK(wrong == 0);
  CHECK(third.object->activeVoxelCount() > 1000);
}

template <typename Options, typename Generate>
void requireThirdSlicesOf(Options options, const Generate& generate) {
  const Sample cubes = generate(options);
  options.voxelSize = micrometers({1, 1, 3});
  requireThirdSlices(cubes, generate(options));
}

}  // namespace

TEST_CASE("lattice: spheres are the balls of cubes", "[lattice]") {
  for (const Vec3d& edges : kVoxelShapes) {
    CAPTURE(edges);
    auto options = sample<SphereOptions>({63, 60, 66}, 9);
    const auto balls = detail::placeSpheres(options, nullptr);
    options.voxelSize = micrometers(edges);
    requireBodies(generateSpheres(options), options.size, edges, balls.size(), 0,
                  [&](size_t i, const Vec3d& p) { return powerAt(balls[i], p); });
  }
}

TEST_CASE("lattice: particles are those of cubes", "[lattice]") {
  for (const ParticleShape shape :
       {ParticleShape::ellipsoids, ParticleShape::polyhedra, ParticleShape::rods})
    for (const Vec3d& edges : kVoxelShapes) {
      CAPTURE(int(shape), edges);
      auto options = sample<ParticleOptions>({64, 50, 52}, 8);
      options.shape = shape;
      const auto particles = detail::placeParticles(options, nullptr);
      options.voxelSize = micrometers(edges);
      requireBodies(generateParticles(options), options.size, edges, particles.size(), 1,
                    [&](size_t i, const Vec3d& p) { return particles[i].value(p); });
    }
}

TEST_CASE("lattice: longer voxels are slices of cubes", "[lattice]") {
  // Longer than a piece, and several blocks.
  requireThirdSlicesOf(sample<SphereOptions>({140, 60, 159}, 9),
                       [](const auto& options) { return generateSpheres(options); });
  requireThirdSlicesOf(sample<ParticleOptions>({140, 40, 39}, 12),
                       [](const auto& options) { return generateParticles(options); });
  for (const double roughness : {0.0, 0.8}) {
    auto options = sample<SinteredOptions>({140, 40, 159}, 40);
    options.roughness = roughness;
    requireThirdSlicesOf(options, [](const auto& o) { return generateSintered(o); });
  }
}

TEST_CASE("lattice: the field of sintered balls is that of cubes", "[lattice]") {
  auto options = sample<SinteredOptions>({60, 51, 63}, 8);
  options.roughness = 0.8;
  const auto balls = detail::placeSintered(options, nullptr);
  const detail::WhiteNoise noise(options.seed, 1);
  const auto weight = [](double d, double sigma) {
    return std::exp(-d * d / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * M_PI));
  };
  for (const Vec3d& edges : kVoxelShapes) {
    CAPTURE(edges);
    options.voxelSize = micrometers(edges);
    const Sample sample = generateSintered(options);
    const Coord dim = storedDomain(*sample.object)->box().dim();
    std::mt19937 random(1);
    for (int i = 0; i < 150; ++i) {
      const Coord p(int(random() % unsigned(dim.x())), int(random() % unsigned(dim.y())),
                    int(random() % unsigned(dim.z())));
      const Vec3d place = placeOf(p, edges);
      double blurred = 0, rough = 0;
      for (auto q = CoordBBox::createCube(Coord::floor(place).offsetBy(-8), 18).begin(); q; ++q) {
        const Vec3d d = (*q).asVec3d() - place;
        if (std::any_of(balls.begin(), balls.end(),
                        [&](const Ball& ball) { return powerAt(ball, (*q).asVec3d()) < 0; }))
          blurred += weight(d[0], 2) * weight(d[1], 2) * weight(d[2], 2);
        if (std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])}) <= 4)
          rough += weight(d[0], 1) * weight(d[1], 1) * weight(d[2], 1) *
                   noise.value(noise.row((*q).x(), (*q).y()), (*q).z());
      }
      const double value = blurred + options.roughness * 1.5 * rough;
      if (std::abs(value - 0.45) < 2e-3) continue;
      CAPTURE(p, value);
      CHECK(sample.object->tree().isValueOn(p) == (value >= 0.45));
    }
    size_t wrong = 0;
    for (auto voxel = sample.truth->cbeginValueOn(); voxel; ++voxel) {
      const Vec3d place = placeOf(voxel.getCoord(), edges);
      size_t best = 0;
      for (size_t i = 1; i < balls.size(); ++i)
        if (powerAt(balls[i], place) < powerAt(balls[best], place)) best = i;
      wrong += *voxel != int32_t(best) + 1;
    }
    CHECK(wrong == 0);
    CHECK(labelsOf(*sample.truth).size() == balls.size());
  }
}

TEST_CASE("lattice: a pack has its fraction", "[lattice]") {
  PackOptions options;
  options.size = {90, 60, 61};
  options.minRadius = 5;
  options.maxRadius = 8;
  for (const Vec3d& edges : kVoxelShapes) {
    CAPTURE(edges);
    options.voxelSize = micrometers(edges);
    const Sample sample = generatePack(options);
    requireInsideDomain(sample);
    CHECK(solidFraction(sample) == Approx(0.25).margin(0.005));
  }
}

TEST_CASE("lattice: threads do not matter", "[lattice]") {
  auto options = sample<SinteredOptions>({160, 140, 60}, 60);
  options.roughness = 0.5;
  options.voxelSize = micrometers({1, 2.5, 1.3});
  requireSameForAnyThreads([&] { return generateSintered(options); });
}

TEST_CASE("lattice: cubes of any size are cubes", "[lattice]") {
  auto options = sample<SphereOptions>({40, 41, 42}, 4);
  const uint64_t cubes = hash(generateSpheres(options));
  options.voxelSize = VoxelSize(8.5e-6);
  const Sample sized = generateSpheres(options);
  CHECK(hash(sized) == cubes);
  CHECK(storedVoxelSize(*sized.truth)->edge() == 8.5e-6);
  CHECK(sized.object->metaValue<std::string>(kSourceKey).find("voxel-size") == std::string::npos);
}

TEST_CASE("lattice: a sample says the edges, in whatever unit they were given", "[lattice]") {
  auto options = sample<SphereOptions>({40, 41, 42}, 4);
  options.voxelSize = micrometers({1, 1, 3});
  const Sample sample = generateSpheres(options);
  for (const openvdb::GridBase::Ptr& grid :
       {openvdb::GridBase::Ptr(sample.object), openvdb::GridBase::Ptr(sample.truth)}) {
    CHECK(storedDomain(*grid) == CoordBBox({0, 0, 0}, {39, 40, 13}));
    CHECK(storedVoxelSize(*grid)->edges() == options.voxelSize->edges());
    CHECK(grid->voxelSize() == Vec3d(0.001, 0.001, 0.003));
    CHECK(grid->metaValue<std::string>(kSourceKey) ==
          "generate spheres --dims 40x41x42 --count 4 --radius 6:10 --overlap 0.084 --max-cover 2 "
          "--seed 5 --voxel-size 0.001x0.001x0.003mm");
  }
  for (const double unit : {2e-4, 0.1, 1 / 3.0, 700.0}) {
    options.voxelSize = micrometers(Vec3d(1, 1, 3) * unit);
    CHECK(hash(generateSpheres(options)) == hash(sample));
  }
}

TEST_CASE("lattice: what cannot be made is refused", "[lattice]") {
  auto options = sample<SphereOptions>({40, 40, 30}, 2);
  options.voxelSize = micrometers({1, 1, 30});
  CHECK(generateSpheres(options).object);
  options.voxelSize = micrometers({1, 1, 31});
  CHECK_THROWS_WITH(generateSpheres(options),
                    "a voxel is longer than the sample along z, where it measures 31 of its "
                    "shortest edges, the sample 30: use a larger size");
  options.voxelSize = micrometers({1, 1, 3});
  const Sample sample = generateSpheres(options);
  CHECK(scanned(sample, {}).object);
  ScanOptions scan;
  scan.blur = 1;
  CHECK_THROWS_WITH(scanned(sample, scan), vdb_madf::test::Contains("needs cubic voxels"));
}
