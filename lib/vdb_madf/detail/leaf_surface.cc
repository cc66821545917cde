// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/detail/leaf_surface.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "vdb_madf/detail/simd.h"

namespace vdb_madf::detail {

namespace {

// Twice the radii in which faces make a normal. Chosen on planes, spheres and discs: a free surface
// is curved, and 2.5 voxels are enough; interfaces are flat but for their rims.
constexpr int kFreeReach = 5;    // 2.5 voxels
constexpr int kSharedReach = 8;  // 4 voxels

/// Up to this many groups a search beats a hash table.
constexpr size_t kFewGroups = 8;

/// Faces that are summed together; a row of the window has not more than 32.
constexpr size_t kTogether = 16;
constexpr size_t kRoom = 32 + kTogether;

/// Twice the coordinate of a face out of everyone's reach, whose square fits in 16 bits.
constexpr int16_t kFarAway = 100;

/// Sum of the weighted normals of `blocks` times kTogether faces around a target. With a normal in
/// the target, faces of opposite direction are left out. In 16 bits: coordinates differ by 32 at
/// most but for kFarAway; a sum is over the faces of one axis in reach, fewer than 300, of weight
/// 64 at most.
VDB_MADF_SIMD void sumNormals(const int16_t* x, const int16_t* y, const int16_t* z,
                              const int16_t* nx, const int16_t* ny, const int16_t* nz,
                              size_t blocks, const int16_t* target, int reach, int16_t* sum) {
  const int16_t tx = target[0], ty = target[1], tz = target[2];
  const int16_t tnx = target[3], tny = target[4], tnz = target[5];
  const auto squaredReach = int16_t(reach * reach);
  int16_t sx[kTogether] = {}, sy[kTogether] = {}, sz[kTogether] = {};
  for (size_t first = 0; first < blocks * kTogether; first += kTogether) {
    for (size_t lane = 0; lane < kTogether; ++lane) {
      const size_t i = first + lane;
      const auto dx = int16_t(x[i] - tx), dy = int16_t(y[i] - ty), dz = int16_t(z[i] - tz);
      const auto rest = int16_t(squaredReach - dx * dx - dy * dy - dz * dz);
      const auto along = int16_t(nx[i] * tnx + ny[i] * tny + nz[i] * tnz);
      const int16_t near = rest > 0 ? rest : int16_t(0);
      const int16_t weight = along >= 0 ? near : int16_t(0);
      sx[lane] = int16_t(sx[lane] + weight * nx[i]);
      sy[lane] = int16_t(sy[lane] + weight * ny[i]);
      sz[lane] = int16_t(sz[lane] + weight * nz[i]);
    }
  }
  int16_t s[3] = {};
  for (size_t lane = 0; lane < kTogether; ++lane) {
    s[0] = int16_t(s[0] + sx[lane]);
    s[1] = int16_t(s[1] + sy[lane]);
    s[2] = int16_t(s[2] + sz[lane]);
  }
  for (int i = 0; i < 3; ++i) sum[i] = s[i];
}

uint64_t load(const LabelWindow::Code* codes) {
  uint64_t word;
  std::memcpy(&word, codes, sizeof word);
  return word;
}

}  // namespace

LeafSurface::Group& LeafSurface::group(Code first, Code second) {
  if (const Group* found = findGroup(first, second)) return const_cast<Group&>(*found);
  if (groupCount_ == groups_.size()) groups_.emplace_back();
  Group& added = groups_[groupCount_++];
  added.first = first;
  added.second = second;
  added.count = 0;
  added.owned.clear();
  if (groupCount_ > kFewGroups) {
    const size_t from = groupOf_.empty() ? 0 : groupCount_ - 1;
    for (size_t i = from; i < groupCount_; ++i)
      groupOf_[uint32_t(groups_[i].first) << 16 | groups_[i].second] = uint32_t(i);
  }
  return added;
}

const LeafSurface::Group* LeafSurface::findGroup(Code first, Code second) const {
  if (groupCount_ > kFewGroups) {
    const auto found = groupOf_.find(uint32_t(first) << 16 | second);
    return found == groupOf_.end() ? nullptr : &groups_[found->second];
  }
  for (size_t i = 0; i < groupCount_; ++i)
    if (groups_[i].first == first && groups_[i].second == second) return &groups_[i];
  return nullptr;
}

/// Bit z + 8: voxel (x, y, z) lies in the domain.
uint32_t LeafSurface::insideDomain(int x, int y) const {
  const CoordBBox& box = *domain_;
  const Coord at = origin_.offsetBy(x, y, 0);
  if (!box.isInside(Coord(at.x(), at.y(), box.min().z()))) return 0;
  const int64_t first = std::max<int64_t>(int64_t(box.min().z()) - at.z() + 8, 0),
                last = std::min<int64_t>(int64_t(box.max().z()) - at.z() + 8, 31);
  return first <= last ? (2u << last) - (1u << first) : 0;
}

/// Bit z + 8: between voxel (x, y, z), of code `lower`, and the next one along the axis.
void LeafSurface::addFaces(int axis, int x, int y, uint32_t bits, Code lower, Code upper) {
  // The first partner: the grain, or of two grains the one of smaller label.
  const bool lowerIsFirst =
      upper == 0 || (lower != 0 && window_.label(lower) < window_.label(upper));
  const Code first = lowerIsFirst ? lower : upper, second = lowerIsFirst ? upper : lower;
  const bool atUpper = second == 0 && !lowerIsFirst;  // the owner is the upper voxel
  const bool rowOwned =
      ((x + (atUpper && axis == 0)) & ~7) == 0 && ((y + (atUpper && axis == 1)) & ~7) == 0;
  const uint32_t owned = rowOwned ? 0xff00u >> (atUpper && axis == 2) : 0;
  if (atBorder_ && second == 0) {
    const uint32_t inside = atUpper ? insideDomain(x, y)
                                    : insideDomain(x + (axis == 0), y + (axis == 1)) >> (axis == 2);
    if (const uint32_t cut = bits & ~inside & owned)
      free_[window_.label(first)].cutFaces += countBits(cut);
    bits &= inside;
    if (!bits) return;
  }
  Group& to = group(first, second);
  if (to.count + kRoom > to.faces[kX].size())
    for (auto& component : to.faces) component.resize(2 * to.count + 2 * kRoom);
  const auto sign = int16_t(lowerIsFirst ? 1 : -1);
  for (; bits; bits &= bits - 1) {
    const int bit = __builtin_ctz(bits);
    const size_t i = to.count++;
    to.faces[kX][i] = int16_t(2 * x + (axis == 0));
    to.faces[kY][i] = int16_t(2 * y + (axis == 1));
    to.faces[kZ][i] = int16_t(2 * (bit - 8) + (axis == 2));
    to.faces[kNormalX][i] = axis == 0 ? sign : int16_t(0);
    to.faces[kNormalY][i] = axis == 1 ? sign : int16_t(0);
    to.faces[kNormalZ][i] = axis == 2 ? sign : int16_t(0);
    if (owned >> bit & 1) to.owned.push_back(uint32_t(i));
  }
}

/// Of the row (x, y) and the next one along the axis; bit z + 8 of `within`: which z.
void LeafSurface::collectFaces(int axis, int x, int y, uint32_t within) {
  const int nextX = x + (axis == 0), nextY = y + (axis == 1), dz = axis == 2;
  const uint32_t a = window_.labelled(x, y), b = window_.labelled(nextX, nextY) >> dz;
  if (!((a | b) & within) || (window_.oneLabel() && !((a ^ b) & within))) return;
  if (window_.oneLabel()) {
    // Free faces of that label are all that may be this leaf's.
    if (const uint32_t faces = window_.same(x, y) & ~b & within) addFaces(axis, x, y, faces, 1, 0);
    if (const uint32_t faces = window_.same(nextX, nextY) >> dz & ~a & within)
      addFaces(axis, x, y, faces, 0, 1);
    return;
  }
  const Code lower = window_.rowCode(x, y), upper = window_.rowCode(nextX, nextY);
  if ((a & within && lower == LabelWindow::kMixed) ||
      (b & within && upper == LabelWindow::kMixed)) {
    uint32_t faces = a ^ b;
    if (a & b & within) {
      constexpr int kLanes = LabelWindow::kLanes;
      for (int z = LabelWindow::kBegin; z < LabelWindow::kEnd; z += kLanes) {
        const Code *low = window_.row(x, y, z), *high = window_.row(nextX, nextY, z + dz);
        if (load(low) == load(high)) continue;
        for (int i = 0; i < kLanes; ++i) faces |= uint32_t(low[i] != high[i]) << (z + i + 8);
      }
    }
    for (faces &= within; faces; faces &= faces - 1) {
      const int z = __builtin_ctz(faces) - 8;
      addFaces(axis, x, y, faces & (~faces + 1), *window_.row(x, y, z),
               *window_.row(nextX, nextY, z + dz));
    }
    return;
  }
  if (const uint32_t faces = a & ~b & within) addFaces(axis, x, y, faces, lower, 0);
  if (const uint32_t faces = b & ~a & within) addFaces(axis, x, y, faces, 0, upper);
  if (lower == upper) return;
  if (const uint32_t faces = a & b & within) addFaces(axis, x, y, faces, lower, upper);
}

/// What a target counts: the cosine between its normal and that of the surface.
int64_t LeafSurface::area(const Group& group, const Face& target, int reach, bool sameSide,
                          Near& near) const {
  const int16_t* const x = group.faces[kX].data();
  while (near.begin < group.count && x[near.begin] <= target[0] - reach) ++near.begin;
  while (near.end < group.count && x[near.end] < target[0] + reach) ++near.end;
  Face around = target;
  if (!sameSide) around[3] = around[4] = around[5] = 0;
  int16_t sum[3];
  // What a block has behind the end is out of reach.
  const size_t blocks = (near.end - near.begin + kTogether - 1) / kTogether;
  sumNormals(x + near.begin, group.faces[kY].data() + near.begin,
             group.faces[kZ].data() + near.begin, group.faces[kNormalX].data() + near.begin,
             group.faces[kNormalY].data() + near.begin, group.faces[kNormalZ].data() + near.begin,
             blocks, around.data(), reach, sum);
  const double nx = sum[0], ny = sum[1], nz = sum[2];
  const double along = nx * target[3] + ny * target[4] + nz * target[5];
  if (!(along > 0)) return 0;
  // Sums are small integers: the product is no fraction of 1, and this rounds it to the nearest.
  return int64_t(kAreaUnit * (along / std::sqrt(nx * nx + ny * ny + nz * nz)) + 0.5);
}

void LeafSurface::measureFree(const Group& group) {
  int64_t sum = 0;
  Near near;
  for (const uint32_t face : group.owned)
    sum += area(group, group.face(face), kFreeReach, true, near);
  if (sum) free_[window_.label(group.first)].area += sum;
}

/// Pairs of voxels of the two grains `separation` apart along an axis, the lower one in this leaf.
void LeafSurface::addPairs(int separation, Shared& shared, const Group& group) {
  int64_t& sum = shared.areas[separation == 2 ? 1 : 2];
  for (int axis = 0; axis < 3; ++axis) {
    const int dx = axis == 0 ? separation : 0, dy = axis == 1 ? separation : 0,
              dz = axis == 2 ? separation : 0;
    Near near;
    for (int x = 0; x < 8; ++x) {
      for (int y = 0; y < 8; ++y) {
        const Code code = window_.rowCode(x, y);
        if (code == window_.rowCode(x + dx, y + dy) && code != LabelWindow::kMixed) continue;
        const Code* lower = window_.row(x, y, 0);
        const Code* upper = window_.row(x + dx, y + dy, dz);
        if (load(lower) == load(upper) && load(lower + 4) == load(upper + 4)) continue;
        for (int z = 0; z < 8; ++z) {
          const bool forwards = lower[z] == group.first && upper[z] == group.second;
          if (!forwards && !(lower[z] == group.second && upper[z] == group.first)) continue;
          Face target = {int16_t(2 * x + dx), int16_t(2 * y + dy), int16_t(2 * z + dz), 0, 0, 0};
          target[size_t(kNormalX + axis)] = int16_t(forwards ? 1 : -1);
          sum += area(group, target, kSharedReach, false, near);
        }
      }
    }
  }
}

void LeafSurface::measureShared(const Group& group) {
  Shared shared;
  shared.first = window_.label(group.first);
  shared.second = window_.label(group.second);
  Near near;
  for (const uint32_t face : group.owned) {
    const Face target = group.face(face);
    shared.areas[0] += area(group, target, kSharedReach, false, near);
    InterfaceFace stored;
    for (int axis = 0; axis < 3; ++axis) {
      // Halves are rounded down: the lower voxel.
      stored.lower[axis] = origin_[axis] + (target[size_t(axis)] >> 1);
      if (target[size_t(kNormalX + axis)]) {
        stored.axis = int8_t(axis);
        stored.sign = int8_t(target[size_t(kNormalX + axis)]);
      }
    }
    shared.faces.push_back(stored);
  }
  addPairs(2, shared, group);
  addPairs(4, shared, group);
  if (!shared.faces.empty() || shared.areas[1] || shared.areas[2])
    shared_.push_back(std::move(shared));
}

void LeafSurface::measure(size_t leaf) {
  free_.clear();
  shared_.clear();
  if (labels_->isInterior(leaf)) return;
  groupCount_ = 0;
  groupOf_.clear();
  origin_ = labels_->index().origin(leaf);
  atBorder_ = domain_ && !domain_->isInside(CoordBBox(origin_.offsetBy(LabelWindow::kBegin),
                                                      origin_.offsetBy(LabelWindow::kEnd)));
  window_.load(leaf);
  // Lower voxels of the faces in reach of those that are measured, along their axis; along the
  // others one less. One label: only free faces, whose normals need less around them.
  const int begin = window_.oneLabel() ? -3 : LabelWindow::kBegin,
            last = window_.oneLabel() ? 9 : LabelWindow::kEnd - 2;
  const uint32_t along = (2u << (last + 8)) - (1u << (begin + 8)),
                 across = along & ~(1u << (begin + 8));
  for (int x = begin; x <= last; ++x) {
    if (x > begin) {
      for (int y = begin; y <= last; ++y) {
        collectFaces(1, x, y, across);
        if (y > begin) collectFaces(2, x, y, along);
      }
    }
    for (int y = begin + 1; y <= last; ++y) collectFaces(0, x, y, across);
  }
  for (size_t i = 0; i < groupCount_; ++i) {
    Group& group = groups_[i];
    std::fill_n(group.faces[kX].begin() + std::ptrdiff_t(group.count), kTogether, kFarAway);
    if (group.second == 0)
      measureFree(group);
    else
      measureShared(group);
  }
}

double bondArea(const std::array<int64_t, 3>& areas) {
  const double one = double(areas[0]) / kAreaUnit, two = double(areas[1]) / (2 * kAreaUnit),
               four = double(areas[2]) / (4 * kAreaUnit);
  return std::clamp(one + 0.5 * two - 0.5 * four, 0.25 * one, 1.1 * one);
}

}  // namespace vdb_madf::detail
