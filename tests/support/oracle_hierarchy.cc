// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The oracle's joining by score: all pairs of classes are looked at anew before each join.

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "support/oracle.h"

namespace vdb_madf::test {

namespace {

using Wide = __int128;

/// The largest L with 2^L <= n^256. By the long double next to it, which is off by less than 1e-12.
int64_t lg(int64_t n) {
  return int64_t(std::floor(256 * std::log2((long double)n)));
}

int64_t root(int64_t n) {
  return int64_t(std::floor(std::sqrt((long double)n)));
}

/// A class, as its score sees it.
struct Size {
  int64_t voxels = 0, top = 0;
  uint32_t representative = 0;
  int64_t sure = 0;  ///< its largest D that is sure
};

struct Touch {
  int64_t faces = 0, height = 0;
};

bool comesFirst(const Size& a, const Size& b) {
  if (a.top != b.top) return a.top < b.top;
  if (a.voxels != b.voxels) return a.voxels < b.voxels;
  return a.representative > b.representative;
}

/// What a score takes for the tops of a pair, the first of which has the smaller one.
void limitTops(Size& a, Size& b, int64_t height) {
  if (a.sure < a.top) {
    const int64_t fitting = b.sure < a.top ? b.sure : a.top;
    a.top = std::max(std::max(a.sure, fitting), std::max(height, a.top * 9 / 10));
  }
  if (b.sure >= b.top || b.voxels > a.voxels) return;
  b.top = b.sure > a.top ? b.sure : a.top;
}

}  // namespace

int64_t oracleScore(int64_t voxelsA, int64_t topA, int64_t voxelsB, int64_t topB, int64_t faces,
                    int64_t height, const VoxelWeights& weights) {
  const int64_t least = std::min({weights.x, weights.y, weights.z});
  // Squared lengths are multiples of a common factor of the weights.
  int64_t factor = 1;
  for (int64_t g = 2; g <= least; ++g)
    if (weights.x % g == 0 && weights.y % g == 0 && weights.z % g == 0) factor = g;
  const int64_t rho = root(65536 * topA / topB);
  const int64_t d = root(65536 * topA / least) - root(65536 * height / least);
  const int64_t ball = 1067 + 3 * lg(std::max<int64_t>(1, topA / factor)) - lg(weights.x / factor) -
                       lg(weights.y / factor) - lg(weights.z / factor);
  int64_t u = std::min(2 * lg(voxelsA), std::max<int64_t>(0, ball));
  u = std::max(u, 2 * lg(voxelsA) - 1024);
  const Wide square = Wide(voxelsB) * voxelsB;
  Wide w = Wide(18) * topB * topB * topB / (Wide(weights.x) * weights.y * weights.z);
  w = std::min(square, std::max<Wide>(1, w));
  w = std::max(square / 16, w);
  const Wide cube = Wide(256 * faces) * (256 * faces) * (256 * faces);
  // The largest f, from somewhat below its root on.
  const long double about = std::cbrt((long double)cube / (long double)w);
  int64_t f = std::max<int64_t>(0, int64_t(std::min(about, 8191.0L)) - 2);
  while (f < 8191 && Wide(f + 1) * (f + 1) * (f + 1) * w <= cube) ++f;
  return 2 * lg(voxelsB) - u + 18 * rho + 5 * f - 8 * d +
         3 * std::max<int64_t>(0, 1792 - lg(voxelsA));
}

int64_t oraclePlaneScore(int64_t voxelsA, int64_t topA, int64_t voxelsB, int64_t topB,
                         int64_t faces, int64_t height, int64_t weightX, int64_t weightY) {
  const int64_t least = std::min(weightX, weightY);
  int64_t factor = 1;
  for (int64_t g = 2; g <= least; ++g)
    if (weightX % g == 0 && weightY % g == 0) factor = g;
  const int64_t rho = root(65536 * topA / topB);
  const int64_t d = root(65536 * topA / least) - root(65536 * height / least);
  const int64_t disc = 338 + lg(std::max<int64_t>(1, topA / factor)) -
                       (lg(weightX / factor) + lg(weightY / factor)) / 2;
  const int64_t u = std::max(lg(voxelsA) - 512, std::min(lg(voxelsA), std::max<int64_t>(0, disc)));
  // The largest w with w^2 <= (10 m)^2 / (wx wy), from somewhat below its root on.
  const Wide square = Wide(100) * topB * topB / (Wide(weightX) * weightY);
  auto w = std::max<int64_t>(1, int64_t(std::sqrt((long double)square)) - 2);
  while (Wide(w + 1) * (w + 1) <= square) ++w;
  w = std::max(voxelsB, std::min(4 * voxelsB, w));
  const Wide whole = Wide(512 * faces) * (512 * faces);
  const long double about = std::sqrt((long double)whole / (long double)w);
  int64_t f = std::max<int64_t>(0, int64_t(std::min(about, 8191.0L)) - 2);
  while (f < 8191 && Wide(f + 1) * (f + 1) * w <= whole) ++f;
  return 3 * (lg(voxelsB) - u) + 16 * rho + 6 * f - 5 * d +
         2 * std::max<int64_t>(0, 1536 - lg(voxelsA));
}

OracleHierarchy oracleHierarchy(const ManifoldGraph& graph) {
  const auto& nodes = graph.nodes;
  OracleHierarchy result;
  // Classes are named by their representatives: of largest D, then of smaller coordinate.
  std::vector<uint32_t>& classOf = result.classOf;
  for (uint32_t i = 0; i < nodes.size(); ++i) classOf.push_back(i);
  const auto unite = [&](uint32_t x, uint32_t y, std::vector<uint32_t>& classes) {
    const uint32_t name = nodes[x].squaredRadius != nodes[y].squaredRadius
                              ? (nodes[x].squaredRadius > nodes[y].squaredRadius ? x : y)
                              : std::min(x, y);
    for (uint32_t& c : classes)
      if (c == x || c == y) c = name;
  };
  // Stage 0: highest edges first, then by their pairs.
  auto edges = graph.edges;
  std::stable_sort(edges.begin(), edges.end(),
                   [](const auto& a, const auto& b) { return a.saddleHeight > b.saddleHeight; });
  for (const auto& edge : edges) {
    const uint32_t a = classOf[edge.first], b = classOf[edge.second];
    if (edge.saddleHeight <= 0 || a == b) continue;
    if (edge.saddleHeight >= std::min(nodes[a].squaredRadius, nodes[b].squaredRadius))
      unite(a, b, classOf);
  }

  std::vector<uint32_t> classes = classOf;
  while (true) {
    std::map<uint32_t, Size> sizes;
    for (uint32_t i = 0; i < nodes.size(); ++i) {
      Size& size = sizes[classes[i]];
      size.voxels += nodes[i].voxels + nodes[i].cavityVoxels;
      size.top = nodes[classes[i]].squaredRadius;
      size.sure = std::max<int64_t>(size.sure, nodes[i].squaredRadius - nodes[i].doubt);
      size.representative = classes[i];
    }
    for (auto& entry : sizes) entry.second.voxels = std::max<int64_t>(1, entry.second.voxels);
    std::map<std::pair<uint32_t, uint32_t>, Touch> touches;
    for (const auto& edge : graph.edges) {
      const uint32_t a = classes[edge.first], b = classes[edge.second];
      if (a == b) continue;
      Touch& touch = touches[std::minmax(a, b)];
      touch.faces += edge.contactFaces;
      touch.height = std::max<int64_t>(touch.height, edge.saddleHeight);
    }
    std::optional<OracleHierarchy::Join> best;
    for (const auto& [pair, touch] : touches) {  // in the order of ties
      if (touch.height <= 0) continue;
      Size a = sizes[pair.first], b = sizes[pair.second];
      if (!comesFirst(a, b)) std::swap(a, b);
      limitTops(a, b, touch.height);
      const VoxelWeights& w = graph.weights;
      const int64_t score =
          graph.flatAxis
              ? oraclePlaneScore(a.voxels, a.top, b.voxels, b.top, touch.faces, touch.height,
                                 *graph.flatAxis == 0 ? w.y : w.x, *graph.flatAxis == 2 ? w.y : w.z)
              : oracleScore(a.voxels, a.top, b.voxels, b.top, touch.faces, touch.height, w);
      if (!best || score > best->score) best = {pair.first, pair.second, score};
    }
    if (!best) return result;
    result.joins.push_back(*best);
    unite(best->first, best->second, classes);
  }
}

std::vector<uint32_t> oracleCut(const ManifoldGraph& graph, const OracleHierarchy& hierarchy,
                                double strictness) {
  std::vector<uint32_t> classes = hierarchy.classOf;
  for (const OracleHierarchy::Join& join : hierarchy.joins) {
    if (join.score < std::llround(512 * strictness)) break;
    const int32_t first = graph.nodes[join.first].squaredRadius,
                  second = graph.nodes[join.second].squaredRadius;
    const uint32_t name = first >= second ? join.first : join.second;
    for (uint32_t& c : classes)
      if (c == join.first || c == join.second) c = name;
  }
  return classes;
}

}  // namespace vdb_madf::test
