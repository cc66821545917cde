// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/tidy.h"

#include <algorithm>
#include <string>
#include <tuple>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/leaves/detail/label_masks.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/detail/refill.h"
#include "vdb_madf/method/detail/tidy_steps.h"

namespace vdb_madf {

namespace {

using detail::AnchorCandidate;
using detail::kNoAnchor;

/// The anchor of grain g at g - 1.
std::vector<VoxelId> findAnchors(const LeafIndex& index, const GrainLabels& grains,
                                 Interrupter* interrupter) {
  std::vector<VoxelId> anchor(grains.representative.size(), kNoAnchor);
  std::vector<uint32_t> lost;
  for (uint32_t g = 0; g < anchor.size(); ++g) {
    const auto voxel = index.findVoxel(grains.representative[g]);
    if (voxel && grains.label[index.rank(*voxel)] == g + 1)
      anchor[g] = *voxel;
    else
      lost.push_back(g);
  }
  if (lost.empty()) return anchor;
  const auto best = detail::anchorCandidates(index, grains, lost, interrupter);
  for (size_t i = 0; i < lost.size(); ++i)
    if (best[i].away >= 0) anchor[lost[i]] = *index.findVoxel(best[i].position);
  return anchor;
}

/// A voxel that is not connected with the anchor of its grain, and the label it lost.
struct LooseVoxel {
  VoxelId id;
  uint32_t lost;
};

std::vector<LooseVoxel> looseVoxels(const LeafIndex& index, const detail::LabelMasks& masks,
                                    const std::vector<VoxelId>& anchor, Interrupter* interrupter) {
  const detail::ConnectedComponents components(index, masks, interrupter);
  std::vector<char> held(components.count(), 0);
  for (const VoxelId id : anchor)
    if (id != kNoAnchor) held[components.componentOf(id)] = 1;
  std::vector<LooseVoxel> loose;
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece) {
      if (held[piece->component]) continue;
      for (uint32_t x = 0; x < 8; ++x)
        detail::forEachBit(piece->mask[x], [&](int bit) {
          loose.push_back({voxelId(leaf, x, size_t(bit)), piece->label});
        });
    }
  return loose;
}

void moveVoxel(VoxelId id, uint32_t label, detail::LabelMasks& masks) {
  LeafIndex::Mask voxel{};
  voxel[wordOf(id)] = uint64_t(1) << bitOf(id);
  masks.give(leafOf(id), label, voxel);
}

/// Gives every voxel that is not connected with its grain's anchor to a neighbor. Returns whether
/// each found one: then each grain is connected.
bool connect(const LeafIndex& index, const std::vector<VoxelId>& anchor, detail::LabelMasks& masks,
             GrainLabels& grains, Interrupter* interrupter) {
  const std::vector<LooseVoxel> loose = looseVoxels(index, masks, anchor, interrupter);
  for (const LooseVoxel& voxel : loose) grains.label[index.rank(voxel.id)] = 0;
  const auto around = [&](uint32_t i) {
    return detail::labelsAround(index, grains.label, loose[i].id);
  };
  const auto give = [&](uint32_t i, uint32_t label) {
    grains.label[index.rank(loose[i].id)] = label;
    moveVoxel(loose[i].id, label, masks);
    --grains.voxels[loose[i].lost - 1];
    ++grains.voxels[label - 1];
  };
  std::vector<VoxelId> ids;
  for (const LooseVoxel& voxel : loose) ids.push_back(voxel.id);
  const detail::NumberedVoxels numbers(index, ids);
  const auto beside = [&](uint32_t i, const auto& f) { numbers.forEachBeside(ids[i], f); };
  const auto unreached = detail::refill(loose.size(), around, give, beside, interrupter);
  for (const uint32_t i : unreached) grains.label[index.rank(loose[i].id)] = loose[i].lost;
  return unreached.empty();
}

}  // namespace

void detail::AnchorCandidate::improve(const AnchorCandidate& other) {
  if (other.away < 0) return;
  if (away < 0 || std::tie(other.away, other.position) < std::tie(away, position)) *this = other;
}

std::vector<AnchorCandidate> detail::anchorCandidates(const LeafIndex& index,
                                                      const GrainLabels& grains,
                                                      const std::vector<uint32_t>& wanted,
                                                      Interrupter* interrupter) {
  std::vector<uint32_t> placeOf(grains.representative.size() + 1, 0);  // of a label, plus 1
  for (uint32_t i = 0; i < wanted.size(); ++i) placeOf[wanted[i] + 1] = i + 1;
  PerThread<std::vector<AnchorCandidate>> found{std::vector<AnchorCandidate>(wanted.size())};
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    std::vector<AnchorCandidate>& best = found.local();
    forEachVoxel(index, begin, end, [&](VoxelId id, size_t rank) {
      const uint32_t label = grains.label[rank], place = placeOf[label];
      if (place == 0) return;
      const Coord p = index.coord(id);
      best[place - 1].improve(
          {squaredBetween(p, grains.representative[label - 1], grains.weights), p});
    });
  });
  std::vector<AnchorCandidate> best(wanted.size());
  for (const std::vector<AnchorCandidate>& part : found)
    for (size_t i = 0; i < wanted.size(); ++i) best[i].improve(part[i]);
  return best;
}

uint32_t detail::mostFrequent(const LabelsAround& around) {
  uint32_t best = 0;
  int64_t most = 0;
  for (const uint32_t label : around) {
    if (label == 0) continue;
    const int64_t same = std::count(around.begin(), around.end(), label);
    if (same > most || (same == most && label < best)) {
      best = label;
      most = same;
    }
  }
  return best;
}

bool detail::tidyMasks(const LeafIndex& index, int rounds, LabelMasks& masks, GrainLabels& grains,
                       Interrupter* interrupter) {
  const std::vector<VoxelId> anchor = findAnchors(index, grains, interrupter);
  smoothInterfaces(index, rounds, anchor, masks, grains, interrupter);
  return connect(index, anchor, masks, grains, interrupter);
}

void checkTidy(int rounds) {
  if (rounds < 0 || rounds > kMaxTidy)
    throw InvalidInput("tidy is a number of rounds: it must lie between 0 and " +
                       std::to_string(kMaxTidy));
}

void tidy(const LeafIndex& index, int rounds, GrainLabels& grains, Interrupter* interrupter) {
  checkTidy(rounds);
  if (rounds == 0) return;
  detail::LabelMasks masks(index, grains.label, interrupter);
  detail::tidyMasks(index, rounds, masks, grains, interrupter);
}

}  // namespace vdb_madf
