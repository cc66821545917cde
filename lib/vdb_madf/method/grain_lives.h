// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/method/hierarchy.h"

namespace vdb_madf {

/// The strictnesses at which there is a grain that is the same but for 2 % of the voxels of the
/// larger of the two: `born` and those below it that are above `dies`.
struct GrainLife {
  std::optional<double> born;  ///< none: it is there at all larger ones
  std::optional<double> dies;  ///< none: it is there at all smaller ones
  /// How far the strictness can go, to the nearer of both; none: anywhere.
  std::optional<double> stability;
};

/// How long the grains that cut() makes at a strictness stay what they are, and when they meet.
/// Grains are named by any node that is in them; voxels are those of their manifolds in the object.
/// Of a hierarchy with a `lowest` what would happen below it does not happen.
class GrainLives {
 public:
  /// Time is about (joins) log (joins). @throw InvalidInput as cut()
  GrainLives(const Hierarchy& hierarchy, double strictness);

  /// All three are none for a grain without voxels of the object.
  GrainLife of(uint32_t node) const;
  /// The largest strictness at which two grains are one; none: they never are, or they are the
  /// same.
  std::optional<double> joinedAt(uint32_t first, uint32_t second) const;

 private:
  /// The root of a class when so many joins are made.
  uint32_t rootAt(uint32_t aClass, size_t joins) const;
  void link(uint32_t first, uint32_t second, std::vector<uint32_t>& size);
  void followGrains(const Hierarchy& hierarchy);

  std::vector<uint32_t> classOfNode_;
  std::vector<double> strictness_;  // of each join
  // A forest of classes: each hangs below a root that it was joined to, by a join. Depth is
  // logarithmic.
  std::vector<uint32_t> parent_;
  std::vector<size_t> join_;
  size_t cut_;  // joins that are made
  double strictnessOfCut_;
  std::vector<GrainLife> lives_;  // of the roots at the cut
};

}  // namespace vdb_madf
