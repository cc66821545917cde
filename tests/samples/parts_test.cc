// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The parts that the samples are made of: unions of balls, power cells, noise and blur.

#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "support/balls.h"
#include "support/catch.h"
#include "vdb_madf/samples/detail/ball_union.h"
#include "vdb_madf/samples/detail/gaussian_blur.h"
#include "vdb_madf/samples/detail/power_cells.h"
#include "vdb_madf/samples/detail/random.h"

using namespace vdb_madf;
using brute::inUnion;
using brute::nearest;
using detail::Ball;

namespace {

std::vector<Ball> randomBalls(std::mt19937& random, int count, double reach) {
  std::uniform_real_distribution<double> at(-6, reach + 6), radius(0.5, 9);
  std::vector<Ball> balls;
  for (int i = 0; i < count; ++i) {
    const double x = at(random), y = at(random), z = at(random);
    balls.push_back({x, y, z, radius(random)});
  }
  return balls;
}

}  // namespace

TEST_CASE("generate: a union of balls equals the definition", "[generate]") {
  const Coord size(40, 133, 37);
  const CoordBBox box(Coord(0), size.offsetBy(-1));
  for (unsigned seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    auto balls = randomBalls(random, 40, 40);
    balls.push_back({20.5, 100, 18, 21});
    balls.push_back({3, 3, 3, 1});
    const bool tiles = seed % 2;
    detail::BallUnion together(size, tiles), single(size, tiles);
    std::vector<Ball> inside;
    for (const Ball& ball : balls) {
      CoordBBox touched = detail::ballBox(ball);
      touched.intersect(box);
      if (!touched.empty()) inside.push_back(ball);
    }
    together.add(inside, nullptr);
    for (const Ball& ball : inside) {
      const int64_t before = single.voxelCount(), added = single.countNew(ball);
      single.add(ball);
      CHECK(single.voxelCount() == before + added);
    }
    CHECK(together.voxelCount() == single.voxelCount());
    const auto tree = together.takeTree();
    CHECK(int64_t(tree->activeVoxelCount()) == together.voxelCount());
    CHECK((tree->activeTileCount() > 0) == tiles);
    size_t wrong = 0;
    for (auto p = box.begin(); p; ++p) wrong += tree->isValueOn(*p) != inUnion(inside, *p);
    CHECK(wrong == 0);
  }
}

TEST_CASE("generate: power cells equal the definition, gaps in the numbers closed", "[generate]") {
  std::mt19937 random(9);
  auto balls = randomBalls(random, 30, 130);
  balls.push_back({60, 60, 60, 12});
  balls.push_back({60, 61, 60, 1});  // owns nothing
  detail::sortByCenter(balls);
  MaskTree object;
  for (int i = 0; i < 20000; ++i)
    object.setValue(Coord(int(random() % 130), int(random() % 130), int(random() % 130)), true);
  const auto cells = detail::powerCells(object, balls, nullptr);
  std::set<int32_t> owners;
  for (auto voxel = cells->cbeginValueOn(); voxel; ++voxel)
    owners.insert(nearest(balls, voxel.getCoord()));
  CHECK(owners.size() < balls.size());
  const std::vector<int32_t> sorted(owners.begin(), owners.end());
  size_t wrong = 0;
  for (auto voxel = cells->cbeginValueOn(); voxel; ++voxel)
    wrong += sorted[size_t(*voxel - 1)] != nearest(balls, voxel.getCoord());
  CHECK(wrong == 0);
}

TEST_CASE("generate: the kernel is a normalized Gaussian", "[generate]") {
  for (const double sigma : {0.6, 1.0, 2.0, 7.3}) {
    const auto kernel = detail::gaussianKernel(sigma);
    double sum = kernel[0];
    for (size_t k = 1; k < kernel.size(); ++k) {
      sum += 2 * double(kernel[k]);
      CHECK(kernel[k] / kernel[0] == Approx(std::exp(-double(k * k) / (2 * sigma * sigma))));
    }
    CHECK(sum == Approx(1));
  }
}

TEST_CASE("generate: white noise has zero mean and unit variance", "[generate]") {
  const detail::WhiteNoise noise(1, 0);
  double sum = 0, squares = 0, neighbours = 0;
  constexpr int kEdge = 60;
  for (int x = -kEdge / 2; x < kEdge / 2; ++x)
    for (int y = 0; y < kEdge; ++y)
      for (int z = 0; z < kEdge; ++z) {
        const double value = noise.value(noise.row(x, y), z);
        sum += value;
        squares += value * value;
        neighbours +=
            value * (noise.value(noise.row(x, y), z + 1) + noise.value(noise.row(x, y + 1), z) +
                     noise.value(noise.row(x + 1, y), z));
      }
  const double n = kEdge * kEdge * kEdge;
  CHECK(sum / n == Approx(0).margin(0.01));
  CHECK(squares / n == Approx(1).margin(0.01));
  CHECK(neighbours / n == Approx(0).margin(0.02));
}
