// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/tidy.h"

#include <algorithm>
#include <string>
#include <tuple>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_neighborhood.h"
#include "vdb_madf/leaves/detail/leaf_values.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/label_block.h"
#include "vdb_madf/method/detail/metric.h"
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

/// The synchronous rounds of smoothing. A round only looks at leaves where something may change:
/// first those with an interface, then those that see a change of the round before.
class Smoothing {
 public:
  Smoothing(const LeafIndex& index, GrainLabels& grains, const std::vector<VoxelId>& anchor)
      : index_(index), grains_(grains), anchor_(anchor) {}

  void run(int rounds, Interrupter* interrupter) {
    std::vector<uint32_t> leaves = leavesWithInterfaces(interrupter);
    for (int round = 0; round < rounds && !leaves.empty(); ++round) {
      const std::vector<std::vector<Change>> changes = decide(leaves, interrupter);
      leaves = apply(changes);
    }
  }

 private:
  struct Change {
    VoxelId voxel;
    uint32_t label;
  };

  /// The leaves with more than one label, or beside a leaf with another one.
  std::vector<uint32_t> leavesWithInterfaces(Interrupter* interrupter) const {
    std::vector<uint32_t> only(index_.leafCount());  // label of all voxels of a leaf; 0: several
    detail::parallelFor(
        only.size(), detail::kLeafGrain, interrupter, [&](size_t begin, size_t end) {
          for (size_t leaf = begin; leaf < end; ++leaf) {
            const uint32_t* labels = grains_.label.data() + index_.firstRank(leaf);
            only[leaf] = detail::allEqual(labels, index_.leafVoxels(leaf)) ? labels[0] : 0;
          }
        });
    std::vector<uint32_t> leaves;
    for (uint32_t leaf = 0; leaf < only.size(); ++leaf) {
      bool alone = only[leaf] != 0;
      for (const uint32_t next : index_.neighbors(leaf))
        alone = alone && (next == LeafIndex::kNone || only[next] == only[leaf]);
      if (!alone) leaves.push_back(leaf);
    }
    return leaves;
  }

  /// What a round changes, by chunks of leaves in rising order.
  std::vector<std::vector<Change>> decide(const std::vector<uint32_t>& leaves,
                                          Interrupter* interrupter) const {
    std::vector<std::vector<Change>> changes((leaves.size() + kChunk - 1) / kChunk);
    detail::parallelFor(changes.size(), 1, interrupter, [&](size_t begin, size_t end) {
      detail::LeafNeighborhood neighborhood(index_);
      detail::LabelBlock block;
      const size_t stop = std::min(leaves.size(), end * kChunk);
      for (size_t i = begin * kChunk; i < stop; ++i) {
        const std::array<uint32_t, 27>& around = neighborhood.around(leaves[i]);
        block.loadFaces(index_, grains_.label, around);
        const LeafIndex::Mask interfaces = block.interfaces();
        if (!detail::anyVoxel(interfaces)) continue;
        block.loadEdges(index_, grains_.label, around);
        detail::LabelBlock::Change found[512];
        const size_t count = block.smooth(interfaces, found);
        for (size_t k = 0; k < count; ++k) {
          const VoxelId voxel = leaves[i] * 512 + found[k].offset;
          if (anchor_[block.at(found[k].offset) - 1] != voxel)
            changes[i / kChunk].push_back({voxel, found[k].label});
        }
      }
    });
    return changes;
  }

  /// The leaves that see one of the changes, ascending.
  std::vector<uint32_t> apply(const std::vector<std::vector<Change>>& changes) {
    std::vector<char> sees(index_.leafCount(), 0);
    detail::LeafNeighborhood neighborhood(index_);
    for (const std::vector<Change>& chunk : changes)
      for (const Change& change : chunk) {
        uint32_t& label = grains_.label[index_.rank(change.voxel)];
        --grains_.voxels[label - 1];
        label = change.label;
        ++grains_.voxels[label - 1];
        markLeaves(neighborhood.around(leafOf(change.voxel)), offsetOf(change.voxel), sees);
      }
    std::vector<uint32_t> leaves;
    for (uint32_t leaf = 0; leaf < sees.size(); ++leaf)
      if (sees[leaf]) leaves.push_back(leaf);
    return leaves;
  }

  /// The leaf of a voxel, and those whose layer of neighbors holds it.
  static void markLeaves(const std::array<uint32_t, 27>& around, uint32_t offset,
                         std::vector<char>& sees) {
    const uint32_t t[3] = {offset >> 6, offset >> 3 & 7, offset & 7};
    uint32_t first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
      first[axis] = t[axis] == 0 ? 0 : 1;
      last[axis] = t[axis] == 7 ? 2 : 1;
    }
    for (uint32_t x = first[0]; x <= last[0]; ++x)
      for (uint32_t y = first[1]; y <= last[1]; ++y)
        for (uint32_t z = first[2]; z <= last[2]; ++z)
          if (const uint32_t leaf = around[x * 9 + y * 3 + z]; leaf != LeafIndex::kNone)
            sees[leaf] = 1;
  }

  static constexpr size_t kChunk = 64;
  const LeafIndex& index_;
  GrainLabels& grains_;
  const std::vector<VoxelId>& anchor_;
};

/// A voxel that is not connected with the anchor of its grain, and the label it lost.
struct LooseVoxel {
  VoxelId id;
  uint32_t lost;
};

std::vector<LooseVoxel> looseVoxels(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                    const std::vector<VoxelId>& anchor, Interrupter* interrupter) {
  const detail::ConnectedComponents components(index, labels, interrupter);
  std::vector<char> held(components.count(), 0);
  for (const VoxelId id : anchor)
    if (id != kNoAnchor) held[components.componentOf(id)] = 1;
  std::vector<LooseVoxel> loose;
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece) {
      if (held[piece->component]) continue;
      for (uint32_t x = 0; x < 8; ++x)
        detail::forEachBit(piece->mask[x], [&](int bit) {
          loose.push_back({leaf * 512 + x * 64 + uint32_t(bit), piece->label});
        });
    }
  return loose;
}

uint32_t mostFrequentAround(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                            VoxelId id) {
  uint32_t around[6] = {}, count = 0;
  detail::forEachNeighbor(index, id, [&](VoxelId q, int, int) {
    if (detail::isObject(index, q)) around[count++] = labels[index.rank(q)];
  });
  return detail::mostFrequent(around);
}

/// Gives every voxel that is not connected with its grain's anchor to a neighbor.
void connect(const LeafIndex& index, const std::vector<VoxelId>& anchor, GrainLabels& grains,
             Interrupter* interrupter) {
  constexpr size_t kVoxelGrain = 1024;
  std::vector<LooseVoxel> loose = looseVoxels(index, grains.label, anchor, interrupter);
  for (const LooseVoxel& voxel : loose) grains.label[index.rank(voxel.id)] = 0;
  std::vector<uint32_t> found;
  for (bool changed = true; changed && !loose.empty();) {
    found.resize(loose.size());
    detail::parallelFor(loose.size(), kVoxelGrain, interrupter, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        found[i] = mostFrequentAround(index, grains.label, loose[i].id);
    });
    size_t left = 0;
    for (size_t i = 0; i < loose.size(); ++i) {
      if (found[i] == 0) {
        loose[left++] = loose[i];
        continue;
      }
      grains.label[index.rank(loose[i].id)] = found[i];
      --grains.voxels[loose[i].lost - 1];
      ++grains.voxels[found[i] - 1];
    }
    changed = left < loose.size();
    loose.resize(left);
  }
  for (const LooseVoxel& voxel : loose) grains.label[index.rank(voxel.id)] = voxel.lost;
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

void detail::smoothInterfaces(const LeafIndex& index, int rounds,
                              const std::vector<VoxelId>& anchor, GrainLabels& grains,
                              Interrupter* interrupter) {
  Smoothing(index, grains, anchor).run(rounds, interrupter);
}

uint32_t detail::mostFrequent(const uint32_t (&around)[6]) {
  uint32_t best = 0;
  int64_t most = 0;
  for (const uint32_t label : around) {
    if (label == 0) continue;
    const int64_t same = std::count(around, around + 6, label);
    if (same > most || (same == most && label < best)) {
      best = label;
      most = same;
    }
  }
  return best;
}

void checkTidy(int rounds) {
  if (rounds < 0 || rounds > kMaxTidy)
    throw InvalidInput("tidy is a number of rounds: it must lie between 0 and " +
                       std::to_string(kMaxTidy));
}

void tidy(const LeafIndex& index, int rounds, GrainLabels& grains, Interrupter* interrupter) {
  checkTidy(rounds);
  if (rounds == 0) return;
  const std::vector<VoxelId> anchor = findAnchors(index, grains, interrupter);
  detail::smoothInterfaces(index, rounds, anchor, grains, interrupter);
  connect(index, anchor, grains, interrupter);
}

}  // namespace vdb_madf
