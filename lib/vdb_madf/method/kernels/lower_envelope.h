// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

// A pass of the power map along 64 rows at a time, on plain arrays, for balls of any size.

namespace vdb_madf::detail {

/// Result where no parabola is below 0.
constexpr int32_t kNotNegative = 1;

/// A slab holds the values of the 64 rows at one position; the padding keeps the positions of a row
/// off the same cache sets.
constexpr size_t kEnvelopeSlab = 64 + 16;

/// The parabola f(u) = power + w (u - position)^2 of a site; w is the weight of the axis.
template <typename Key>
struct Parabola {
  Key key;          // M height - D, see lower_envelope.cc
  int32_t height;   // power + w position^2
  int32_t radius2;  // D
  int32_t position;
  uint32_t site;
};

/// A site in line with the rows, before their first position (< 0) or after their last.
struct BeyondRow {
  int32_t position;
  int32_t radius2;  // D; its power is -D
  uint32_t site;
};

/// The foreign sites of all 64 rows, row after row, ascending by position.
struct BeyondRows {
  std::vector<BeyondRow> sites;
  std::array<uint32_t, 65> first{};  ///< of a row; one more at the end
  void clear() {
    sites.clear();
    first.fill(0);
  }
};

/// What lowerEnvelopes() works on, slab after slab, and its memory.
template <typename Key>
struct EnvelopeRows {
  std::vector<int32_t> power;  ///< one slab of padding at either end, 0
  std::vector<uint32_t> site;
  std::vector<int32_t> radius2;  ///< D of the site; one slab of padding at either end

  /// A bit per position, row after row: is there an object voxel, can its parabola be part of an
  /// envelope? Words of 64 positions; what is beyond the rows is 0.
  std::vector<uint64_t> object, candidate;
  size_t words = 0;  ///< per row
  std::vector<Parabola<Key>> envelope;
  std::vector<uint32_t> starting;  ///< parabolas that become the least one at a position
  /// Sites that take part in the run at the first position of their row, or the last.
  BeyondRows before, after;

  /// Makes room for rows of `length` positions, a multiple of 8. Never shrinks: growing again would
  /// clear what is overwritten anyway.
  void resize(size_t length);
};

/// Replaces powers and sites, for each row and each of its runs of object voxels (power not 0):
///   power(t) = min over s in the run, power(s) < 0, of power(s) + w (t - s)^2,  site(t) = site(s);
/// of several such s the one of larger D, then the smaller s. kNotNegative, and any site, where
/// that is 0 or more, or there is no such s. multiplier: larger than any D; weight: w, of the axis.
/// w length^2 must be less than 2^31, and with 64-bit keys 2 max(w length^2, D) (multiplier + 1)
/// length less than 2^63; length with what is beyond.
template <typename Key>
void lowerEnvelopes(int length, Key multiplier, int32_t weight, EnvelopeRows<Key>& rows);

}  // namespace vdb_madf::detail
