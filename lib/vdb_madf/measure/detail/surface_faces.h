// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/labels/detail/label_window.h"
#include "vdb_madf/measure/detail/voxel_shape.h"

namespace vdb_madf::detail {

/// Areas are sums of integers, so that their order does not matter: parts of the square of the
/// shortest edge of a voxel.
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

/// Which faces make a normal: those whose centers lie in a ball in space around a target, which is
/// an ellipsoid in voxels, and flatter where the ball exceeds its limits.
class NormalReach {
 public:
  /// \p doubled: twice the radius, in longest edges of a voxel. It ends after half of \p most
  /// voxels along each axis: that much of the surroundings is known.
  NormalReach(int doubled, int most, const VoxelShape& voxel);

  bool isBall() const { return isBall_; }  ///< in voxels
  /// Twice the radius along an axis, in voxels, rounded up.
  int radius(int axis) const { return radii_[size_t(axis)]; }
  /// The weight of a face at (dx, dy, dz), twice the voxels from the target, is
  ///   kWeight - factor(0) dx^2 - factor(1) dy^2 - factor(2) dz^2, if that is positive.
  int32_t factor(int axis) const { return factors_[size_t(axis)]; }
  static constexpr int32_t kWeight = 1 << 18;

 private:
  bool isBall_;
  std::array<int, 3> radii_{};
  std::array<int32_t, 3> factors_{};
};

/// Lower voxels of faces along each axis, from a leaf's origin.
struct FaceRange {
  std::array<int, 3> begin, last;
};

/// The voxel faces between two sets of voxels around a leaf, and the normals that they make. One
/// per thread; large.
class SurfaceFaces {
 public:
  explicit SurfaceFaces(const VoxelShape& voxel)
      : faceAreas_{voxel.faceArea(0), voxel.faceArea(1), voxel.faceArea(2)} {}

  /// Faces between voxels of `first` and `second`. Their lower voxels lie in `range`, along the two
  /// axes of the face behind its begin (drawn in leaf_surface.h). Normals point away from `first`.
  void collect(const WindowRows& first, const WindowRows& second, const FaceRange& range);

  /// Sum over the targets of their area times the cosine between their axis and the normal of the
  /// surface around them, in kAreaUnit; 0 where that points away. The normal is that of the sum of
  /// the faces within reach as vectors, each its area times its normal, weighted: in a ball of
  /// radius R by R^2 - distance^2, in an ellipsoid likewise. oneSheet: faces that point opposite to
  /// the target's are not among them.
  int64_t area(const SurfaceTarget* begin, const SurfaceTarget* end, const NormalReach& reach,
               bool oneSheet);

 private:
  /// Faces per block of the SIMD loop.
  static constexpr size_t kTogether = 32;
  static constexpr int kSide = WindowRows::kLine;
  static constexpr size_t kRoom = size_t(kSide * kSide * kSide) + kTogether;

  /// Faces of one axis and direction, sorted by x; centers doubled.
  struct List {
    size_t count = 0;
    std::array<uint32_t, size_t(kSide) + 1> from{};  // the first whose lower voxel has an x
    std::vector<int16_t> x, y, z;                    // a block behind the last is far away
  };

  /// The blocks of a list that hold all faces with x in reach of a target.
  struct Blocks {
    size_t from, to;
  };

  void collect(const WindowRows& first, const WindowRows& second, const FaceRange& range, int side,
               int x);
  static Blocks blocksInReach(const List& list, bool alongX, int x, int reach);
  static void addWeightsInBall(const List& list, bool alongX, const SurfaceTarget* begin,
                               const SurfaceTarget* end, int reach, int skippedSide, int32_t* sums);
  static void addWeights(const List& list, bool alongX, const SurfaceTarget* begin,
                         const SurfaceTarget* end, const NormalReach& reach, int skippedSide,
                         int32_t* sums);

  std::array<double, 3> faceAreas_;           // of a face across each axis
  std::array<List, 6> lists_;                 // by side, as of a target
  std::array<std::vector<int32_t>, 6> sums_;  // of weights, by target
};

}  // namespace vdb_madf::detail
