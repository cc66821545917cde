// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/geodesic_completion.h"

#include <algorithm>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/metric.h"

namespace vdb_madf::detail {

GeodesicCompletion::GeodesicCompletion(const LeafIndex& index, PowerMap& map)
    : index_(index), map_(map), uncovered_(index.leafCount()), front_(index.leafCount()) {}

void GeodesicCompletion::start(Interrupter* interrupter) {
  parallelFor(index_.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    forEachVoxel(index_, begin, end, [&](VoxelId p, size_t rank) {
      if (map_.power[rank] < 0) return;
      uncovered_.insert(p);  // a word belongs to one leaf, so to one thread
      map_.site[rank] = kNoSite;
    });
  });
  front_ = uncovered_;
  frontWords_.reset();
}

void GeodesicCompletion::set(const Change& voxel, bool isInFront) {
  uncovered_.insert(voxel.voxel);
  const size_t rank = index_.rank(voxel.voxel);
  map_.site[rank] = voxel.state.site;
  map_.power[rank] = voxel.state.power;
  if (isInFront) addToFront(voxel.voxel);
}

void GeodesicCompletion::setBeyond(VoxelId voxel, bool above, const State& state) {
  (above ? above_ : below_)[voxel] = state;
  if (uncovered_.contains(voxel)) addToFront(voxel);
}

void GeodesicCompletion::addToFront(VoxelId voxel) {
  front_.insert(voxel);
  if (frontWords_) frontWords_->push_back(uint32_t(voxel >> 6));
}

/// Those with something to do, in their order.
std::vector<uint32_t> GeodesicCompletion::takeFrontWords() {
  std::vector<uint32_t> words;
  if (frontWords_) {
    words.swap(*frontWords_);
    sortUnique(words);
  } else {
    for (size_t i = 0; i < front_.wordCount(); ++i)
      if (front_.word(i)) words.push_back(uint32_t(i));
  }
  return words;
}

/// Is site a better than b at equal power at p? The larger D wins, then the smaller coordinate.
/// At equal power |p - a|^2 - D(a) = |p - b|^2 - D(b) the larger D is that of the farther site.
bool GeodesicCompletion::winsTie(const Coord& p, VoxelId a, VoxelId b) const {
  const Coord siteA = index_.coord(a), siteB = index_.coord(b);
  const int64_t awayA = squaredBetween(p, siteA, map_.weights),
                awayB = squaredBetween(p, siteB, map_.weights);
  return awayA != awayB ? awayA > awayB : siteA < siteB;
}

/// The best of a voxel's own site and those of its neighbors q = p + step e. The power of q's
/// site x here follows from that at q: pi_x(p) = pi_x(q) + |p - x|^2 - |q - x|^2.
GeodesicCompletion::State GeodesicCompletion::best(VoxelId p) const {
  const size_t rank = index_.rank(p);
  State best{map_.site[rank], map_.power[rank]};
  const Coord position = index_.coord(p);
  const auto offer = [&](const State& q, int axis, int step) {
    if (q.site == kNoSite || q.site == best.site) return;
    const int away = position[axis] - index_.coord(q.site)[axis];
    const int32_t power = q.power - addedByStep(away, step, map_.weights[axis]);
    if (best.site == kNoSite || power < best.power ||
        (power == best.power && winsTie(position, q.site, best.site)))
      best = {q.site, power};
  };
  forEachNeighbor(index_, p, [&](VoxelId q, int axis, int step) {
    if (!isObject(index_, q)) return;
    const size_t neighbor = index_.rank(q);
    offer({map_.site[neighbor], map_.power[neighbor]}, axis, step);
  });
  if (const auto q = below_.find(p); q != below_.end()) offer(q->second, 2, -1);
  if (const auto q = above_.find(p); q != above_.end()) offer(q->second, 2, 1);
  return best;
}

bool GeodesicCompletion::round(Interrupter* interrupter) {
  // Chunks of words with something to do; each keeps its own list, so nothing depends on threads.
  const std::vector<uint32_t> words = takeFrontWords();
  constexpr size_t kWordsPerChunk = 256;
  changes_.assign((words.size() + kWordsPerChunk - 1) / kWordsPerChunk, {});
  parallelForEach(changes_.size(), 1, interrupter, [&](size_t chunk) {
    const size_t last = std::min(words.size(), (chunk + 1) * kWordsPerChunk);
    for (size_t w = chunk * kWordsPerChunk; w < last; ++w) {
      uint64_t& word = front_.word(words[w]);
      forEachBit(word, [&](int bit) {
        const VoxelId p = VoxelId(words[w]) * 64 + VoxelId(bit);
        const State state = best(p);
        if (state.site != map_.site[index_.rank(p)]) changes_[chunk].push_back({p, state});
      });
      word = 0;
    }
  });
  size_t changed = 0;
  for (const std::vector<Change>& chunk : changes_) changed += chunk.size();
  // To look through all words then takes no longer.
  const bool isMuch = changed > front_.wordCount() / 64;
  std::vector<std::vector<uint32_t>> touched(isMuch ? 0 : changes_.size());
  parallelForEach(changes_.size(), 1, interrupter, [&](size_t chunk) {
    for (const Change& change : changes_[chunk]) {
      const size_t rank = index_.rank(change.voxel);
      map_.site[rank] = change.state.site;
      map_.power[rank] = change.state.power;
      forEachNeighbor(index_, change.voxel, [&](VoxelId q, int, int) {
        if (!uncovered_.contains(q)) return;
        front_.insertAtomic(q);
        if (!isMuch) touched[chunk].push_back(uint32_t(q >> 6));
      });
    }
  });
  std::vector<uint32_t> ahead;
  for (const std::vector<uint32_t>& more : touched)
    ahead.insert(ahead.end(), more.begin(), more.end());
  if (isMuch)
    frontWords_.reset();
  else
    frontWords_ = std::move(ahead);
  return changed > 0;
}

}  // namespace vdb_madf::detail
