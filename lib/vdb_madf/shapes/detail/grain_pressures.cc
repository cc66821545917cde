// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/grain_pressures.h"

#include <cmath>
#include <numeric>

#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kRowGrain = 1024;
constexpr int kMaxSteps = 200;

void multiply(const PressureEquations& equations, const std::vector<double>& x,
              std::vector<double>& product) {
  parallelForEach(x.size(), kRowGrain, nullptr, [&](size_t g) {
    double sum = equations.own[g] * x[g];
    for (uint32_t i = equations.first[g]; i < equations.first[g + 1]; ++i)
      sum += equations.byNeighbor[i] * x[equations.neighbors[i]];
    product[g] = sum;
  });
}

/// A sum in order: the same for any number of threads.
double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

// The preconditioned conjugate gradient method with the diagonal as preconditioner (Y. Saad,
// Iterative Methods for Sparse Linear Systems, 2nd edition, SIAM 2003, algorithm 9.1).
std::vector<double> pressuresFor(const PressureEquations& equations,
                                 const std::vector<double>& missing,
                                 const std::vector<double>& tolerance) {
  const size_t count = missing.size();
  std::vector<double> pressures(count), residual(missing), z(count), direction(count),
      product(count);
  for (size_t g = 0; g < count; ++g)
    if (!(equations.own[g] > 0)) residual[g] = 0;
  double lastRho = 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    bool isDone = true;
    for (size_t g = 0; g < count; ++g) {
      z[g] = equations.own[g] > 0 ? residual[g] / equations.own[g] : 0;
      isDone = isDone && std::abs(residual[g]) <= tolerance[g];
    }
    if (isDone) break;
    const double rho = dot(residual, z), beta = step > 0 ? rho / lastRho : 0;
    for (size_t g = 0; g < count; ++g) direction[g] = z[g] + beta * direction[g];
    multiply(equations, direction, product);
    const double curvature = dot(direction, product);
    if (!(curvature > 0)) break;  // grains that fill all there is: nothing is left to be gained
    const double alpha = rho / curvature;
    for (size_t g = 0; g < count; ++g) {
      pressures[g] += alpha * direction[g];
      residual[g] -= alpha * product[g];
    }
    lastRho = rho;
  }
  return pressures;
}

}  // namespace vdb_madf::detail
