// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/foreign_sites.h"

#include <algorithm>
#include <tuple>

#include "vdb_madf/base/detail/sorted.h"

namespace vdb_madf::detail {

namespace {

/// The sites of a pencil among all, in either case in ColumnOrder.
template <typename Named>
void addRows(const std::vector<Named>& sites, const Coord& origin, BeyondRows& rows) {
  const auto leafBefore = [](const Named& named, const Coord& leaf) {
    const Coord& p = named.site.position;
    return std::make_tuple(p.x() & ~7, p.y() & ~7) < std::make_tuple(leaf.x(), leaf.y());
  };
  auto next = std::lower_bound(sites.begin(), sites.end(), origin, leafBefore);
  for (uint32_t row = 0; row < 64; ++row) {
    const int x = origin.x() + int(row >> 3), y = origin.y() + int(row & 7);
    for (; next != sites.end() && next->site.position.x() == x && next->site.position.y() == y;
         ++next)
      rows.sites.push_back(
          {next->site.position.z() - origin.z(), next->site.squaredRadius, next->id});
    rows.first[row + 1] = uint32_t(rows.sites.size());
  }
}

}  // namespace

ForeignSites::ForeignSites(const std::vector<ForeignSite>& below,
                           const std::vector<ForeignSite>& above, int begin, int end,
                           LeafIndex& index)
    : begin_(begin), end_(end) {
  for (const ForeignSite& site : below) below_.push_back({site, 0});
  for (const ForeignSite& site : above) above_.push_back({site, 0});
  name(index);
}

void ForeignSites::name(LeafIndex& index) {
  std::vector<Coord> leaves;
  for (const auto* side : {&below_, &above_})
    for (const Named& named : *side) {
      const int z = named.site.position.z();
      largest_ = std::max(largest_, named.site.squaredRadius);
      reach_ = std::max({reach_, begin_ - z, z - end_ + 1});
      const Coord leaf = named.site.position & ~7;
      if (leaves.empty() || leaves.back() != leaf) leaves.push_back(leaf);
    }
  sortUnique(leaves);
  for (auto* side : {&below_, &above_})
    for (Named& named : *side) {
      const Coord& p = named.site.position;
      named.id = voxelId(index.leafCount() + sortedIndex(leaves, p & ~7), offsetOf(p));
    }
  index.nameForeignLeaves(leaves);
}

template <typename Key>
void ForeignSites::addTo(const Coord& origin, int length, EnvelopeRows<Key>& rows) const {
  rows.before.clear();
  rows.after.clear();
  if (origin.z() == begin_) addRows(below_, origin, rows.before);
  if (origin.z() + length == end_) addRows(above_, origin, rows.after);
}

void ForeignSites::addTo(const Coord& origin, int shift, KeyLines& lines) const {
  const auto add = [&](const std::vector<Named>& sites) {
    BeyondRows rows;
    addRows(sites, origin, rows);
    for (uint32_t row = 0; row < 64; ++row)
      for (uint32_t i = rows.first[row]; i < rows.first[row + 1]; ++i) {
        const BeyondRow& beyond = rows.sites[i];
        if (beyond.position < -lines.reach() || beyond.position >= lines.length() + lines.reach())
          continue;
        const size_t at = lines.at(int(row), beyond.position);
        lines.key[at] = keyOfBall(beyond.radius2, shift);
        lines.site[at] = beyond.site;
      }
  };
  if (origin.z() == begin_) add(below_);
  if (origin.z() + lines.length() == end_) add(above_);
}

template void ForeignSites::addTo(const Coord&, int, EnvelopeRows<int64_t>&) const;
template void ForeignSites::addTo(const Coord&, int, EnvelopeRows<__int128>&) const;

}  // namespace vdb_madf::detail
