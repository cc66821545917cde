// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/domain_pairs.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <tuple>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/active_tiles.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kRowGrain = 4096;

using Leaf = MaskTree::LeafNodeType;

/// A leaf of the region, or full ones that follow each other along the axis (null).
struct Piece {
  std::array<int32_t, 2> pencil;  // origin across the axis
  int32_t begin, end;
  const Leaf* leaf;
};

/// The pieces by pencils, and along them.
std::vector<Piece> piecesOf(const MaskTree& region, int axis) {
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  std::vector<Piece> pieces;
  for (auto leaf = region.cbeginLeaf(); leaf; ++leaf) {
    const Coord& origin = leaf->origin();
    pieces.push_back({{origin[a], origin[b]}, origin[axis], origin[axis] + 8, &*leaf});
  }
  forEachActiveTile(region, [&](const CoordBBox& box) {
    for (int i = box.min()[a]; i <= box.max()[a]; i += 8)
      for (int j = box.min()[b]; j <= box.max()[b]; j += 8)
        pieces.push_back({{i, j}, box.min()[axis], box.max()[axis] + 1, nullptr});
  });
  parallelSort(pieces.begin(), pieces.end(), [](const Piece& p, const Piece& q) {
    return std::tie(p.pencil, p.begin) < std::tie(q.pencil, q.begin);
  });
  return pieces;
}

/// The eight slices of a leaf across an axis, a bit for each of its 64 rows along it.
std::array<uint64_t, 8> slicesOf(const Leaf& leaf, int axis) {
  const LeafIndex::Mask mask = maskOf(leaf);
  std::array<uint64_t, 8> slices{};
  for (uint32_t x = 0; x < 8; ++x) {
    const uint64_t word = mask[x];
    if (axis == 0) slices[x] = word;
    for (uint32_t i = 0; axis == 1 && i < 8; ++i) slices[i] |= (word >> 8 * i & 0xff) << 8 * x;
    for (uint32_t i = 0; axis == 2 && i < 8; ++i)
      slices[i] |= uint64_t(packBits(word >> i & 0x0101010101010101u)) << 8 * x;
  }
  return slices;
}

}  // namespace

/// Makes the runs of the 64 rows of a pencil from its slices.
class DomainPairs::RowCollector {
 public:
  /// From `position` on the rows with a bit lie in the region, the others do not.
  void set(uint64_t rows, int32_t position) {
    forEachBit(rows ^ inside_, [&](int row) {
      std::vector<Run>& runs = runs_[size_t(row)];
      if (inside_ >> row & 1)
        runs.back().end = position;
      else
        runs.push_back({position, position});
    });
    inside_ = rows;
  }
  /// Ends the pencil at `position` and appends its rows.
  void finish(int32_t position, DomainPairs& to) {
    set(0, position);
    for (std::vector<Run>& runs : runs_) {
      if (runs.empty()) continue;
      to.runs_.insert(to.runs_.end(), runs.begin(), runs.end());
      to.rows_.push_back(to.runs_.size());
      runs.clear();
    }
  }

 private:
  uint64_t inside_ = 0;
  std::array<std::vector<Run>, 64> runs_;
};

DomainPairs::DomainPairs(const Domain& domain, int axis)
    : extent_(domain.box().dim()[axis]), isBox_(domain.isBox()) {
  if (isBox_) {
    section_ = double(domain.voxelCount()) / extent_;
    return;
  }
  rows_.push_back(0);
  const std::vector<Piece> pieces = piecesOf(*domain.region(), axis);
  RowCollector rows;
  for (size_t i = 0; i < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    if (piece.leaf) {
      const std::array<uint64_t, 8> slices = slicesOf(*piece.leaf, axis);
      for (int k = 0; k < 8; ++k) rows.set(slices[size_t(k)], piece.begin + k);
    } else {
      rows.set(~uint64_t(0), piece.begin);
    }
    const bool last = i + 1 == pieces.size() || pieces[i + 1].pencil != piece.pencil;
    if (last)
      rows.finish(piece.end, *this);
    else if (pieces[i + 1].begin != piece.end)
      rows.set(0, piece.end);
  }
}

double DomainPairs::count(int lag, Interrupter* interrupter) const {
  if (isBox_) return section_ * (extent_ - lag);
  std::atomic<int64_t> sum{0};
  parallelFor(rows_.size() - 1, kRowGrain, interrupter, [&](size_t begin, size_t end) {
    int64_t part = 0;
    for (size_t row = begin; row < end; ++row) {
      size_t reached = rows_[row];  // the first run that does not end before the shifted one
      for (size_t i = rows_[row]; i < rows_[row + 1]; ++i) {
        const int64_t from = int64_t(runs_[i].begin) + lag, to = int64_t(runs_[i].end) + lag;
        while (reached < rows_[row + 1] && runs_[reached].end <= from) ++reached;
        for (size_t j = reached; j < rows_[row + 1] && runs_[j].begin < to; ++j)
          part += std::min<int64_t>(to, runs_[j].end) - std::max<int64_t>(from, runs_[j].begin);
      }
    }
    sum += part;  // integers: any order
  });
  return double(sum);
}

}  // namespace vdb_madf::detail
