// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/detail/leaf_surface.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "vdb_madf/detail/simd.h"

namespace vdb_madf::detail {

namespace {

// Squares of twice the radius in which faces make a normal. Chosen on planes, spheres and discs: a
// free surface is curved, and 2.5 voxels are enough; interfaces are flat but for their rims.
constexpr int32_t kFreeReach = 25;    // 2.5 voxels
constexpr int32_t kSharedReach = 64;  // 4 voxels

/// Up to this many groups a search beats a hash table.
constexpr size_t kFewGroups = 8;

/// Sum of the weighted normals of the faces [begin, end) around a target. With a normal in the
/// target, faces of opposite direction are left out.
VDB_MADF_SIMD void sumNormals(const int32_t* x, const int32_t* y, const int32_t* z,
                              const int32_t* nx, const int32_t* ny, const int32_t* nz, size_t count,
                              const int32_t* target, int32_t squaredReach, int32_t* sum) {
  const int32_t tx = target[0], ty = target[1], tz = target[2];
  const int32_t tnx = target[3], tny = target[4], tnz = target[5];
  int32_t sx = 0, sy = 0, sz = 0;
  for (size_t i = 0; i < count; ++i) {
    const int32_t dx = x[i] - tx, dy = y[i] - ty, dz = z[i] - tz;
    const int32_t rest = squaredReach - dx * dx - dy * dy - dz * dz;
    const int32_t along = nx[i] * tnx + ny[i] * tny + nz[i] * tnz;
    const int32_t weight = rest > 0 && along >= 0 ? rest : 0;
    sx += weight * nx[i];
    sy += weight * ny[i];
    sz += weight * nz[i];
  }
  sum[0] = sx;
  sum[1] = sy;
  sum[2] = sz;
}

uint64_t load(const LabelWindow::Code* codes) {
  uint64_t word;
  std::memcpy(&word, codes, sizeof word);
  return word;
}

bool inLeaf(int x, int y, int z) {
  return ((x | y | z) & ~7) == 0;
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

void LeafSurface::addFace(int axis, int x, int y, int z, Code lower, Code upper) {
  // The first partner: the grain, or of two grains the one of smaller label.
  const bool lowerIsFirst =
      upper == 0 || (lower != 0 && window_.label(lower) < window_.label(upper));
  const Code first = lowerIsFirst ? lower : upper, second = lowerIsFirst ? upper : lower;
  const bool atUpper = second == 0 && !lowerIsFirst;  // the owner is the upper voxel
  const bool owned =
      atUpper ? inLeaf(x + (axis == 0), y + (axis == 1), z + (axis == 2)) : inLeaf(x, y, z);
  if (atBorder_ && second == 0) {
    Coord outer = origin_.offsetBy(x, y, z);
    if (lowerIsFirst) outer[axis] += 1;
    if (!domain_->isInside(outer)) {
      if (owned) ++free_[window_.label(first)].cutFaces;
      return;
    }
  }
  Group& to = group(first, second);
  const size_t i = to.count++;
  if (i == to.faces[kX].size())
    for (auto& component : to.faces) component.resize(2 * i + 64);
  if (owned) to.owned.push_back(uint32_t(i));
  const int32_t sign = lowerIsFirst ? 1 : -1;
  to.faces[kX][i] = 2 * x + (axis == 0);
  to.faces[kY][i] = 2 * y + (axis == 1);
  to.faces[kZ][i] = 2 * z + (axis == 2);
  to.faces[kNormalX][i] = axis == 0 ? sign : 0;
  to.faces[kNormalY][i] = axis == 1 ? sign : 0;
  to.faces[kNormalZ][i] = axis == 2 ? sign : 0;
}

/// Of the row (x, y) and the next one along the axis; bit z + 8 of `within`: which z.
void LeafSurface::collectFaces(int axis, int x, int y, uint32_t within) {
  const int nextX = x + (axis == 0), nextY = y + (axis == 1), dz = axis == 2;
  const uint32_t a = window_.labelled(x, y), b = window_.labelled(nextX, nextY) >> dz;
  uint32_t faces = a ^ b;
  if (!oneLabel_ && (a & b & within)) {
    constexpr int kLanes = LabelWindow::kLanes;
    for (int z = LabelWindow::kBegin; z < LabelWindow::kEnd; z += kLanes) {
      const Code *lower = window_.row(x, y, z), *upper = window_.row(nextX, nextY, z + dz);
      if (load(lower) == load(upper)) continue;
      for (int i = 0; i < kLanes; ++i) faces |= uint32_t(lower[i] != upper[i]) << (z + i + 8);
    }
  }
  for (faces &= within; faces; faces &= faces - 1) {
    const int z = __builtin_ctz(faces) - 8;
    addFace(axis, x, y, z, *window_.row(x, y, z), *window_.row(nextX, nextY, z + dz));
  }
}

double LeafSurface::cosine(const Group& group, const std::array<int32_t, 6>& target,
                           int32_t squaredReach, bool sameSide) const {
  const int32_t* const x = group.faces[kX].data();
  const auto reach = int32_t(std::sqrt(double(squaredReach)));
  const auto begin = size_t(std::lower_bound(x, x + group.count, target[0] - reach) - x);
  const auto end = size_t(std::upper_bound(x + begin, x + group.count, target[0] + reach) - x);
  std::array<int32_t, 6> around = target;
  if (!sameSide) around[3] = around[4] = around[5] = 0;
  int32_t sum[3];
  sumNormals(x + begin, group.faces[kY].data() + begin, group.faces[kZ].data() + begin,
             group.faces[kNormalX].data() + begin, group.faces[kNormalY].data() + begin,
             group.faces[kNormalZ].data() + begin, end - begin, around.data(), squaredReach, sum);
  const double nx = sum[0], ny = sum[1], nz = sum[2];
  const double length = std::sqrt(nx * nx + ny * ny + nz * nz);
  const double along = nx * target[3] + ny * target[4] + nz * target[5];
  return along > 0 ? along / length : 0.0;
}

void LeafSurface::measureFree(const Group& group) {
  int64_t area = 0;
  for (const uint32_t face : group.owned) {
    const std::array<int32_t, 6> target = group.face(face);
    area += std::llround(kAreaUnit * cosine(group, target, kFreeReach, true));
  }
  if (area) free_[window_.label(group.first)].area += area;
}

/// Pairs of voxels of the two grains `separation` apart along an axis, the lower one in this leaf.
void LeafSurface::addPairs(int separation, Shared& shared, const Group& group) {
  int64_t& area = shared.areas[separation == 2 ? 1 : 2];
  for (int axis = 0; axis < 3; ++axis) {
    const int dx = axis == 0 ? separation : 0, dy = axis == 1 ? separation : 0,
              dz = axis == 2 ? separation : 0;
    for (int x = 0; x < 8; ++x) {
      for (int y = 0; y < 8; ++y) {
        const Code* lower = window_.row(x, y, 0);
        const Code* upper = window_.row(x + dx, y + dy, dz);
        if (load(lower) == load(upper) && load(lower + 4) == load(upper + 4)) continue;
        for (int z = 0; z < 8; ++z) {
          const bool forwards = lower[z] == group.first && upper[z] == group.second;
          if (!forwards && !(lower[z] == group.second && upper[z] == group.first)) continue;
          std::array<int32_t, 6> target = {2 * x + dx, 2 * y + dy, 2 * z + dz, 0, 0, 0};
          target[size_t(kNormalX + axis)] = forwards ? 1 : -1;
          area += std::llround(kAreaUnit * cosine(group, target, kSharedReach, false));
        }
      }
    }
  }
}

void LeafSurface::measureShared(const Group& group) {
  Shared shared;
  shared.first = window_.label(group.first);
  shared.second = window_.label(group.second);
  for (const uint32_t face : group.owned) {
    const std::array<int32_t, 6> target = group.face(face);
    shared.areas[0] += std::llround(kAreaUnit * cosine(group, target, kSharedReach, false));
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
  // One label: only free faces, whose normals need less around them.
  oneLabel_ = window_.codeCount() == 2;
  const int begin = oneLabel_ ? -3 : LabelWindow::kBegin,
            last = oneLabel_ ? 10 : LabelWindow::kEnd - 1;
  const uint32_t all = (2u << (last + 8)) - (1u << (begin + 8));
  for (int x = begin; x <= last; ++x) {
    for (int y = begin; y <= last; ++y) {
      if (y < last) collectFaces(1, x, y, all);
      collectFaces(2, x, y, all >> 1 & all);
    }
    if (x < last)
      for (int y = begin; y <= last; ++y) collectFaces(0, x, y, all);
  }
  for (size_t i = 0; i < groupCount_; ++i) {
    if (groups_[i].second == 0)
      measureFree(groups_[i]);
    else
      measureShared(groups_[i]);
  }
}

double bondArea(const std::array<int64_t, 3>& areas) {
  const double one = double(areas[0]) / kAreaUnit, two = double(areas[1]) / (2 * kAreaUnit),
               four = double(areas[2]) / (4 * kAreaUnit);
  return std::clamp(one + 0.5 * two - 0.5 * four, 0.25 * one, 1.1 * one);
}

}  // namespace vdb_madf::detail
