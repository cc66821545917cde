// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/labels/detail/label_window.h"
#include "vdb_madf/measure/detail/fit_curvature.h"
#include "vdb_madf/measure/detail/surface_faces.h"
#include "vdb_madf/measure/detail/voxel_shape.h"

namespace vdb_madf::detail {

/// The surfaces that the voxels of a leaf own, and estimates of their area.
///
/// Counting voxel faces overestimates a tilted plane by up to 73 %. So each face counts by the
/// cosine between its axis and the local normal of the surface; the normal is the weighted mean of
/// the axes of the faces between the same two partners around it (weight R^2 - distance^2). This
/// converges to the true area where the normals do (Lenoir, Malgouyres & Revenu 1996; Lachaud &
/// Thibert 2016). Faces of opposite direction never average out, so no surface vanishes.
///
/// The rim of an interface lies in a groove that voxels cannot resolve: near it, two voxels that
/// face each other belong to both grains although the line between them leaves the object. What
/// such lines add grows in proportion to the distance of the two voxels, so pairs of voxels two and
/// four apart are measured in the same way and extrapolated to distance zero (bondArea()).
///
/// Voxels that take part, along an axis, counted from the leaf's origin:
///
///    -8      -4       0             7        12    15
///                     [-------------]                   0 .. 7: the leaf
///               [-----------------------]               -3 .. 9: free faces
///             [-------------------------------]         -4 .. 12: shared faces
///             [---------------------------------]       -4 .. 13: of x (WindowRange)
///     [---------------------------------------------]   -8 .. 15: WindowRows
///
/// Faces and pairs start at a voxel of the leaf. Free faces are centered at -1/2 .. 7 1/2 and reach
/// 2 1/2 voxels; pairs, up to 4 apart, are centered at 0 .. 9 and reach 4. The bars "free" and
/// "shared" hold the lower voxels of the faces within that reach, the window along x also the upper
/// ones. Along y and z it holds the 27 leaves.
///
/// That is for cubes. Where voxels are longer along one axis, surfaces are only known by their
/// steps along it, so the reaches are in longest edges of a voxel, and span more voxels along the
/// other axes: up to 7 1/2 for free faces, 6 for shared ones, which is all that the 27 leaves
/// allow.
class LeafSurface {
 public:
  struct CutFaces {
    int side = 0;  ///< as of a target
    int64_t faces = 0;
    std::array<int64_t, 3> sum{};  ///< of the faces' centers, doubled, from the leaf's origin
  };
  struct Free {
    int32_t label = 0;
    int64_t area = 0;  ///< between grain and background, in kAreaUnit
    /// On the border of the domain, by side; none where the leaf lies within.
    std::vector<CutFaces> cuts;
  };
  struct Shared {
    int32_t first = 0, second = 0;  ///< labels, first < second
    /// Areas from pairs of voxels 1, 2, 4 apart, in kAreaUnit; the latter two count each crossing
    /// twice and four times.
    std::array<int64_t, 3> areas{};
    std::vector<InterfaceFace> faces;
  };

  /// Faces on the border of `domain` are no surface but counted apart; none: there are no such.
  LeafSurface(const LabelLeaves& labels, const std::optional<Domain>& domain,
              const VoxelShape& voxel);

  /// Free faces belong to the leaf of their labeled voxel, shared ones and pairs to that of their
  /// lower voxel.
  void measure(size_t leaf);

  /// Makes one of two labels in or around the leaf that was measured last, and measures that one
  /// alone: its free area, and what it shares with each other one.
  void join(int32_t kept, int32_t gone);

  /// All in and around the leaf that was measured last, ascending.
  std::vector<int32_t> labels() const { return window_.labels(); }
  const std::vector<Free>& free() const { return free_; }  ///< of the labels of the leaf
  const std::vector<Shared>& shared() const { return shared_; }

 private:
  bool findOutside();
  void findBackground();
  void measureFree(int32_t label);
  void measureShared(int32_t label);
  void measureBond(int32_t label, int32_t other);

  WindowRows labelled_, background_, outside_;  // outside: of the domain
  WindowRows own_, other_, near_;
  const LabelLeaves* labels_;
  LabelWindow window_;
  std::optional<Domain> domain_;
  NormalReach freeReach_, sharedReach_;
  FaceRange freeRange_, sharedRange_;  // of the faces in reach of what is measured

  Coord origin_;
  bool atBorder_ = false;  // of the domain
  std::vector<SurfaceTarget> targets_;
  SurfaceFaces faces_;
  std::vector<std::pair<int32_t, int32_t>> bonds_;  // that were measured
  std::vector<Free> free_;
  std::vector<Shared> shared_;
};

/// The area of a bond from the sums of Shared::areas, in units of the mean face of a voxel (that of
/// a cube of equal volume):
///   As = area of the pairs of voxels s apart, per crossing,
///   w = (A4 - A2) / (2 sqrt(pi max(A2, 1))),  g = clamp(w / 0.4, 0, 1),
///   A0 = (1 - g) (2 A1 - A2) + g (2 A2 - A4),  the result = clamp(A0, A1 / 4, 1.1 A1).
/// w tells how far the rim of a disc widens between pairs two and four apart: g = 0 without a
/// groove, 1 in a deep one. 2 A1 - A2 is the straight line through A1 and A2 at distance 0: where
/// there is no groove, A4 is bent too far to be used. 2 A2 - A4 is that through A2 and A4: they do
/// not depend on where between two layers of voxels an interface lies that runs along them (both
/// grains widening alike). The bounds matter for bonds of a few faces and grains thinner than four
/// voxels.
double bondArea(const std::array<int64_t, 3>& areas, const VoxelShape& voxel);

}  // namespace vdb_madf::detail
