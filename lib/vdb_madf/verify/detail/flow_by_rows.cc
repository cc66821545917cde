// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/verify/detail/flow_by_rows.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

/// The 6-connected component of a voxel, whose voxels `isIn`; they are not in it afterwards.
template <typename IsIn, typename Take>
std::vector<int32_t> component(const DenseBox& space, int64_t first, const IsIn& isIn,
                               const Take& take) {
  std::vector<int32_t> part{int32_t(first)};
  take(first);
  for (size_t next = 0; next < part.size(); ++next)
    space.forNeighbors(part[next], [&](int64_t q) {
      if (!isIn(q)) return;
      take(q);
      part.push_back(int32_t(q));
    });
  return part;
}

/// The ball of least power at each voxel, where that is negative, among those of some centers (the
/// voxels that are their own site): along one axis after the other, looking away from each voxel
/// for as long as a ball of that row could still be better.
Sites leastPower(const DenseBox& space, const Definition& definition,
                 const std::vector<int32_t>& distance, Sites site, Interrupter* interrupter) {
  struct Ball {
    int64_t power = 0;
    int32_t site = kNone;
  };
  // Voxels are numbered in the order of coordinates. Only negative powers are compared.
  const auto isBetter = [&](const Ball& a, const Ball& b) {
    if (a.power != b.power || b.site == kNone) return a.power < b.power;
    const int32_t da = distance[size_t(a.site)], db = distance[size_t(b.site)];
    return da != db ? da > db : a.site < b.site;
  };
  std::vector<int32_t> power(site.size(), 0);
  for (size_t i = 0; i < site.size(); ++i)
    if (site[i] != kNone) power[i] = -distance[i];
  for (const int axis : {2, 1, 0}) {
    const int64_t n = space.size(axis), stride = space.stride(axis),
                  weight = definition.weights[size_t(axis)];
    space.forRows(axis, interrupter, [&](int64_t first) {
      std::vector<Ball> row(size_t(n), Ball{});
      for (int64_t i = 0; i < n; ++i) {
        const auto at = size_t(first + i * stride);
        row[size_t(i)] = {power[at], site[at]};
      }
      // The least power from a place on, to either side.
      std::vector<int64_t> below(size_t(n), 0), above(size_t(n), 0);
      int64_t least = 0;
      for (int64_t i = 0; i < n; ++i)
        below[size_t(i)] = least = std::min(least, row[size_t(i)].power);
      if (least == 0) return;
      least = 0;
      for (int64_t i = n - 1; i >= 0; --i)
        above[size_t(i)] = least = std::min(least, row[size_t(i)].power);
      for (int64_t i = 0; i < n; ++i) {
        Ball best = row[size_t(i)];
        const auto look = [&](int64_t to, const std::vector<int64_t>& bound) {
          for (int64_t j = i + to, t = 1; j >= 0 && j < n; j += to, ++t) {
            const int64_t step = weight * t * t, any = bound[size_t(j)] + step;
            if (any > best.power || any >= 0) break;
            const Ball ball{row[size_t(j)].power + step, row[size_t(j)].site};
            if (ball.power < 0 && isBetter(ball, best)) best = ball;
          }
        };
        look(-1, below);
        look(1, above);
        const auto at = size_t(first + i * stride);
        power[at] = int32_t(best.power);
        site[at] = best.site;
      }
    });
  }
  return site;
}

/// Of two sites that are offered to a voxel, the better one.
int32_t betterSite(const DenseBox& space, const Definition& definition,
                   const std::vector<int32_t>& distance, int64_t p, int32_t a, int32_t b) {
  if (a == kNone || a == b) return b;
  if (b == kNone) return a;
  const int64_t da = distance[size_t(a)], db = distance[size_t(b)],
                powerA = space.squaredLength(p, a, definition.weights) - da,
                powerB = space.squaredLength(p, b, definition.weights) - db;
  if (powerA != powerB) return powerA < powerB ? a : b;
  if (da != db) return da > db ? a : b;
  return std::min(a, b);
}

/// The centers of the balls that gamma keeps.
Sites keptBalls(const DenseBox& space, const Definition& definition, const Voxels& voxels,
                const std::vector<int32_t>& distance, const Sites& site,
                const std::vector<int32_t>& cell) {
  const auto isGreater = [&](int32_t a, int32_t b) {
    if (b == kNone || distance[size_t(a)] != distance[size_t(b)])
      return b == kNone || distance[size_t(a)] > distance[size_t(b)];
    return a < b;
  };
  Sites kept(site.size(), kNone);
  std::vector<char> seen(site.size(), 0);
  for (size_t i = 0; i < site.size(); ++i) {
    if (!isBody(voxels[i]) || seen[i]) continue;
    const auto part = component(
        space, int64_t(i), [&](int64_t q) { return isBody(voxels[size_t(q)]) && !seen[size_t(q)]; },
        [&](int64_t q) { seen[size_t(q)] = 1; });
    bool isServed = false;
    int32_t own = kNone, other = kNone;  // the greatest with its center here, or that serves here
    for (const int32_t p : part) {
      if (cell[size_t(p)] > 0 && isGreater(p, own)) own = p;
      if (isGreater(site[size_t(p)], other)) other = site[size_t(p)];
      if (cell[size_t(p)] == 0 || cell[size_t(p)] < definition.gamma) continue;
      kept[size_t(p)] = p;
      isServed = true;
    }
    if (isServed) continue;
    const int32_t best = own != kNone ? own : other;
    kept[size_t(best)] = best;
  }
  return kept;
}

/// Voxels that no kept ball covers take the best that they and their neighbors had, round by round.
void complete(const DenseBox& space, const Definition& definition, const Voxels& voxels,
              const std::vector<int32_t>& distance, Sites& site, Interrupter* interrupter) {
  std::vector<char> isCovered(site.size(), 0), isDue(site.size(), 0);
  std::vector<int32_t> due;
  for (size_t i = 0; i < site.size(); ++i) {
    isCovered[i] = site[i] != kNone;
    if (isBody(voxels[i]) && !isCovered[i]) due.push_back(int32_t(i));
  }
  while (!due.empty()) {
    if (interrupter && interrupter->wasInterrupted()) throw Interrupted();
    std::vector<std::pair<int32_t, int32_t>> changes;
    for (const int32_t p : due) {
      isDue[size_t(p)] = 0;
      int32_t best = site[size_t(p)];
      space.forNeighbors(p, [&](int64_t q) {
        if (isBody(voxels[size_t(q)]))
          best = betterSite(space, definition, distance, p, best, site[size_t(q)]);
      });
      if (best != site[size_t(p)]) changes.emplace_back(p, best);
    }
    for (const auto& [p, best] : changes) site[size_t(p)] = best;
    due.clear();
    for (const auto& change : changes)
      space.forNeighbors(change.first, [&](int64_t q) {
        if (!isBody(voxels[size_t(q)]) || isCovered[size_t(q)] || isDue[size_t(q)]) return;
        isDue[size_t(q)] = 1;
        due.push_back(int32_t(q));
      });
  }
}

}  // namespace

int64_t fillCavities(const DenseBox& space, const Definition& definition, Voxels& voxels) {
  if (definition.fillHoles == 0) return 0;
  std::vector<char> seen(voxels.size(), 0);
  std::vector<int32_t> filled;
  int64_t cavities = 0, background = 0;
  for (size_t i = 0; i < voxels.size(); ++i) {
    if (voxels[i] != Voxel::background) continue;
    ++background;
    if (seen[i]) continue;
    const auto part = component(
        space, int64_t(i),
        [&](int64_t q) { return voxels[size_t(q)] == Voxel::background && !seen[size_t(q)]; },
        [&](int64_t q) { seen[size_t(q)] = 1; });
    if (int64_t(part.size()) >= definition.fillHoles) continue;
    bool reachesOutside = false;
    for (const int32_t p : part) {
      int inside = 0;
      space.forNeighbors(p, [&](int64_t q) { inside += voxels[size_t(q)] != Voxel::unknown; });
      reachesOutside |= inside < 6;
    }
    if (!definition.open && reachesOutside) continue;
    ++cavities;
    filled.insert(filled.end(), part.begin(), part.end());
  }
  if (definition.open && int64_t(filled.size()) == background) return 0;
  for (const int32_t p : filled) voxels[size_t(p)] = Voxel::cavity;
  return cavities;
}

std::vector<int32_t> squaredDistance(const DenseBox& space, const Definition& definition,
                                     const Voxels& voxels, Interrupter* interrupter) {
  // With the closed boundary what is outside of the domain is background, too.
  std::vector<int32_t> distance(voxels.size());
  for (size_t i = 0; i < voxels.size(); ++i)
    distance[i] =
        voxels[i] == Voxel::background || (!definition.open && voxels[i] == Voxel::unknown) ? 0
                                                                                            : kFar;
  for (const int axis : {2, 1, 0}) {
    const int64_t n = space.size(axis), stride = space.stride(axis),
                  weight = definition.weights[size_t(axis)];
    space.forRows(axis, interrupter, [&](int64_t first) {
      std::vector<int64_t> row(size_t(n), 0);
      for (int64_t i = 0; i < n; ++i) row[size_t(i)] = distance[size_t(first + i * stride)];
      for (int64_t i = 0; i < n; ++i) {
        int64_t best = row[size_t(i)];
        if (!definition.open) {
          const int64_t out = std::min(i + 1, n - i);
          best = std::min(best, weight * out * out);
        }
        for (int64_t t = 1; t < n && weight * t * t < best; ++t)
          for (const int64_t j : {i - t, i + t})
            if (j >= 0 && j < n) best = std::min(best, row[size_t(j)] + weight * t * t);
        distance[size_t(first + i * stride)] = int32_t(best);
      }
    });
  }
  return distance;
}

Flow flowOf(const DenseBox& space, const Definition& definition, const Voxels& voxels,
            const std::vector<int32_t>& distance, Interrupter* interrupter) {
  Flow flow;
  Sites site(voxels.size(), kNone);  // first all centers
  for (size_t i = 0; i < site.size(); ++i)
    if (isBody(voxels[i])) site[i] = int32_t(i);
  site = leastPower(space, definition, distance, std::move(site), interrupter);
  std::vector<int32_t> cell(site.size(), 0);
  for (size_t i = 0; i < site.size(); ++i) {
    if (!isBody(voxels[i])) site[i] = kNone;
    if (isBody(voxels[i]) && cell[size_t(site[i])]++ == 0) ++flow.medialBalls;
  }
  flow.keptBalls = flow.medialBalls;
  if (definition.gamma > 0) {
    site = keptBalls(space, definition, voxels, distance, site, cell);
    cell = {};
    flow.keptBalls = int64_t(site.size()) - std::count(site.begin(), site.end(), kNone);
    site = leastPower(space, definition, distance, std::move(site), interrupter);
    for (size_t i = 0; i < site.size(); ++i)
      if (!isBody(voxels[i])) site[i] = kNone;
    complete(space, definition, voxels, distance, site, interrupter);
  }
  cell = {};
  flow.critical.assign(site.size(), kNone);
  for (size_t i = 0; i < site.size(); ++i) {
    if (site[i] == kNone) continue;
    auto c = int32_t(i);
    for (int32_t next = site[i]; next != c; c = next, next = site[size_t(c)])
      if (c != int32_t(i) && distance[size_t(next)] <= distance[size_t(c)])
        throw std::logic_error("verify: the flow does not climb");
    flow.critical[i] = c;
  }
  flow.site = std::move(site);
  return flow;
}

}  // namespace vdb_madf::detail
