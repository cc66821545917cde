// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "vdb_madf/detail/label_leaves.h"
#include "vdb_madf/interface_curvature.h"

namespace vdb_madf::detail {

/// Areas are sums of integers, so that their order does not matter: parts of a voxel face.
constexpr double kAreaUnit = 1 << 20;

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
class LeafSurface {
 public:
  struct Free {
    int64_t area = 0;      ///< between grain and background, in kAreaUnit
    int64_t cutFaces = 0;  ///< voxel faces on the border of the domain
  };
  struct Shared {
    int32_t first = 0, second = 0;  ///< labels, first < second
    /// In kAreaUnit: of pairs of voxels 1, 2, 4 apart; the latter two count each crossing twice and
    /// four times.
    std::array<int64_t, 3> areas{};
    std::vector<InterfaceFace> faces;
  };

  /// Faces on the border of `domain` are no surface but counted apart; none: there are no such.
  LeafSurface(const LabelLeaves& labels, const std::optional<CoordBBox>& domain)
      : labels_(&labels), window_(labels), domain_(domain) {}

  /// Free faces belong to the leaf of their labelled voxel, shared ones and pairs to that of their
  /// lower voxel.
  void measure(size_t leaf);

  const std::unordered_map<int32_t, Free>& free() const { return free_; }  ///< by label
  const std::vector<Shared>& shared() const { return shared_; }

 private:
  using Code = LabelWindow::Code;
  enum Component { kX, kY, kZ, kNormalX, kNormalY, kNormalZ };
  using Face = std::array<int16_t, 6>;
  /// The faces between two partners, sorted by x: twice the centre, relative to the leaf, and the
  /// axis with its sign, away from the first partner.
  struct Group {
    Code first = 0, second = 0;  // second 0: background
    size_t count = 0;
    std::array<std::vector<int16_t>, 6> faces;  // the first `count` of each, then room
    std::vector<uint32_t> owned;                // faces whose area is this leaf's
    Face face(size_t i) const {
      return {faces[0][i], faces[1][i], faces[2][i], faces[3][i], faces[4][i], faces[5][i]};
    }
  };
  /// Faces [begin, end) of a group reach the target's x; targets come in rising order of x.
  struct Near {
    size_t begin = 0, end = 0;
  };

  Group& group(Code first, Code second);
  const Group* findGroup(Code first, Code second) const;
  void collectFaces(int axis, int x, int y, uint32_t within);
  void addFaces(int axis, int x, int y, uint32_t bits, Code lower, Code upper);
  uint32_t insideDomain(int x, int y) const;
  void addPairs(int separation, Shared& shared, const Group& group);
  void measureFree(const Group& group);
  void measureShared(const Group& group);
  int64_t area(const Group& group, const Face& target, int reach, bool sameSide, Near& near) const;

  const LabelLeaves* labels_;
  LabelWindow window_;
  std::optional<CoordBBox> domain_;

  Coord origin_;
  bool atBorder_ = false;
  std::vector<Group> groups_;  // the first groupCount_ are of this leaf; the rest keeps its memory
  size_t groupCount_ = 0;
  std::unordered_map<uint32_t, uint32_t> groupOf_;
  std::unordered_map<int32_t, Free> free_;
  std::vector<Shared> shared_;
};

/// The area of a bond, in voxel faces, from the sums of Shared::areas. With A(s) that of pairs s
/// apart per crossing: A(1) + A(2)/2 - A(4)/2, the value at distance 0 of the straight line of
/// least squares through A(1) to A(4). Held between a quarter and 1.1 times A(1), which matters for
/// bonds of a few faces and grains thinner than four voxels.
double bondArea(const std::array<int64_t, 3>& areas);

}  // namespace vdb_madf::detail
