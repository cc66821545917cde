// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/site_offers.h"

#include <algorithm>
#include <tuple>

#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/detail/metric.h"

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

/// Sites of a column, by (x, y), then z.
bool columnLess(const ForeignSite& a, const ForeignSite& b) {
  return a.position < b.position;
}

}  // namespace

std::vector<ForeignSite> siteOffers(const LeafIndex& index, const SquaredDistance& distance,
                                    const std::vector<ForeignSite>& offered, int begin, int end,
                                    bool above) {
  const int64_t weight = distance.weights.z;
  std::vector<ForeignSite> passing = offered;
  std::sort(passing.begin(), passing.end(), columnLess);
  const auto columnOf = [&](const Coord& p) {
    const auto less = [](const ForeignSite& site, const Coord& q) { return site.position < q; };
    return std::make_pair(std::lower_bound(passing.begin(), passing.end(),
                                           Coord(p.x(), p.y(), Coord::min().z()), less),
                          std::lower_bound(passing.begin(), passing.end(),
                                           Coord(p.x(), p.y(), Coord::max().z()), less));
  };

  std::vector<ForeignSite> offers;
  BeyondCut best(weight);
  const size_t onward = above ? 4 : 5;  // from leaf to leaf, away from the cut
  for (uint32_t start = 0; start < index.leafCount(); ++start) {
    if (index.origin(start).z() != (above ? end - 8 : begin)) continue;
    forEachBit(layersAlongZ(index.mask(start))[above ? 7 : 0], [&](int row) {
      best.clear();
      bool goesOn = true;
      uint32_t leaf = start;
      for (int64_t k = 1; goesOn; leaf = index.neighbors(leaf)[onward]) {
        for (int i = 0; i < 8 && goesOn; ++i, ++k) {
          const auto offset = uint32_t(row * 8 + (above ? 7 - i : i));
          goesOn = holds(index.mask(leaf), offset);
          if (!goesOn) break;
          const VoxelId id = leaf * 512 + offset;
          best.add(k, {index.coord(id), distance.values[index.rank(id)]});
        }
        if (index.neighbors(leaf)[onward] == LeafIndex::kNone) break;
      }
      const int farEnd = above ? begin : end - 8;
      if (goesOn && index.origin(leaf).z() == farEnd) {
        const Coord column = index.coord(start * 512 + uint32_t(row * 8));
        const auto [first, last] = columnOf(column);
        if (above)
          for (auto site = last; site != first; --site)
            best.add(end - (site - 1)->position.z(), *(site - 1));
        else
          for (auto site = first; site != last; ++site)
            best.add(site->position.z() - begin + 1, *site);
      }
      offers.insert(offers.end(), best.sites().begin(), best.sites().end());
    });
  }
  return offers;
}

}  // namespace vdb_madf::detail
