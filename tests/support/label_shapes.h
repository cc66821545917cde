// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "vdb_madf/grids/grid_types.h"

/// Label grids for what is made of labels, and what is true of their voxels by counting.
namespace vdb_madf::test {

inline CoordBBox cube(int edge, const Coord& origin = Coord(0)) {
  return CoordBBox::createCube(origin, edge);
}

using LabelMap = std::map<Coord, int32_t>;

inline Int32Grid::Ptr labelGrid(const LabelMap& voxels) {
  const auto grid = Int32Grid::create(0);
  grid->setName("grain");
  for (const auto& [p, label] : voxels) grid->tree().setValueOn(p, label);
  return grid;
}

inline LabelMap randomLabels(unsigned seed, const Coord& origin, int side, int labels,
                             int percentFilled) {
  std::mt19937 random(seed);
  LabelMap voxels;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        if (int(random() % 100) < percentFilled)
          voxels[origin + Coord(x, y, z)] = 1 + int32_t(random() % unsigned(labels));
  return voxels;
}

/// Two balls that share a flat interface, labels 3 and 7.
inline LabelMap twoBalls(const Coord& center, int radius) {
  LabelMap voxels;
  const int apart = radius * 3 / 2;
  for (int x = -radius; x <= apart + radius; ++x)
    for (int y = -radius; y <= radius; ++y)
      for (int z = -radius; z <= radius; ++z) {
        const int rest = y * y + z * z, first = x * x + rest,
                  second = (x - apart) * (x - apart) + rest;
        if (std::min(first, second) < radius * radius)
          voxels[center + Coord(x, y, z)] = first <= second ? 3 : 7;
      }
  return voxels;
}

/// Labels without any symmetry, on both sides of the origin; 70000 needs more than 16 bits.
inline LabelMap marker() {
  return {{{2, 3, 5}, 1},  {{-7, 1, 2}, 2},     {{-6, 1, 2}, 2},
          {{-7, 2, 2}, 2}, {{-6, 2, 2}, 2},     {{-7, 1, 3}, 3},
          {{-6, 1, 3}, 3}, {{0, -8, 7}, 70000}, {{1, -8, 7}, 70000}};
}

/// Voxels that touch along edges and at corners only, a ring, a hollow box, sheets; labels 1 to 6.
inline LabelMap awkwardLabels() {
  LabelMap voxels;
  voxels[{-1, -1, -1}] = 1;  // across a leaf border in all axes, at a corner only
  voxels[{0, 0, 0}] = 1;
  voxels[{0, 0, 2}] = 2;  // along an edge only
  voxels[{0, 1, 3}] = 2;
  for (int x = 10; x < 15; ++x)
    for (int y = 10; y < 15; ++y)
      if (x == 10 || x == 14 || y == 10 || y == 14) voxels[{x, y, 7}] = 3;  // a ring
  for (int x = -12; x < -5; ++x)
    for (int y = 2; y < 9; ++y)
      for (int z = 2; z < 9; ++z)  // a hollow box with a loose voxel in it
        if (x == -12 || x == -6 || y == 2 || y == 8 || z == 2 || z == 8) voxels[{x, y, z}] = 4;
  voxels[{-9, 5, 5}] = 4;
  for (int x = 20; x < 30; ++x)
    for (int y = 20; y < 30; ++y) {  // two sheets on each other
      voxels[{x, y, 15}] = 5;
      voxels[{x, y, 16}] = 6;
    }
  return voxels;
}

/// Voxels of each label.
inline std::map<int32_t, int64_t> volumes(const LabelMap& voxels) {
  std::map<int32_t, int64_t> result;
  for (const auto& [p, label] : voxels) ++result[label];
  return result;
}

/// Euler number of the voxels of each label, joined through faces only: voxels, less pairs across
/// faces, plus full squares of 2x2, less full cubes of 2x2x2. Two voxels that lack in a cube of
/// 2x2x2, opposite each other, do not meet in its middle: the ring of the other six is filled.
inline std::map<int32_t, int64_t> eulerNumbers(const LabelMap& voxels) {
  std::map<int32_t, int64_t> result;
  for (const auto& [p, label] : voxels) {
    const Coord first = p;
    const int32_t wanted = label;
    const auto has = [&](int dx, int dy, int dz) {
      const auto found = voxels.find(first.offsetBy(dx, dy, dz));
      return int64_t(found != voxels.end() && found->second == wanted);
    };
    const int64_t x = has(1, 0, 0), y = has(0, 1, 0), z = has(0, 0, 1), xy = has(1, 1, 0),
                  xz = has(1, 0, 1), yz = has(0, 1, 1), xyz = has(1, 1, 1);
    result[label] +=
        1 - x - y - z + x * y * xy + x * z * xz + y * z * yz - x * y * z * xy * xz * yz * xyz;
  }
  std::map<std::pair<Coord, int32_t>, std::set<int>> cubes;  // by lowest voxel and label
  for (const auto& [p, label] : voxels)
    for (int n = 0; n < 8; ++n)
      cubes[{p.offsetBy(-(n >> 2), -(n >> 1 & 1), -(n & 1)), label}].insert(n);
  for (const auto& [cube, present] : cubes)
    for (int n = 0; n < 4; ++n)
      if (present.size() == 6 && !present.count(n) && !present.count(7 - n)) ++result[cube.second];
  return result;
}

}  // namespace vdb_madf::test
