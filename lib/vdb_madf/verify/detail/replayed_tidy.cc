// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <map>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/verify/detail/replayed_merge.h"

namespace vdb_madf::detail {

namespace {

using Labels = std::vector<int32_t>;

/// What a voxel of the object becomes in a round of smoothing.
int32_t smoothed(const DenseBox& space, const Labels& label, int64_t p) {
  std::array<int32_t, 7> labels{label[size_t(p)]};
  size_t count = 1;
  space.forNeighbors(p, [&](int64_t q) {
    const int32_t other = label[size_t(q)];
    const auto end = labels.begin() + int64_t(count);
    if (other != 0 && std::find(labels.begin(), end, other) == end) labels[count++] = other;
  });
  if (count == 1) return labels[0];
  std::array<int, 7> votes{};
  const auto at = space.place(p);
  for (int64_t x = std::max<int64_t>(0, at[0] - 1); x <= std::min(at[0] + 1, space.size(0) - 1);
       ++x)
    for (int64_t y = std::max<int64_t>(0, at[1] - 1); y <= std::min(at[1] + 1, space.size(1) - 1);
         ++y)
      for (int64_t z = std::max<int64_t>(0, at[2] - 1); z <= std::min(at[2] + 1, space.size(2) - 1);
           ++z) {
        const int32_t seen = label[size_t(x * space.stride(0) + y * space.stride(1) + z)];
        for (size_t i = 0; i < count; ++i) votes[i] += labels[i] == seen;
      }
  const int most = *std::max_element(votes.begin(), votes.end());
  if (votes[0] == most) return labels[0];
  int32_t best = INT32_MAX;
  for (size_t i = 0; i < count; ++i)
    if (votes[i] == most) best = std::min(best, labels[i]);
  return best;
}

/// Of each grain the voxel that is nearest to its representative.
Labels anchorsOf(const DenseBox& space, const Definition& definition, const Manifolds& manifolds,
                 const Grains& grains, const Labels& label) {
  Labels anchors(grains.representative.size(), kNone);
  std::vector<int64_t> nearest(anchors.size(), INT64_MAX);
  for (int64_t p = 0; p < space.count(); ++p) {
    if (label[size_t(p)] == 0) continue;
    const auto g = size_t(label[size_t(p)] - 1);
    const int64_t apart = space.squaredLength(
        p, manifolds.nodes[size_t(grains.representative[g])].at, definition.weights);
    if (apart >= nearest[g]) continue;
    nearest[g] = apart;
    anchors[g] = int32_t(p);
  }
  return anchors;
}

}  // namespace

void tidyUp(const DenseBox& space, const Definition& definition, const Manifolds& manifolds,
            const Grains& grains, std::vector<int32_t>& label, Interrupter* interrupter) {
  if (definition.tidy == 0) return;
  const Labels anchors = anchorsOf(space, definition, manifolds, grains, label);
  Labels before;
  for (int64_t round = 0; round < definition.tidy; ++round) {
    before = label;
    space.forAll(interrupter, [&](int64_t p) {
      if (before[size_t(p)] != 0) label[size_t(p)] = smoothed(space, before, p);
    });
    for (const int32_t anchor : anchors) label[size_t(anchor)] = before[size_t(anchor)];
    if (label == before) break;
  }

  std::vector<char> isHeld(label.size(), 0);
  Labels front = anchors;
  for (const int32_t p : front) isHeld[size_t(p)] = 1;
  while (!front.empty()) {
    const int32_t p = front.back();
    front.pop_back();
    space.forNeighbors(p, [&](int64_t q) {
      if (label[size_t(q)] != label[size_t(p)] || isHeld[size_t(q)]) return;
      isHeld[size_t(q)] = 1;
      front.push_back(int32_t(q));
    });
  }
  std::vector<std::pair<int32_t, int32_t>> loose;  // with the labels that they had
  for (size_t p = 0; p < label.size(); ++p)
    if (label[p] != 0 && !isHeld[p]) loose.emplace_back(int32_t(p), label[p]);
  for (const auto& voxel : loose) label[size_t(voxel.first)] = 0;
  for (bool isChanged = true; isChanged;) {
    if (interrupter && interrupter->wasInterrupted()) throw Interrupted();
    std::vector<std::pair<int32_t, int32_t>> changes, left;
    for (const auto& voxel : loose) {
      std::map<int32_t, int> faces;
      space.forNeighbors(voxel.first, [&](int64_t q) {
        if (label[size_t(q)] != 0) ++faces[label[size_t(q)]];
      });
      std::pair<int32_t, int> best{0, 0};
      for (const auto& one : faces)  // ascending
        if (one.second > best.second) best = one;
      if (best.second > 0)
        changes.emplace_back(voxel.first, best.first);
      else
        left.push_back(voxel);
    }
    for (const auto& [p, to] : changes) label[size_t(p)] = to;
    isChanged = !changes.empty();
    loose = std::move(left);
  }
  for (const auto& [p, had] : loose) label[size_t(p)] = had;
}

}  // namespace vdb_madf::detail
