// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/matching/detail/local_fit.h"
#include "vdb_madf/matching/detail/scan_grains.h"
#include "vdb_madf/matching/detail/seed_search.h"

namespace vdb_madf::detail {

/// Follows grains from what is known already.
class Following {
 public:
  static constexpr double kLimit = 0.5;  ///< farthest partner, in spacings

  Following(const ScanGrains& before, const ScanGrains& after)
      : before_(before),
        after_(after),
        partners_(before.size(), kNoIndex),
        dependents_(before.around),
        isDue_(before.size(), 0),
        expected_(before.size()) {
    changeAll();
  }

  void take(const Seed& seed) {
    for (const auto& [n, m] : seed.pairs) {
      partners_[n] = m;
      expected_[n].gradient = seed.gradient;
    }
  }

  void setWhole(const Motion& whole) {
    whole_ = whole;
    changeAll();
  }

  /// Matches until nothing changes. Grains are looked at again where a neighbor has changed.
  void settle(Interrupter* interrupter);

  /// Whether what has grown is more than chance: most of the grains whose neighbors say that they
  /// lie among those of after are there, and close to where they say.
  bool isSound() const;

  /// All are looked at again, with an eye on how far the partners of most are. Specks are let go
  /// if most of them are not found: what is left of them is chance.
  void finish(Interrupter* interrupter);

  /// The motion of most, by least squares without those that are far off, or cut if enough are
  /// not.
  std::optional<Motion> wholeOf(MotionKind kind) const;

  FollowedGrains result() const;

 private:
  /// The grains that each grain is around, one list after the other.
  struct Dependents {
    std::vector<size_t> first;
    std::vector<uint32_t> grains;

    explicit Dependents(const std::vector<std::vector<size_t>>& around);
  };
  struct Candidate {
    size_t grain;
    double cost, distance;
  };
  /// The grain before that a grain after suits best, and what the second best costs.
  struct Claim {
    size_t grain = kNoIndex;
    double cost = 0, second = 0;
  };
  /// Where a grain should be, and what is there.
  struct Expected {
    bool isPlaced = false;
    Vec3d place{0, 0, 0};
    Mat3d gradient = Mat3d::identity();
    std::vector<Candidate> candidates;
  };

  double missOf(size_t n) const {
    return (after_.center(partners_[n]) - expected_[n].place).length();
  }
  /// Whether most of the specks, or of the others, are followed that lie among those of after.
  bool areFound(bool specks) const;

  /// Whether a grain that is followed, or its partner, is cut.
  bool isCut(size_t n) const {
    return before_.grains[n].isCut || after_.grains[partners_[n]].isCut;
  }
  /// How far all that are followed, but specks, miss their places, in spacings.
  std::vector<double> misses() const;
  double missOf(size_t n, const Motion& motion) const {
    return (after_.center(partners_[n]) - motion(before_.center(n))).length();
  }

  void changeAll() {
    const auto& inCells = before_.cells.inCells();
    changed_.assign(inCells.begin(), inCells.end());  // near ones together
  }
  /// Grains that have changed, or have a neighbor that has.
  std::vector<size_t> due();
  /// Looks at the due ones anew.
  void expectDue(Interrupter* interrupter);

  Expected expect(size_t n) const;

  void addCandidates(size_t n, Expected& here) const;

  /// The share of the followed grains at one that touch its partner, too; 1: there are none.
  double contactsKept(size_t n, size_t m) const;

  /// @return whether anything has changed
  bool match();
  /// The one that suits it best, if it suits that one best, too, and nothing else nearly as well;
  /// else kNoIndex.
  size_t partnerOf(size_t n);

  const ScanGrains &before_, &after_;
  std::vector<size_t> partners_;
  std::vector<size_t> changed_;
  const Dependents dependents_;
  std::vector<char> isDue_;  ///< none but while they are collected
  std::vector<Expected> expected_;
  std::vector<double> ratios_;
  std::vector<Claim> claims_;  ///< kept from one round to the next for their memory
  std::optional<Motion> whole_;
  double limit_ = kLimit;
};

}  // namespace vdb_madf::detail
