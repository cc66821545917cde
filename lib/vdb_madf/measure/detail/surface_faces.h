// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/labels/detail/label_window.h"

namespace vdb_madf::detail {

/// Areas are sums of integers, so that their order does not matter: parts of a voxel face.
constexpr double kAreaUnit = 1 << 20;

/// A face to be counted, or the place between two voxels that face each other from further apart.
struct SurfaceTarget {
  std::array<int16_t, 3> center;  ///< doubled, relative to the leaf
  int16_t side;                   ///< 2 * axis of its normal, and 1 more if that points down
};

/// Adds the places between voxels of `own` in the leaf and those of `other` that lie `step` further
/// along an axis (-1, or 1 to 4).
void addTargets(const WindowRows& own, const WindowRows& other, int axis, int step, int side,
                std::vector<SurfaceTarget>& targets);

/// The voxel faces between two sets of voxels around a leaf, and the normals that they make. One
/// per thread; large.
class SurfaceFaces {
 public:
  /// Faces between voxels of `first` and `second`, which lie from `begin` to `last` along the two
  /// axes of the face, and one less or more along its normal (drawn in leaf_surface.h). Normals
  /// point away from `first`.
  void collect(const WindowRows& first, const WindowRows& second, int begin, int last);

  /// Sum over the targets of the cosine between their axis and the normal of the surface around
  /// them, in kAreaUnit; 0 where that points away. The normal is the mean of those of the faces
  /// less than half of `reach` voxels away, weighted by (reach / 2)^2 - distance^2. oneSheet: faces
  /// that point opposite to the target's are not among them.
  int64_t area(const SurfaceTarget* begin, const SurfaceTarget* end, int reach, bool oneSheet);

 private:
  /// Faces per block of the SIMD loop.
  static constexpr size_t kTogether = 32;
  static constexpr int kSide = WindowRows::kEndX - WindowRows::kBeginX;
  static constexpr size_t kRoom = size_t(kSide * kSide * kSide) + kTogether;

  /// Faces of one axis and direction, sorted by x; centres doubled.
  struct List {
    size_t count = 0;
    std::array<uint32_t, size_t(kSide) + 1> from{};  // the first whose lower voxel has an x
    std::vector<int16_t> x, y, z;                    // a block behind the last is far away
  };

  void collect(const WindowRows& first, const WindowRows& second, int begin, int last, int side,
               int x);
  static void addWeights(const List& list, bool alongX, const SurfaceTarget* begin,
                         const SurfaceTarget* end, int reach, int skippedSide, int16_t* sums);

  std::array<List, 6> lists_;                 // by side, as of a target
  std::array<std::vector<int16_t>, 6> sums_;  // of weights, by target
};

}  // namespace vdb_madf::detail
