// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/site_offers.h"

#include <algorithm>
#include <tuple>

#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/slabs/detail/column_steps.h"

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
      f(leaf * 512 + offset);
    }
}

/// By column; in a column those nearest to the cut first.
class CutOrder {
 public:
  explicit CutOrder(const Cut& cut) : cut_(cut) {}
  bool operator()(const ForeignSite& a, const ForeignSite& b) const {
    const Coord &p = a.position, &q = b.position;
    return std::make_tuple(p.x(), p.y(), cut_.away(p.z())) <
           std::make_tuple(q.x(), q.y(), cut_.away(q.z()));
  }

 private:
  Cut cut_;
};

bool isSameColumn(const ForeignSite& a, const ForeignSite& b) {
  return a.position.x() == b.position.x() && a.position.y() == b.position.y();
}

bool goesThrough(const ColumnSteps& columns, const Coord& p) {
  const auto row = size_t((p.x() & 7) * 8 + (p.y() & 7));
  return columns.of(p & ~7)[row] == kThrough;
}

}  // namespace

std::vector<ForeignSite> siteOffers(const LeafIndex& index,
                                    const VoxelArray<int32_t>& squaredRadius, int32_t weight,
                                    const Cut& cut) {
  std::vector<ForeignSite> offers;
  BeyondCut best(weight);
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    if (index.origin(leaf).z() != (cut.layer() & ~7)) continue;
    forEachBit(layersAlongZ(index.mask(leaf))[cut.isUpper ? 7 : 0], [&](int row) {
      best.clear();
      forEachInColumn(index, leaf, row, cut.isUpper, [&](VoxelId id) {
        const Coord position = index.coord(id);
        best.add(cut.away(position.z()), {position, squaredRadius[index.rank(id)]});
      });
      offers.insert(offers.end(), best.sites().begin(), best.sites().end());
    });
  }
  std::sort(offers.begin(), offers.end(), CutOrder(cut));
  return offers;
}

std::vector<ForeignSite> passOn(const std::vector<ForeignSite>& own,
                                const std::vector<ForeignSite>& offered, const ColumnSteps& columns,
                                int32_t weight, const Cut& cut) {
  std::vector<ForeignSite> all = own;
  for (const ForeignSite& site : offered)
    if (goesThrough(columns, site.position)) all.push_back(site);
  std::sort(all.begin(), all.end(), CutOrder(cut));
  std::vector<ForeignSite> offers;
  BeyondCut best(weight);
  for (size_t i = 0; i < all.size(); ++i) {
    if (i > 0 && !isSameColumn(all[i - 1], all[i])) {
      offers.insert(offers.end(), best.sites().begin(), best.sites().end());
      best.clear();
    }
    best.add(cut.away(all[i].position.z()), all[i]);
  }
  offers.insert(offers.end(), best.sites().begin(), best.sites().end());
  return offers;
}

}  // namespace vdb_madf::detail
