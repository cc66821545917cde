// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/convex_hull.h"

#include <libqhull_r/libqhull_r.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;

/// A run of qhull, which prints into memory.
class QhullRun {
 public:
  explicit QhullRun(std::vector<double>& coordinates)
      : messages_(fmemopen(text_, sizeof text_, "w")) {
    if (!messages_) throw std::bad_alloc();
    qh_zero(&qh_, messages_.get());
    char command[] = "qhull Qt";  // all facets triangles
    const int code = qh_new_qhull(&qh_, 3, int(coordinates.size() / 3), coordinates.data(), False,
                                  command, nullptr, messages_.get());
    if (code == 0) return;
    free();
    if (code == qh_ERRmem) throw std::bad_alloc();
    throw std::runtime_error("qhull finds no convex hull (error " + std::to_string(code) + ")");
  }
  ~QhullRun() { free(); }
  QhullRun(const QhullRun&) = delete;
  QhullRun& operator=(const QhullRun&) = delete;

  const vertexT* firstVertex() const { return qh_.vertex_list; }
  const facetT* firstFacet() const { return qh_.facet_list; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void free() {
    qh_freeqhull(&qh_, !qh_ALL);
    int longBlocks = 0, longBytes = 0;
    qh_memfreeshort(&qh_, &longBlocks, &longBytes);
  }

  char text_[1024];
  std::unique_ptr<std::FILE, Close> messages_;
  qhT qh_;
};

/// The three vertices of a facet.
std::array<const vertexT*, 3> cornersOf(const facetT& facet) {
  std::array<const vertexT*, 3> corners;
  for (size_t i = 0; i < 3; ++i) corners[i] = static_cast<const vertexT*>(facet.vertices->e[i].p);
  return corners;
}

/// A side of a triangle.
struct Side {
  std::array<uint32_t, 2> ends;  ///< ascending
  Vec3d normal;
};

/// Sides that two triangles of different planes share.
std::vector<ConvexHull::Edge> edgesOf(std::vector<Side> sides) {
  constexpr double kSamePlane = 1e-10;  // sine of the angle
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& a, const Side& b) { return a.ends < b.ends; });
  std::vector<ConvexHull::Edge> edges;
  for (size_t i = 1; i < sides.size(); ++i) {
    const Side &a = sides[i - 1], &b = sides[i];
    if (a.ends == b.ends && a.normal.cross(b.normal).length() > kSamePlane)
      edges.push_back({a.ends, {a.normal, b.normal}});
  }
  return edges;
}

/// The least width among the directions between the normals of an edge's facets. Vertices whose
/// depths differ by no more than `tie` are as deep.
double leastWidthAbout(const ConvexHull& hull, const ConvexHull::Edge& edge, double tie) {
  const Vec3d at = hull.vertices[edge.ends[0]];
  Vec3d out = edge.normals[0];  // out of the hull; the edge lies in the plane across it
  Vec3d ahead = edge.normals[1] - edge.normals[1].dot(out) * out;
  ahead.normalize();
  double left = std::atan2(edge.normals[1].dot(ahead), edge.normals[1].dot(out));  // to be turned
  double least = std::numeric_limits<double>::max();
  // Each turn but the last brings another vertex to the plane on the far side.
  while (true) {
    // The vertex on the far plane; of several the one that stays on it.
    double depth = 0, side = std::numeric_limits<double>::max();
    for (const Vec3d& vertex : hull.vertices) depth = std::min(depth, out.dot(vertex - at));
    least = std::min(least, -depth);
    if (left <= 0) return least;
    for (const Vec3d& vertex : hull.vertices)
      if (out.dot(vertex - at) <= depth + tie) side = std::min(side, ahead.dot(vertex - at));
    double angle = std::min(left, M_PI / 2);
    for (const Vec3d& vertex : hull.vertices) {
      const double u = out.dot(vertex - at) - depth, s = ahead.dot(vertex - at) - side;
      if (s < 0) angle = std::min(angle, std::atan2(u, -s));
    }
    left -= angle;
    const Vec3d turned = std::cos(angle) * out + std::sin(angle) * ahead;
    ahead = std::cos(angle) * ahead - std::sin(angle) * out;
    out = turned;
  }
}

}  // namespace

ConvexHull convexHull(const std::vector<Vec3d>& points) {
  std::vector<double> coordinates;
  coordinates.reserve(3 * points.size());
  for (const Vec3d& point : points)
    coordinates.insert(coordinates.end(), {point[0], point[1], point[2]});
  const QhullRun run(coordinates);

  ConvexHull hull;
  std::vector<uint32_t> numbers;  // by qhull's own
  for (const vertexT* vertex = run.firstVertex(); vertex->next; vertex = vertex->next) {
    if (vertex->id >= numbers.size()) numbers.resize(vertex->id + 1);
    numbers[vertex->id] = uint32_t(hull.vertices.size());
    hull.vertices.emplace_back(vertex->point[0], vertex->point[1], vertex->point[2]);
  }
  Vec3d middle(0);
  for (const Vec3d& vertex : hull.vertices) middle += vertex / double(hull.vertices.size());
  std::vector<Side> sides;
  for (const facetT* facet = run.firstFacet(); facet->next; facet = facet->next) {
    std::array<uint32_t, 3> corners;
    const auto ofFacet = cornersOf(*facet);
    for (size_t i = 0; i < 3; ++i) corners[i] = numbers[ofFacet[i]->id];
    const Vec3d normal(facet->normal[0], facet->normal[1], facet->normal[2]);
    for (size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(corners[i], corners[(i + 1) % 3]);
      sides.push_back({{low, high}, normal});
    }
    const Vec3d a = hull.vertices[corners[0]] - middle, b = hull.vertices[corners[1]] - middle,
                c = hull.vertices[corners[2]] - middle;
    hull.volume += std::abs(a.dot(b.cross(c))) / 6;
    hull.area += (b - a).cross(c - a).length() / 2;
  }
  hull.edges = edgesOf(std::move(sides));
  return hull;
}

double diameter(const ConvexHull& hull) {
  double largest = 0;
  for (size_t i = 0; i < hull.vertices.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      largest = std::max(largest, (hull.vertices[i] - hull.vertices[j]).lengthSqr());
  return std::sqrt(largest);
}

double leastWidth(const ConvexHull& hull) {
  constexpr double kRounding = 1e-12;  // of the size
  double size = 0, least = std::numeric_limits<double>::max();
  for (const Vec3d& vertex : hull.vertices)
    size = std::max(size, (vertex - hull.vertices.front()).length());
  for (const ConvexHull::Edge& edge : hull.edges)
    least = std::min(least, leastWidthAbout(hull, edge, kRounding * size));
  return least;
}

}  // namespace vdb_madf::detail
