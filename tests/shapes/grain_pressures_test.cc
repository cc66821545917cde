// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/grain_pressures.h"

#include <cmath>
#include <random>

#include "support/catch.h"

using namespace vdb_madf::detail;

namespace {

/// A chain of grains that each take from the next one what they gain at their contact; \p surface:
/// what they gain towards the background.
PressureEquations chain(size_t count, double surface, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<double> contacts(count + 1);
  for (size_t i = 1; i < count; ++i) contacts[i] = 1 + double(random() % 100);
  PressureEquations equations;
  equations.first.push_back(0);
  for (size_t g = 0; g < count; ++g) {
    equations.own.push_back(surface + contacts[g] + contacts[g + 1]);
    for (const auto& [other, contact] : {std::pair(g - 1, contacts[g]), {g + 1, contacts[g + 1]}}) {
      if (other >= count) continue;
      equations.neighbors.push_back(uint32_t(other));
      equations.byNeighbor.push_back(-contact);
    }
    equations.first.push_back(uint32_t(equations.neighbors.size()));
  }
  return equations;
}

double growth(const PressureEquations& equations, const std::vector<double>& pressures, size_t g) {
  double sum = equations.own[g] * pressures[g];
  for (uint32_t i = equations.first[g]; i < equations.first[g + 1]; ++i)
    sum += equations.byNeighbor[i] * pressures[equations.neighbors[i]];
  return sum;
}

}  // namespace

TEST_CASE("grain_pressures: every grain grows by what it misses", "[grain_pressures]") {
  for (const unsigned seed : {1u, 2u, 3u}) {
    std::mt19937 random(seed);
    const PressureEquations equations = chain(60, 5, seed);
    std::vector<double> missing(60);
    for (double& volume : missing) volume = double(random() % 201) - 100;
    const auto pressures = pressuresFor(equations, missing, std::vector<double>(60, 1e-6));
    for (size_t g = 0; g < missing.size(); ++g)
      CHECK(growth(equations, pressures, g) == Approx(missing[g]).margin(2e-6));
  }
}

TEST_CASE("grain_pressures: no grain, one that does not grow, grains that fill all there is",
          "[grain_pressures]") {
  CHECK(pressuresFor({{}, {0}, {}, {}}, {}, {}).empty());
  const auto alone = pressuresFor({{0, 2}, {0, 0, 0}, {}, {}}, {3, 4}, {1e-9, 1e-9});
  CHECK(alone == std::vector<double>{0, 2});
  // What they gain together is lost to nobody: it cannot be had, and the rest is met.
  const PressureEquations closed = chain(8, 0, 4);
  const auto met = pressuresFor(closed, {7, 0, -7, 0, 0, 1, 0, -1}, std::vector<double>(8, 1e-6));
  CHECK(growth(closed, met, 0) == Approx(7));
  CHECK(growth(closed, met, 7) == Approx(-1));
  for (const double pressure :
       pressuresFor(closed, std::vector<double>(8, 1), std::vector<double>(8)))
    CHECK(std::isfinite(pressure));
}
