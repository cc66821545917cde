// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/site_offers.h"

#include <algorithm>
#include <cstddef>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/slabs/cuts/column_steps.h"

namespace vdb_madf::detail {

namespace {

/// The envelope beyond a cut of the sites of one column. A site k voxels before the first voxel
/// beyond it has there, and u voxels further on, the power
///   f(u) = w (u + k)^2 - D,  u = 0, 1, 2, ...
/// Of two, the one of larger k grows faster: it is better from u = 0 to some u, if at all.
class BeyondCut {
 public:
  explicit BeyondCut(int64_t weight) : weight_(weight) {}

  void clear() {
    sites_.clear();
    k_.clear();
  }
  const std::vector<ForeignSite>& sites() const { return sites_; }

  /// By rising k.
  void add(int64_t k, const ForeignSite& site) {
    if (at(k, site.squaredRadius, 0) >= 0) return;
    if (!sites_.empty() && at(k, site.squaredRadius, 0) > lastAt(0)) return;
    while (!sites_.empty() && isUseless(k, site.squaredRadius)) {
      sites_.pop_back();
      k_.pop_back();
    }
    sites_.push_back(site);
    k_.push_back(k);
  }

 private:
  int64_t at(int64_t k, int64_t squaredRadius, int64_t u) const {
    return squaredAlong(u + k, weight_) - squaredRadius;
  }
  int64_t lastAt(int64_t u) const { return at(k_.back(), sites_.back().squaredRadius, u); }

  /// Is the last site, with a new one of larger k, nowhere the best one below 0?
  bool isUseless(int64_t k, int64_t squaredRadius) const {
    // The first u at which the last site is no worse than the new one.
    const int64_t gap = lastAt(0) - at(k, squaredRadius, 0), slope = 2 * weight_ * (k - k_.back());
    const int64_t first = (gap + slope - 1) / slope;
    if (lastAt(first) >= 0) return true;
    if (sites_.size() < 2) return false;
    // The first u at which the one before it is better than the last one.
    const size_t i = sites_.size() - 2;
    const int64_t lead = at(k_[i], sites_[i].squaredRadius, 0) - lastAt(0);
    return lead / (2 * weight_ * (k_.back() - k_[i])) + 1 <= first;
  }

  int64_t weight_;
  std::vector<ForeignSite> sites_;
  std::vector<int64_t> k_;
};

/// The walk from a cut into the slab, along a row of its leaves.
template <typename F>
void forEachInColumn(const LeafIndex& index, uint32_t leaf, int row, bool isUpper, const F& f) {
  const size_t onward = isUpper ? 4 : 5;  // from leaf to leaf, away from the cut
  for (; leaf != LeafIndex::kNone; leaf = index.neighbors(leaf)[onward])
    for (int i = 0; i < 8; ++i) {
      const auto offset = uint32_t(row * 8 + (isUpper ? 7 - i : i));
      if (!holds(index.mask(leaf), offset)) return;
      f(voxelId(leaf, offset));
    }
}

bool isSameColumn(const ForeignSite& a, const ForeignSite& b) {
  return a.position.x() == b.position.x() && a.position.y() == b.position.y();
}

/// What is left of a column, by rising z.
void addByZ(const BeyondCut& best, const Cut& cut, std::vector<ForeignSite>& offers) {
  const std::vector<ForeignSite>& sites = best.sites();
  if (cut.isUpper)
    offers.insert(offers.end(), sites.rbegin(), sites.rend());
  else
    offers.insert(offers.end(), sites.begin(), sites.end());
}

bool goesThrough(const ColumnSteps& columns, const Coord& p) {
  const auto row = size_t((p.x() & 7) * 8 + (p.y() & 7));
  return columns.of(p & ~7)[row] == kThrough;
}

}  // namespace

std::vector<ForeignSite> siteOffers(const LeafIndex& index,
                                    const VoxelArray<int32_t>& squaredRadius, int32_t weight,
                                    const Cut& cut) {
  std::vector<uint32_t> leaves;
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
    if (index.origin(leaf).z() == (cut.layer() & ~7)) leaves.push_back(leaf);
  std::vector<std::vector<ForeignSite>> ofLeaf(leaves.size());
  parallelFor(leaves.size(), kLeafGrain, nullptr, [&](size_t begin, size_t end) {
    BeyondCut best(weight);
    for (size_t i = begin; i < end; ++i)
      forEachBit(layersAlongZ(index.mask(leaves[i]))[cut.isUpper ? 7 : 0], [&](int row) {
        best.clear();
        forEachInColumn(index, leaves[i], row, cut.isUpper, [&](VoxelId id) {
          const Coord position = index.coord(id);
          best.add(cut.away(position.z()), {position, squaredRadius[index.rank(id)]});
        });
        addByZ(best, cut, ofLeaf[i]);
      });
  });
  std::vector<ForeignSite> offers;
  for (const auto& some : ofLeaf) offers.insert(offers.end(), some.begin(), some.end());
  return offers;
}

std::vector<ForeignSite> passOn(const std::vector<ForeignSite>& own,
                                const std::vector<ForeignSite>& offered, const ColumnSteps& columns,
                                int32_t weight, const Cut& cut) {
  std::vector<ForeignSite> all = own;
  for (const ForeignSite& site : offered)
    if (goesThrough(columns, site.position)) all.push_back(site);
  std::inplace_merge(all.begin(), all.begin() + std::ptrdiff_t(own.size()), all.end(),
                     ColumnOrder());
  std::vector<ForeignSite> offers;
  BeyondCut best(weight);
  for (size_t first = 0, last; first < all.size(); first = last) {
    for (last = first + 1; last < all.size() && isSameColumn(all[first], all[last]);) ++last;
    if (cut.isUpper)
      std::reverse(all.begin() + std::ptrdiff_t(first), all.begin() + std::ptrdiff_t(last));
    best.clear();
    for (size_t i = first; i < last; ++i) best.add(cut.away(all[i].position.z()), all[i]);
    addByZ(best, cut, offers);
  }
  return offers;
}

}  // namespace vdb_madf::detail
