// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/method/critical_point.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/merge.h"

namespace vdb_madf::detail {

/// Tells which edges merge their nodes, as the tests of merge() say. Of MergeMode::score these are
/// the tests that its classes begin with (hierarchy.h): only what is no local maximum merges.
class MergeRule {
 public:
  MergeRule(const MergeOptions& options, const VoxelWeights& weights)
      : options_(options), weights_(weights) {
    if (options.mode == MergeMode::score) {
      options_.mode = MergeMode::neck;
      options_.theta = -1;
      options_.delta = 0;
    }
    factor_ = (1 - options_.theta) / 2;
  }

  /// @param cellsTouch ManifoldGraph::Edge::cellsTouch
  bool mergesByAngle(const CriticalPoint& a, const CriticalPoint& b, bool cellsTouch) const {
    if (options_.mode == MergeMode::neck) return false;
    if (options_.adjacency == Adjacency::cell && !cellsTouch) return false;
    return cosAlpha(squaredBetween(a.position, b.position, weights_), a.squaredRadius,
                    b.squaredRadius) < options_.theta;
  }

  /// Is an edge of that saddle height tested by its neck?
  bool seesNeck(int32_t height) const { return options_.mode != MergeMode::angle && height > 0; }
  /// Does a neck of that height, > 0, merge two classes of which that is the smaller top? If it
  /// does, so does any higher neck, and with any smaller top.
  bool mergesByNeck(int32_t height, int32_t top) const {
    return height >= factor_ * top || isWithin(top, height);
  }

 private:
  /// Is the neck of squared radius h, 0 < h, less than k / 8 of the shortest edge narrower than a
  /// ball of squared radius m? That edge is sqrt(w), w its weight:
  ///   sqrt(m) < sqrt(h) + k sqrt(w) / 8  <=>  L := 64 (m - h) - k^2 w < 16 k sqrt(w h)
  ///                                      <=>  L < 0  or  L^2 < 256 k^2 w h   (where k > 0).
  bool isWithin(int64_t m, int64_t h) const {
    const int64_t k = options_.delta, w = weights_.least();
    const __int128 l = 64 * (m - h) - k * k * w;
    return k > 0 && (l < 0 || l * l < __int128(256 * k * k) * w * h);
  }

  MergeOptions options_;
  VoxelWeights weights_;
  double factor_;
};

}  // namespace vdb_madf::detail
