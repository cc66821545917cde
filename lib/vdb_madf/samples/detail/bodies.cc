// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/bodies.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "vdb_madf/base/detail/bits.h"

namespace vdb_madf::detail {

namespace {

/// Points along each edge of a voxel, in the middles of equal parts.
constexpr int kPoints = 8;
constexpr float kAllPoints = kPoints * kPoints * kPoints;

/// Where point k lies in a voxel, in edges from its center.
constexpr double pointPlace(int k) {
  return (k + 0.5) / kPoints - 0.5;
}

/// Which points of a voxel lie in a body: word x, bit y*8 + z.
using Points = std::array<uint64_t, kPoints>;

/// How a body covers a voxel, as far as can be told from its center.
enum class Cover { none, part, all };

/// \p reach: of the voxel, from its center
Cover coverOf(const Ball& ball, const Vector& center, double reach) {
  const double square = (center - Vector(ball.x, ball.y, ball.z)).lengthSqr();
  const double inner = ball.radius - reach, outer = ball.radius + reach;
  if (square >= outer * outer) return Cover::none;
  return inner > 0 && square <= inner * inner ? Cover::all : Cover::part;
}

bool contains(const Ball& ball, const Vector& p) {
  return (p - Vector(ball.x, ball.y, ball.z)).lengthSqr() < ball.radius * ball.radius;
}

const Ball& partNear(const Ball& ball, const Vector&, double) {
  return ball;
}

CoordBBox voxelsNear(const Ball& ball, const Lattice& lattice) {
  return ballBox(ball, lattice);
}

Cover coverOf(const Particle& particle, const Vector& center, double reach) {
  const double value = particle.value(center), change = particle.slope() * reach;
  if (value - change >= 1) return Cover::none;
  return value + change < 1 ? Cover::all : Cover::part;
}

bool contains(const Particle& particle, const Vector& p) {
  return particle.value(p) < 1;
}

/// What of the particle decides on the points within reach of a place: most faces are far away.
Particle partNear(const Particle& particle, const Vector& place, double reach) {
  if (particle.form != Particle::Form::faces) return particle;
  Particle part = particle;
  const Vector from = place - particle.center;
  const auto isFar = [&](const Vector& row) { return row.dot(from) + row.length() * reach < 1; };
  part.rows.erase(std::remove_if(part.rows.begin(), part.rows.end(), isFar), part.rows.end());
  return part;
}

CoordBBox voxelsNear(const Particle& particle, const Lattice& lattice) {
  return lattice.voxelsIn(particle.box());
}

template <typename Body>
class BodyList : public Bodies {
 public:
  BodyList(const std::vector<Body>& bodies, const Lattice& lattice)
      : bodies_(bodies), lattice_(lattice), reach_(lattice.edges().length() / 2) {}

  FloatBox shares(const CoordBBox& box) const override {
    FloatBox result(box);
    std::vector<uint32_t> crossed(result.values.size());  // 0, or 1 + where its points are
    std::vector<Points> points;
    for (const Body& body : bodies_) {
      CoordBBox near = voxelsNear(body, lattice_);
      near.intersect(box);
      if (near.empty()) continue;
      for (auto p = near.begin(); p; ++p) {
        const size_t i = result.offset((*p).x(), (*p).y(), (*p).z());
        if (result.values[i] == 1) continue;
        const Vector center = lattice_.place(*p);
        const Cover cover = coverOf(body, center, reach_);
        if (cover == Cover::all) result.values[i] = 1;
        if (cover != Cover::part) continue;
        if (crossed[i] == 0) {
          points.push_back({});
          crossed[i] = uint32_t(points.size());
        }
        addPoints(partNear(body, center, reach_), center, points[crossed[i] - 1]);
      }
    }
    for (size_t i = 0; i < crossed.size(); ++i) {
      if (crossed[i] == 0 || result.values[i] == 1) continue;
      result.values[i] = float(countBitsIn(points[crossed[i] - 1])) / kAllPoints;
    }
    return result;
  }

 private:
  void addPoints(const Body& body, const Vector& center, Points& points) const {
    for (int x = 0; x < kPoints; ++x)
      for (int yz = 0; yz < kPoints * kPoints; ++yz) {
        const uint64_t bit = uint64_t(1) << yz;
        const Vector place(pointPlace(x), pointPlace(yz / kPoints), pointPlace(yz % kPoints));
        if (!(points[size_t(x)] & bit) && contains(body, center + place * lattice_.edges()))
          points[size_t(x)] |= bit;
      }
  }

  std::vector<Body> bodies_;
  Lattice lattice_;
  double reach_;
};

/// What a field is between the centers of 3 x 3 x 3 voxels, at the points of the middle one.
class LinearField {
 public:
  LinearField(const FloatBox& field, const Coord& middle) {
    float* value = values_;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          *value++ = field.values[field.offset(middle.x() + x, middle.y() + y, middle.z() + z)];
  }

  float share(float level) const {
    const auto [least, greatest] = std::minmax_element(values_, values_ + 27);
    if (*least >= level) return 1;
    if (*greatest < level) return 0;
    int inside = 0;
    float plane[9], row[3];
    for (int x = 0; x < kPoints; ++x) {
      along(values_, 9, x, plane);
      for (int y = 0; y < kPoints; ++y) {
        along(plane, 3, y, row);
        for (int z = 0; z < kPoints; ++z) {
          float value;
          along(row, 1, z, &value);
          inside += value >= level;
        }
      }
    }
    return float(inside) / kAllPoints;
  }

 private:
  /// Of three rows of `count` values one after the other the row at point k.
  static void along(const float* rows, int count, int k, float* out) {
    const int first = k < kPoints / 2 ? 0 : 1;
    const float weight = float(pointPlace(k) + 1 - first);
    const float *below = rows + first * count, *above = below + count;
    for (int i = 0; i < count; ++i) out[i] = below[i] + weight * (above[i] - below[i]);
  }

  float values_[27];
};

}  // namespace

std::shared_ptr<const Bodies> ballBodies(const std::vector<Ball>& balls, const Lattice& lattice) {
  return std::make_shared<BodyList<Ball>>(balls, lattice);
}

std::shared_ptr<const Bodies> particleBodies(const std::vector<Particle>& particles,
                                             const Lattice& lattice) {
  return std::make_shared<BodyList<Particle>>(particles, lattice);
}

FloatBox sharesAbove(const FloatBox& field, float level) {
  CoordBBox inner = field.box;
  inner.expand(-1);
  FloatBox result(inner);
  size_t i = 0;
  for (auto p = inner.begin(); p; ++p, ++i) result.values[i] = LinearField(field, *p).share(level);
  return result;
}

}  // namespace vdb_madf::detail
