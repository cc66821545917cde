// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/corner_fans.h"

namespace vdb_madf::detail {

namespace {

constexpr int kShift[3] = {2, 1, 0};

int voxelAt(int axis, int da, int du, int dv) {
  return da << kShift[axis] | du << kShift[(axis + 1) % 3] | dv << kShift[(axis + 2) % 3];
}

std::array<uint8_t, 12> joinFaces(int set) {
  std::array<uint8_t, 12> root;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 4; ++side) {
      const bool below = set >> voxelAt(axis, 0, side >> 1, side & 1) & 1;
      const bool above = set >> voxelAt(axis, 1, side >> 1, side & 1) & 1;
      const int face = axis * 4 + side;
      root[size_t(face)] = below != above ? uint8_t(face) : uint8_t(0xff);
    }
  const auto join = [&root](int a, int b) {
    const uint8_t low = std::min(root[size_t(a)], root[size_t(b)]);
    const uint8_t high = std::max(root[size_t(a)], root[size_t(b)]);
    for (uint8_t& r : root)
      if (r == high) r = low;
  };
  // Each of the six edges that end in the corner has four voxels and four possible faces around it.
  for (int axis = 0; axis < 3; ++axis)
    for (int end = 0; end < 2; ++end) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      // Faces across u are indexed by (d_v, d_axis), faces across v by (d_axis, d_u).
      const auto acrossU = [&](int dv) { return u * 4 + dv * 2 + end; };
      const auto acrossV = [&](int du) { return v * 4 + end * 2 + du; };
      int faces[4], count = 0;
      for (const int face : {acrossU(0), acrossU(1), acrossV(0), acrossV(1)})
        if (root[size_t(face)] != 0xff) faces[count++] = face;
      if (count == 2) join(faces[0], faces[1]);
      if (count < 4) continue;
      // Two voxels that touch along the edge only: each keeps its two faces together.
      for (int du = 0; du < 2; ++du)
        for (int dv = 0; dv < 2; ++dv)
          if (set >> voxelAt(axis, end, du, dv) & 1) join(acrossU(dv), acrossV(du));
    }
  return root;
}

}  // namespace

const Fans& fans() {
  static const Fans table = [] {
    Fans result;
    for (int set = 0; set < 256; ++set) {
      const std::array<uint8_t, 12> root = joinFaces(set);
      std::array<uint8_t, 12> number;
      number.fill(0xff);
      uint8_t count = 0;
      for (size_t face = 0; face < 12; ++face)
        if (root[face] == face) number[face] = count++;
      for (size_t face = 0; face < 12; ++face)
        result.fan[size_t(set)][face] = root[face] == 0xff ? 0xff : number[root[face]];
      result.count[size_t(set)] = count;
    }
    return result;
  }();
  return table;
}

void Corner::setVoxels(const std::array<int32_t, 8>& voxel) {
  const int32_t largest = *std::max_element(voxel.begin(), voxel.end());
  if (std::all_of(voxel.begin(), voxel.end(),
                  [&](int32_t here) { return here == 0 || here == largest; })) {
    grains = 1;  // mostly
    labels = 2;
    label[0] = largest;
    for (int n = 0; n < 8; ++n) set[0] = uint8_t(set[0] | int(voxel[size_t(n)] == largest) << n);
    pointCount = fans().count[set[0]];
    return;
  }
  bool hasBackground = false;
  for (const int32_t here : voxel) {
    hasBackground = hasBackground || here == 0;
    int place = 0;
    while (place < grains && label[size_t(place)] < here) ++place;
    if (here == 0 || (place < grains && label[size_t(place)] == here)) continue;
    for (int g = grains++; g > place; --g) label[size_t(g)] = label[size_t(g - 1)];
    label[size_t(place)] = here;
  }
  labels = grains + hasBackground;
  for (int g = 0; g < grains; ++g) {
    int bits = 0;
    for (int n = 0; n < 8; ++n) bits |= int(voxel[size_t(n)] == label[size_t(g)]) << n;
    set[size_t(g)] = uint8_t(bits);
    pointCount += fans().count[size_t(bits)];
  }
}

uint32_t Corner::point(int32_t grain, int face) const {
  uint32_t before = 0;
  size_t g = 0;
  for (; label[g] != grain; ++g) before += fans().count[set[g]];
  return before + fans().fan[set[g]][size_t(face)];
}

}  // namespace vdb_madf::detail
