// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/random_volume.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vdb_madf::test {

namespace {

void fillBox(ObjectVolume& object, CoordBBox part, uint8_t value = 1) {
  part.intersect(object.box());
  if (part.empty()) return;
  for (auto p = part.begin(); p; ++p) object[*p] = value;
}

/// Centers need not be voxels: `center` is in voxels from the corner of the box.
struct Ball {
  std::array<double, 3> center;
  double radius;
};

double distanceTo(const Ball& ball, const Coord& offset) {
  double squared = 0;
  for (size_t a = 0; a < 3; ++a) {
    const double d = offset[a] - ball.center[a];
    squared += d * d;
  }
  return std::sqrt(squared);
}

void fillBall(ObjectVolume& object, const Ball& ball, uint8_t value = 1) {
  for (int i = 0; i < object.size(); ++i)
    if (distanceTo(ball, object.coord(i) - object.box().min()) <= ball.radius) object[i] = value;
}

int longestSide(const ObjectVolume& object) {
  const Coord dim = object.box().dim();
  return std::max({dim.x(), dim.y(), dim.z()});
}

Coord randomVoxel(const CoordBBox& box, Rng& rng) {
  return {rng.between(box.min().x(), box.max().x()), rng.between(box.min().y(), box.max().y()),
          rng.between(box.min().z(), box.max().z())};
}

CoordBBox randomPart(const CoordBBox& box, Rng& rng) {
  CoordBBox part;
  part.expand(randomVoxel(box, rng));
  part.expand(randomVoxel(box, rng));
  return part;
}

/// Half of the balls are centered on a voxel: symmetric, with many ties.
Ball randomBall(const ObjectVolume& object, double least, double most, Rng& rng) {
  Ball ball{};
  const bool onVoxel = rng.chance(0.5);
  const Coord dim = object.box().dim();
  for (size_t a = 0; a < 3; ++a)
    ball.center[a] = onVoxel ? rng.below(dim[a]) : rng.unit() * (dim[a] - 1);
  ball.radius = least + rng.unit() * std::max(0.0, most - least);
  return ball;
}

void noise(ObjectVolume& object, double fraction, Rng& rng) {
  for (int i = 0; i < object.size(); ++i) object[i] = rng.chance(fraction);
}

void balls(ObjectVolume& object, bool rough, Rng& rng) {
  const double most = std::max(1.5, longestSide(object) / 2.5);
  const double amplitude = rough ? 0.5 + 2 * rng.unit() : 0;
  for (int n = rng.between(1, 8); n > 0; --n) {
    const Ball ball = randomBall(object, 1, most, rng);
    for (int i = 0; i < object.size(); ++i) {
      const double wobble = rough ? amplitude * (rng.unit() - 0.5) : 0;
      if (distanceTo(ball, object.coord(i) - object.box().min()) + wobble <= ball.radius)
        object[i] = 1;
    }
  }
}

void blurredNoise(ObjectVolume& object, Rng& rng) {
  DenseVolume<double> field(object.box());
  for (int i = 0; i < field.size(); ++i) field[i] = rng.unit();
  const int width = rng.between(1, std::max(1, std::min(3, longestSide(object) / 6)));
  for (int pass = 0; pass < 2; ++pass)
    for (int axis = 0; axis < 3; ++axis) {
      const DenseVolume<double> before = field;
      for (int i = 0; i < field.size(); ++i) {
        double sum = 0;
        int count = 0;
        for (int d = -width; d <= width; ++d) {
          Coord q = field.coord(i);
          q[axis] += d;
          if (!before.contains(q)) continue;
          sum += before[q];
          ++count;
        }
        field[i] = sum / count;
      }
    }
  std::vector<double> sorted;
  for (int i = 0; i < field.size(); ++i) sorted.push_back(field[i]);
  std::sort(sorted.begin(), sorted.end());
  const double fraction = 0.2 + 0.7 * rng.unit();
  const double threshold = sorted[size_t((1 - fraction) * double(sorted.size() - 1))];
  for (int i = 0; i < field.size(); ++i) object[i] = field[i] >= threshold;
}

void twoEqualMaxima(ObjectVolume& object, Rng& rng) {
  const Coord dim = object.box().dim();
  const int axis = dim.maxIndex();
  Ball first{}, second{};
  for (size_t a = 0; a < 3; ++a) first.center[a] = second.center[a] = (dim[a] - 1) / 2;
  const int apart = rng.below(dim[axis]);
  first.center[size_t(axis)] = (dim[axis] - 1 - apart) / 2;
  second.center[size_t(axis)] = first.center[size_t(axis)] + apart;
  first.radius = second.radius = apart / 2.0 + rng.between(-1, 2);
  fillBall(object, first);
  fillBall(object, second);
}

void wholeLeaves(ObjectVolume& object, Rng& rng) {
  const double fraction = 0.3 + 0.7 * rng.unit();
  const CoordBBox box = object.box();
  for (int x = box.min().x() & ~7; x <= box.max().x(); x += 8)
    for (int y = box.min().y() & ~7; y <= box.max().y(); y += 8)
      for (int z = box.min().z() & ~7; z <= box.max().z(); z += 8)
        if (rng.chance(fraction)) fillBox(object, boxAt(Coord(x, y, z), Coord(8)));
  if (rng.chance(0.3)) object[rng.below(object.size())] ^= 1;
}

/// A gap of one or two voxels across the longest axis through something connected.
void twoComponents(ObjectVolume& object, Rng& rng) {
  if (rng.chance(0.5))
    fillBox(object, object.box());
  else
    balls(object, false, rng);
  const CoordBBox box = object.box();
  const int axis = box.dim().maxIndex();
  CoordBBox gap = box;
  gap.min()[axis] = rng.between(box.min()[axis], box.max()[axis]);
  gap.max()[axis] = gap.min()[axis] + rng.below(2);
  fillBox(object, gap, 0);
}

void thinRods(ObjectVolume& object, Rng& rng) {
  for (int n = rng.between(1, 8); n > 0; --n) {
    CoordBBox rod = randomPart(object.box(), rng);
    const int along = rng.below(3);
    for (int axis = 0; axis < 3; ++axis)
      if (axis != along) rod.max()[axis] = rod.min()[axis] + rng.below(2);
    fillBox(object, rod);
  }
}

void comb(ObjectVolume& object, Rng& rng) {
  const int along = rng.below(3), across = (along + rng.between(1, 2)) % 3;
  const int period = rng.between(2, 6), tooth = rng.between(1, period - 1);
  const int back = rng.between(1, 3);
  for (int i = 0; i < object.size(); ++i) {
    const Coord d = object.coord(i) - object.box().min();
    object[i] = d[across] < back || d[along] % period < tooth;
  }
}

/// Single background voxels, and walks of some steps.
void pinholes(ObjectVolume& object, Rng& rng) {
  if (rng.chance(0.3))
    fillBox(object, object.box());
  else
    balls(object, rng.chance(0.3), rng);
  const int holes = 1 + rng.below(1 + object.size() / (rng.chance(0.5) ? 300 : 40));
  for (int n = 0; n < holes; ++n) {
    Coord p = object.coord(rng.below(object.size()));
    for (int steps = rng.chance(0.5) ? 1 : rng.between(1, 40); steps > 0; --steps) {
      if (object.contains(p)) object[p] = 0;
      p += kSixNeighbors[size_t(rng.below(6))];
    }
  }
}

void hollowShell(ObjectVolume& object, Rng& rng) {
  const int wall = rng.between(1, 4);
  if (rng.chance(0.5)) {
    fillBox(object, object.box());
    CoordBBox cavity = object.box();
    cavity.expand(-wall);
    if (!cavity.empty()) fillBox(object, cavity, 0);
  } else {
    Ball ball = randomBall(object, 2, longestSide(object) / 1.5, rng);
    fillBall(object, ball);
    ball.radius -= wall;
    fillBall(object, ball, 0);
  }
}

}  // namespace

uint64_t Rng::next() {
  uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

int Rng::below(int end) {
  return int(next() % uint64_t(end));
}

double Rng::unit() {
  return double(next() >> 11) * 0x1p-53;
}

std::string name(VolumeKind kind) {
  static const std::array<const char*, kVolumeKinds> kNames = {
      "empty",          "one voxel",       "full block",       "all but one voxel",
      "touching faces", "one-voxel sheet", "two equal maxima", "whole leaves",
      "two components", "sparse noise",    "dense noise",      "ball union",
      "blurred noise",  "rough balls",     "box union",        "thin rods",
      "comb",           "hollow shell",    "pinholes",         "checkerboard"};
  return kNames[size_t(kind)];
}

ObjectVolume randomVolume(VolumeKind kind, const CoordBBox& box, Rng& rng) {
  ObjectVolume object(box);
  switch (kind) {
    case VolumeKind::empty:
    case VolumeKind::count_:
      break;
    case VolumeKind::oneVoxel:
      object[randomVoxel(box, rng)] = 1;
      break;
    case VolumeKind::fullBlock:
      fillBox(object, box);
      break;
    case VolumeKind::allButOneVoxel:
      fillBox(object, box);
      object[randomVoxel(box, rng)] = 0;
      break;
    case VolumeKind::touchingFaces:
      fillBall(object, randomBall(object, longestSide(object) / 3.0, longestSide(object), rng));
      break;
    case VolumeKind::oneVoxelSheet: {
      CoordBBox sheet = box;
      const int axis = rng.below(3);
      sheet.min()[axis] = sheet.max()[axis] = rng.between(box.min()[axis], box.max()[axis]);
      fillBox(object, sheet);
      break;
    }
    case VolumeKind::twoEqualMaxima:
      twoEqualMaxima(object, rng);
      break;
    case VolumeKind::wholeLeaves:
      wholeLeaves(object, rng);
      break;
    case VolumeKind::twoComponents:
      twoComponents(object, rng);
      break;
    case VolumeKind::sparseNoise:
      noise(object, 0.01 + 0.19 * rng.unit(), rng);
      break;
    case VolumeKind::denseNoise:
      noise(object, 0.4 + 0.58 * rng.unit(), rng);
      break;
    case VolumeKind::ballUnion:
      balls(object, false, rng);
      break;
    case VolumeKind::blurredNoise:
      blurredNoise(object, rng);
      break;
    case VolumeKind::roughBalls:
      balls(object, true, rng);
      break;
    case VolumeKind::boxUnion:
      for (int n = rng.between(1, 5); n > 0; --n) fillBox(object, randomPart(box, rng));
      break;
    case VolumeKind::thinRods:
      thinRods(object, rng);
      break;
    case VolumeKind::comb:
      comb(object, rng);
      break;
    case VolumeKind::hollowShell:
      hollowShell(object, rng);
      break;
    case VolumeKind::pinholes:
      pinholes(object, rng);
      break;
    case VolumeKind::checkerboard:
      for (int i = 0; i < object.size(); ++i) {
        const Coord p = object.coord(i);
        object[i] = ((p.x() + p.y() + p.z()) & 1) == 0;
      }
      break;
  }
  return object;
}

Coord randomOrigin(Rng& rng) {
  Coord origin;
  const int kind = rng.below(4);
  for (int axis = 0; axis < 3; ++axis) {
    const int near = rng.between(-20, 20);
    switch (kind) {
      case 0:  // at 0, where images lie
        break;
      case 1:  // across leaf borders and the sign
        origin[axis] = near;
        break;
      case 2:  // across the borders of internal nodes (128 and 4096 voxels)
        origin[axis] = (rng.chance(0.5) ? 128 : 4096) * rng.between(-2, 2) + near;
        break;
      default:  // far out, where float coordinates would fail
        origin[axis] = (rng.chance(0.5) ? 1 : -1) * (100000000 + rng.below(1000)) + near;
    }
  }
  return origin;
}

Coord randomSize(Rng& rng) {
  static const std::array<int, 10> kLongest = {2, 4, 6, 8, 10, 12, 16, 20, 24, 32};
  const int longest = kLongest[size_t(rng.below(int(kLongest.size())))];
  return {rng.between(1, longest), rng.between(1, longest), rng.between(1, longest)};
}

std::optional<CoordBBox> randomDomain(const ObjectVolume& object, Rng& rng) {
  const CoordBBox tight = objectBox(object);
  CoordBBox domain = object.box();
  switch (rng.below(4)) {
    case 0:
      return std::nullopt;
    case 1:
      if (!tight.empty()) domain = tight;
      break;
    case 2:
      break;
    default:
      for (int axis = 0; axis < 3; ++axis) {
        domain.min()[axis] -= rng.below(4);
        domain.max()[axis] += rng.below(4);
      }
  }
  return domain;
}

}  // namespace vdb_madf::test
