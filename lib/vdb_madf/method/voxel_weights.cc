// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/voxel_weights.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/world_transform.h"

namespace vdb_madf {

namespace {

constexpr char kWeights[] = "madf_weights";
constexpr double kWantedError = 1e-6, kLargestError = 0.01;
constexpr int64_t kBound = int64_t(1) << 31;  // of squared distances
constexpr int64_t kBeyond = 14;               // a row and the rest of its first and last leaf

using Edges = std::array<double, 3>;

bool areCubes(const Edges& edges) {
  return detail::areEdgesOfCube({edges[0], edges[1], edges[2]});
}

/// sum of w_a (n_a + 14)^2 < 2^31; weights of up to 2^62.
bool fit(const std::array<int64_t, 3>& weights, const Coord& extent) {
  int64_t sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t length = extent[axis] + kBeyond;
    if (weights[size_t(axis)] > (kBound - 1 - sum) / (length * length)) return false;
    sum += weights[size_t(axis)] * length * length;
  }
  return true;
}

VoxelWeights narrowed(const std::array<int64_t, 3>& w) {
  return {int32_t(w[0]), int32_t(w[1]), int32_t(w[2])};
}

/// digits * 10^exponent, without trailing zeros.
struct Decimal {
  int64_t digits = 0;
  int exponent = 0;
};

/// The decimal number of up to nine digits that an edge is, but for the rounding of a change of
/// unit.
std::optional<Decimal> decimalOf(double edge) {
  char text[32];  // d.dddddddde-ddd
  const auto end =
      std::to_chars(text, text + sizeof text, edge, std::chars_format::scientific, 8).ptr;
  const double rounded = detail::leadingReal(std::string(text, end)).value;
  if (!(std::abs(rounded - edge) <= 1e-12 * edge)) return std::nullopt;
  Decimal result;
  const char* const mark = std::find(text, end, 'e');
  for (const char* c = text; c != mark; ++c)
    if (*c != '.') result.digits = 10 * result.digits + (*c - '0');
  const char* const exponent = mark + (mark[1] == '+' ? 2 : 1);  // from_chars knows no plus
  std::from_chars(exponent, end, result.exponent);
  for (; result.digits % 10 == 0; result.digits /= 10) ++result.exponent;
  return result;
}

/// The squares of edges that are decimal numbers, in lowest terms, if they are not huge.
std::optional<std::array<int64_t, 3>> exactWeights(const Edges& edges) {
  constexpr int64_t kLargest = 46340;  // squared below 2^31
  std::array<Decimal, 3> decimals;
  int least = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto decimal = decimalOf(edges[axis]);
    if (!decimal) return std::nullopt;
    decimals[axis] = *decimal;
    least = axis == 0 ? decimal->exponent : std::min(least, decimal->exponent);
  }
  std::array<int64_t, 3> lengths{};
  int64_t divisor = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    const int zeros = decimals[axis].exponent - least;
    if (zeros > 9) return std::nullopt;  // below 10^18 then
    lengths[axis] = decimals[axis].digits;
    for (int i = 0; i < zeros; ++i) lengths[axis] *= 10;
    divisor = std::gcd(divisor, lengths[axis]);
  }
  for (int64_t& length : lengths) {
    length /= divisor;
    if (length > kLargest) return std::nullopt;
    length *= length;
  }
  return lengths;
}

[[noreturn]] void refuse(const Edges& edges, const Coord& extent) {
  throw InvalidInput("voxels of " + detail::generalDecimal(edges[0], 6) + " x " +
                     detail::generalDecimal(edges[1], 6) + " x " +
                     detail::generalDecimal(edges[2], 6) + " and an object of " +
                     std::to_string(extent[0]) + " x " + std::to_string(extent[1]) + " x " +
                     std::to_string(extent[2]) +
                     " of them: squared distances do not fit in 32 bits to within 1 %; resample to "
                     "voxels that are more alike, or crop");
}

}  // namespace

std::string VoxelWeights::toString() const {
  return std::to_string(x) + ":" + std::to_string(y) + ":" + std::to_string(z);
}

bool fitWeights(const VoxelWeights& weights, const Coord& extent) {
  return weights == VoxelWeights{} || fit({weights.x, weights.y, weights.z}, extent);
}

void checkWeights(const VoxelWeights& weights, const Coord& extent) {
  if (weights.least() < 1)
    throw InvalidInput("the weights " + weights.toString() + " of the axes must be positive");
  if (!fitWeights(weights, extent))
    throw InvalidInput("the weights " + weights.toString() +
                       " of the axes are too large: squared distances in an object of " +
                       std::to_string(extent[0]) + " x " + std::to_string(extent[1]) + " x " +
                       std::to_string(extent[2]) + " voxels do not fit in 32 bits");
}

WeightsOfEdges weightsOfEdges(const Edges& edges, const Coord& extent) {
  for (const double edge : edges)
    if (!(edge > 0 && std::isfinite(edge)))
      throw InvalidInput("a voxel has an edge of length " + detail::generalDecimal(edge, 6));
  if (areCubes(edges)) return {};
  const auto exact = exactWeights(edges);
  if (exact && fit(*exact, extent)) return {narrowed(*exact), 0};

  // Each step is one correctly rounded operation, so that all machines find the same.
  const double shortest = *std::min_element(edges.begin(), edges.end());
  Edges ratio{};
  for (size_t axis = 0; axis < 3; ++axis) {
    const double edge = edges[axis] / shortest;
    ratio[axis] = edge * edge;
    if (!(ratio[axis] < double(kBound))) refuse(edges, extent);
  }
  WeightsOfEdges best{{}, 1};
  for (int64_t q = 1; best.error > kWantedError; ++q) {
    std::array<int64_t, 3> weights{};
    double error = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
      const double wanted = double(q) * ratio[axis];
      weights[axis] = std::llround(wanted);
      const double quotient = double(weights[axis]) / wanted;
      error = std::max(error, std::abs(quotient - 1));
    }
    if (!fit(weights, extent)) break;
    if (error < best.error) best = {narrowed(weights), error};
  }
  if (!(best.error <= kLargestError)) refuse(edges, extent);
  return best;
}

Edges voxelEdges(const openvdb::math::Transform& transform) {
  const auto along = detail::edgesAlongAxes(transform);
  if (!along)
    throw InvalidInput(
        "the grid's voxels are not boxes along the axes (turned, sheared or of several sizes): "
        "resample the grid first");
  // Of a linear map, without the rounding of differences of positions.
  Edges edges{};
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d unit(0);
    unit[axis] = 1;
    edges[size_t(axis)] = std::abs(transform.baseMap()->applyJacobian(unit)[axis]);
  }
  return edges;
}

VoxelWeights storedWeights(const openvdb::MetaMap& metadata) {
  const auto stored = metadata.getMetadata<openvdb::Vec3IMetadata>(kWeights);
  if (!stored) return {};
  const openvdb::Vec3i w = stored->value();
  const VoxelWeights weights{w.x(), w.y(), w.z()};
  if (weights.least() < 1)
    throw InvalidInput("metadata madf_weights says " + weights.toString() +
                       ": weights must be positive");
  return weights;
}

void setWeights(openvdb::MetaMap& metadata, const VoxelWeights& weights) {
  metadata.removeMeta(kWeights);
  if (weights != VoxelWeights{})
    metadata.insertMeta(kWeights, openvdb::Vec3IMetadata({weights.x, weights.y, weights.z}));
}

}  // namespace vdb_madf
