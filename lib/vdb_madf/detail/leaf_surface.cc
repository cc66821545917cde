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
  for (auto& component : added.faces) component.clear();
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
  if (owned) to.owned.push_back(uint32_t(to.faces[kX].size()));
  const int32_t sign = lowerIsFirst ? 1 : -1;
  to.faces[kX].push_back(2 * x + (axis == 0));
  to.faces[kY].push_back(2 * y + (axis == 1));
  to.faces[kZ].push_back(2 * z + (axis == 2));
  for (int i = 0; i < 3; ++i) to.faces[size_t(kNormalX + i)].push_back(i == axis ? sign : 0);
}

void LeafSurface::collectFaces(int axis, int x, int y) {
  constexpr int kLanes = LabelWindow::kLanes;
  for (int z = LabelWindow::kBegin; z < LabelWindow::kEnd; z += kLanes) {
    const Code* lower = window_.row(x, y, z);
    const Code* upper = window_.row(x + (axis == 0), y + (axis == 1), z + (axis == 2));
    if (load(lower) == load(upper)) continue;
    const int lanes = std::min(kLanes, LabelWindow::kEnd - (axis == 2) - z);
    for (int i = 0; i < lanes; ++i)
      if (lower[i] != upper[i]) addFace(axis, x, y, z + i, lower[i], upper[i]);
  }
}

double LeafSurface::cosine(const Group& group, const std::array<int32_t, 6>& target,
                           int32_t squaredReach, bool sameSide) const {
  const std::vector<int32_t>& x = group.faces[kX];
  const auto reach = int32_t(std::sqrt(double(squaredReach)));
  const auto begin = size_t(std::lower_bound(x.begin(), x.end(), target[0] - reach) - x.begin());
  const auto end = size_t(std::upper_bound(x.begin(), x.end(), target[0] + reach) - x.begin());
  std::array<int32_t, 6> around = target;
  if (!sameSide) around[3] = around[4] = around[5] = 0;
  int32_t sum[3];
  sumNormals(x.data() + begin, group.faces[kY].data() + begin, group.faces[kZ].data() + begin,
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
    std::array<int32_t, 6> target;
    for (size_t i = 0; i < 6; ++i) target[i] = group.faces[i][face];
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
    std::array<int32_t, 6> target;
    for (size_t i = 0; i < 6; ++i) target[i] = group.faces[i][face];
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
  const bool one = window_.codeCount() == 2;
  const int begin = one ? -3 : LabelWindow::kBegin, last = one ? 10 : LabelWindow::kEnd - 1;
  for (int x = begin; x <= last; ++x) {
    for (int y = begin; y <= last; ++y) {
      if (y < last) collectFaces(1, x, y);
      collectFaces(2, x, y);
    }
    if (x < last)
      for (int y = begin; y <= last; ++y) collectFaces(0, x, y);
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
  return std::clamp(2 * two - four, 0.25 * one, 1.1 * one);
}

}  // namespace vdb_madf::detail
