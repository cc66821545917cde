// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/matching/detail/local_fit.h"
#include "vdb_madf/matching/detail/scan_grains.h"

namespace vdb_madf::detail {

using Pairs = std::vector<std::pair<size_t, size_t>>;

/// Grains, and where they are found again.
struct Seed {
  Pairs pairs;
  Mat3d gradient;
  /// The sum over the pairs of how much nearer they are than they may be, 0 to 1. In nearly regular
  /// packs wrong places have as many pairs, but fit worse.
  double score = 0;
};

/// Looks for a neighborhood of before in after.
class SeedSearch {
 public:
  SeedSearch(const ScanGrains& before, const ScanGrains& after, const MatchOptions& options);

  /// Grains that are tried one after the other: the inner half, the innermost first.
  size_t count() const;

  std::optional<Seed> operator()(size_t k, Interrupter* interrupter) const;

 private:
  /// Three neighbors that are far from one plane with the grain.
  std::array<size_t, 3> cornersOf(size_t n) const;

  std::optional<Seed> bestOf(size_t n, const std::vector<size_t>& places,
                             Interrupter* interrupter) const;

  bool alikeInLength(const Vec3d& a, const Vec3d& b) const;

  /// The best of all ways to find the three neighbors among those of a grain after.
  std::optional<Seed> at(size_t n, const std::array<size_t, 3>& corners,
                         const std::vector<size_t>& far, size_t m) const;

  /// The nearest grain after of such a volume.
  size_t near(size_t n, const Vec3d& place, double radius) const;

  bool looksRight(size_t n, size_t m, const Mat3d& gradient) const;

  std::optional<Seed> refined(size_t n, const std::vector<size_t>& far, Pairs pairs) const;

  const ScanGrains &before_, &after_;
  std::optional<Motion> guess_;
  std::vector<double> depthsBefore_, depthsAfter_;
  std::vector<size_t> inner_;
  double shortest_ = 0.7, longest_ = 1.32;  // edges, of what they were: a fifth, and noise
};

}  // namespace vdb_madf::detail
