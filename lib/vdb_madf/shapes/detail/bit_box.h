// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/shapes/clumps.h"
#include "vdb_madf/shapes/detail/ball_rows.h"

namespace vdb_madf::detail {

/// A bit per voxel of a box, in rows along z. Balls are those of a metric: their squared radii are
/// in units of its weights.
class BitBox {
 public:
  BitBox(const CoordBBox& box, const VoxelWeights& weights)
      : box_(box),
        weights_(weights),
        wordsPerRow_((size_t(box.dim().z()) + 63) / 64),
        words_(size_t(box.dim().x()) * size_t(box.dim().y()) * wordsPerRow_) {}

  const CoordBBox& box() const { return box_; }
  void set(const Coord& p) {
    const size_t z = size_t(p.z() - box_.min().z());
    row(p.x(), p.y())[z / 64] |= uint64_t(1) << (z & 63);
  }
  /// f(word, mask, voxel of bit 0) for the words of a ball; the mask has the bits of the ball.
  template <typename F>
  void forEachWord(const Clump::Ball& ball, const F& f) {
    // Whole numbers below the squared radius are those up to this one.
    const int64_t last = int64_t(std::ceil(ball.squaredRadius)) - 1;
    if (last < 0) return;
    const int reachX = reach(last, 0), reachY = reach(last, 1);
    const Coord& c = ball.center;
    for (int x = std::max(c.x() - reachX, box_.min().x());
         x <= std::min(c.x() + reachX, box_.max().x()); ++x)
      for (int y = std::max(c.y() - reachY, box_.min().y());
           y <= std::min(c.y() + reachY, box_.max().y()); ++y) {
        const int64_t rest = last - squaredAlong(int64_t(x) - c.x(), weights_.x) -
                             squaredAlong(int64_t(y) - c.y(), weights_.y);
        if (rest < 0) continue;
        const int half = reach(rest, 2);
        const int low = std::max(c.z() - half, box_.min().z()) - box_.min().z(),
                  high = std::min(c.z() + half, box_.max().z()) - box_.min().z();
        uint64_t* words = row(x, y);
        for (int word = low / 64; low <= high && word <= high / 64; ++word) {
          uint64_t mask = ~uint64_t(0);
          if (word == low / 64) mask &= ~uint64_t(0) << (low & 63);
          if (word == high / 64) mask &= ~uint64_t(0) >> (63 - (high & 63));
          f(words[word], mask, Coord(x, y, box_.min().z() + word * 64));
        }
      }
  }
  /// The set bits of a ball with these rows, as forEachWord() has them.
  int64_t count(const Clump::Ball& ball, const BallRows& rows) const {
    const Coord from(ball.center.x() - rows.reachX, ball.center.y() - rows.reachY,
                     ball.center.z() - 32 - box_.min().z());
    const Coord low = Coord::maxComponent(from, box_.min()),
                high = Coord::minComponent(ball.center.offsetBy(rows.reachX, rows.reachY, 0),
                                           box_.max());
    if (rows.masks.empty() || low.x() > high.x() || low.y() > high.y()) return 0;
    MaskedRows masked;
    masked.masksPerX = size_t(2 * rows.reachY + 1);
    masked.masks = rows.masks.data() + size_t(low.x() - from.x()) * masked.masksPerX +
                   size_t(low.y() - from.y());
    masked.wordsPerX = size_t(box_.dim().y()) * wordsPerRow_;
    masked.wordsPerY = wordsPerRow_;
    masked.countX = high.x() - low.x() + 1;
    masked.countY = high.y() - low.y() + 1;
    int64_t sum = 0;
    // The mask of a row lies across two words, or in one.
    for (int word = from.z() >> 6; word <= (from.z() >> 6) + 1; ++word) {
      masked.shift = from.z() - 64 * word;
      if (word < 0 || word >= int(wordsPerRow_) || masked.shift == -64) continue;
      masked.words = row(low.x(), low.y()) + word;
      sum += countMasked(masked);
    }
    return sum;
  }
  int64_t count() const { return countBitsIn(words_); }
  template <typename F>
  void forEachSet(const F& f) const {
    size_t i = 0;
    for (int x = box_.min().x(); x <= box_.max().x(); ++x)
      for (int y = box_.min().y(); y <= box_.max().y(); ++y)
        for (size_t word = 0; word < wordsPerRow_; ++word)
          forEachBit(words_[i++], Coord(x, y, box_.min().z() + int(word * 64)), f);
  }
  /// f(voxel) for the bits of a word.
  template <typename F>
  static void forEachBit(uint64_t bits, const Coord& first, const F& f) {
    for (; bits; bits &= bits - 1) f(first.offsetBy(0, 0, __builtin_ctzll(bits)));
  }

 private:
  /// The largest whole number of voxels along an axis whose square is at most that.
  int reach(int64_t square, int axis) const {
    return int(std::sqrt(double(square / weights_[axis])));  // exact: squares are below 2^31
  }
  const uint64_t* row(int x, int y) const { return const_cast<BitBox*>(this)->row(x, y); }
  uint64_t* row(int x, int y) {
    return &words_[(size_t(x - box_.min().x()) * size_t(box_.dim().y()) +
                    size_t(y - box_.min().y())) *
                   wordsPerRow_];
  }

  CoordBBox box_;
  VoxelWeights weights_;
  size_t wordsPerRow_;
  std::vector<uint64_t> words_;
};

}  // namespace vdb_madf::detail
