// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/cavities.h"

#include <algorithm>
#include <string>
#include <unordered_map>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/detail/small_holes.h"

namespace vdb_madf {

namespace {

using Mask = LeafIndex::Mask;

using detail::beside;
using detail::both;
using detail::without;

struct CoordHash {
  size_t operator()(const Coord& c) const { return c.hash(); }
};

/// Builds the components of the background that may be cavities. Their nodes are the small pieces
/// of background within touched leaves, and whole untouched leaves beside them. A piece that is too
/// large by itself belongs to no cavity, nor does what it touches.
class CavityFinder {
 public:
  CavityFinder(const LeafIndex& object, const std::optional<Domain>& domain, bool open,
               int64_t fillHoles)
      : object_(object), domain_(domain), open_(open), fillHoles_(fillHoles) {}

  Cavities run(Interrupter* interrupter) {
    constexpr size_t kPoll = 1024;
    findPieces(interrupter);
    for (const Piece& piece : pieces_) addNode(int64_t(detail::countVoxels(piece.mask)));
    for (size_t leaf = 0; leaf < object_.leafCount(); ++leaf) {
      if (leaf % kPoll == 0 && interrupter && interrupter->wasInterrupted(-1)) throw Interrupted();
      for (uint32_t i = firstPiece_[leaf]; i < firstPiece_[leaf + 1]; ++i) joinPiece(i);
      addEmptyLeavesBeside(leaf);
    }
    return collect();
  }

 private:
  struct Piece {
    uint32_t leaf;
    Mask mask;
  };

  /// The background of a leaf within the domain.
  Mask background(size_t leaf) const {
    return without(domainMask(object_.origin(leaf)), object_.mask(leaf));
  }
  /// The voxels of the domain in a leaf, touched or not.
  Mask domainMask(const Coord& origin) const {
    return domain_ ? detail::insideMask(*domain_, origin) : detail::kFullMask;
  }
  /// Does background reach the outside, if that is background, too?
  bool reachesFace(const Coord& origin, const Mask& mask) const {
    if (open_) return false;
    const Mask beyond = without(mask, detail::insideMask(object_.boundingBox(), origin));
    if (detail::anyVoxel(beyond)) return true;
    return domain_ && detail::anyVoxel(without(mask, detail::innerMask(*domain_, origin)));
  }

  void findPieces(Interrupter* interrupter) {
    constexpr size_t kChunk = 1024;
    std::vector<std::vector<Piece>> chunks((object_.leafCount() + kChunk - 1) / kChunk);
    firstPiece_.assign(object_.leafCount() + 1, 0);
    detail::parallelForEach(chunks.size(), 1, interrupter, [&](size_t i) {
      const size_t stop = std::min(object_.leafCount(), (i + 1) * kChunk);
      for (size_t leaf = i * kChunk; leaf < stop; ++leaf)
        detail::forEachPiece(background(leaf), [&](const Mask& piece) {
          if (detail::countVoxels(piece) < fillHoles_ && !reachesFace(object_.origin(leaf), piece))
            chunks[i].push_back({uint32_t(leaf), piece});
        });
    });
    size_t count = 0;
    for (const std::vector<Piece>& chunk : chunks) count += chunk.size();
    pieces_.reserve(count);
    for (std::vector<Piece>& chunk : chunks) {
      pieces_.insert(pieces_.end(), chunk.begin(), chunk.end());
      chunk = {};
    }
    for (const Piece& piece : pieces_) ++firstPiece_[piece.leaf + 1];
    for (size_t leaf = 0; leaf < object_.leafCount(); ++leaf)
      firstPiece_[leaf + 1] += firstPiece_[leaf];
  }

  uint32_t addNode(int64_t size) {
    size_.push_back(size);
    outside_.push_back(false);
    return sets_.add();
  }

  void unite(uint32_t a, uint32_t b) {
    a = sets_.find(a);
    b = sets_.find(b);
    if (a == b) return;
    sets_.unite(a, b);
    const uint32_t root = sets_.find(a);
    size_[root] = size_[a] + size_[b];
    outside_[root] = outside_[a] || outside_[b] || size_[root] >= fillHoles_;
  }
  void markOutside(uint32_t node) { outside_[sets_.find(node)] = true; }
  bool isOutside(uint32_t node) { return outside_[sets_.find(node)]; }

  /// Joins what a piece touches in the six leaves around it.
  void joinPiece(uint32_t i) {
    const Piece& piece = pieces_[i];
    // Once it is known to be no cavity, those beside it find that out from their own side.
    for (size_t side = 0; side < 6 && !isOutside(i); ++side) {
      Mask touched = detail::across(piece.mask, side);
      if (!detail::anyVoxel(touched)) continue;
      const uint32_t next = object_.neighbors(piece.leaf)[side];
      if (next != LeafIndex::kNone) {
        joinTouched(i, next, touched);
        continue;
      }
      const Coord origin = beside(object_.origin(piece.leaf), side);
      if (detail::anyVoxel(both(touched, domainMask(origin)))) unite(i, emptyLeaf(origin));
    }
  }

  /// The untouched leaves at a face that is all object: no piece of background leads into them.
  void addEmptyLeavesBeside(size_t leaf) {
    for (size_t side = 0; side < 6; ++side) {
      if (object_.neighbors(leaf)[side] != LeafIndex::kNone) continue;
      const Coord origin = beside(object_.origin(leaf), side);
      const Mask mask = domainMask(origin);
      const uint32_t voxels = detail::countVoxels(mask);
      if (voxels > 0 && voxels < fillHoles_ && !reachesFace(origin, mask)) emptyLeaf(origin);
    }
  }

  /// Joins a node with the small pieces of a leaf that hold some of the voxels.
  void joinTouched(uint32_t node, uint32_t leaf, const Mask& voxels) {
    Mask rest = both(background(leaf), voxels);
    for (uint32_t i = firstPiece_[leaf]; i < firstPiece_[leaf + 1] && detail::anyVoxel(rest); ++i) {
      if (!detail::meet(pieces_[i].mask, rest)) continue;
      unite(node, i);
      rest = without(rest, pieces_[i].mask);
    }
    if (detail::anyVoxel(rest)) markOutside(node);  // a large piece
  }

  /// The node of an untouched leaf that has voxels of the domain. On the way all that are connected
  /// with it, until they are too many for a cavity.
  uint32_t emptyLeaf(const Coord& start) {
    if (const auto known = empty_.find(start); known != empty_.end()) return known->second;
    const uint32_t node = addEmptyLeaf(start);
    std::vector<Coord> front{start};
    while (!front.empty() && !isOutside(node)) {
      const Coord origin = front.back();
      front.pop_back();
      const Mask here = domainMask(origin);
      for (size_t side = 0; side < 6 && !isOutside(node); ++side) {
        const Coord next = beside(origin, side);
        const Mask touched = both(detail::across(here, side), domainMask(next));
        if (!detail::anyVoxel(touched)) continue;
        if (const auto leaf = object_.findLeaf(next)) {
          joinTouched(node, *leaf, touched);
        } else if (const auto known = empty_.find(next); known != empty_.end()) {
          unite(node, known->second);
        } else {
          unite(node, addEmptyLeaf(next));
          front.push_back(next);
        }
      }
    }
    return node;
  }
  uint32_t addEmptyLeaf(const Coord& origin) {
    const Mask mask = domainMask(origin);
    const uint32_t node = addNode(int64_t(detail::countVoxels(mask)));
    if (size_[node] >= fillHoles_ || reachesFace(origin, mask)) markOutside(node);
    empty_.emplace(origin, node);
    if (empty_.size() > kMaxLeaves)
      throw InvalidInput("cavities of fewer than " + std::to_string(fillHoles_) +
                         " voxels take too many leaf nodes to look for: fill smaller ones");
    return node;
  }

  Cavities collect() {
    Cavities found;
    for (uint32_t node = 0; node < size_.size(); ++node) {
      if (sets_.find(node) != node || outside_[node]) continue;
      ++found.count;
      found.voxels += size_[node];
    }
    for (uint32_t i = 0; i < pieces_.size(); ++i) {
      if (isOutside(i)) continue;
      const Coord& origin = object_.origin(pieces_[i].leaf);
      if (found.leaves.empty() || found.leaves.back().origin != origin)
        found.leaves.push_back({origin, Mask{}});
      for (size_t x = 0; x < 8; ++x) found.leaves.back().mask[x] |= pieces_[i].mask[x];
    }
    for (const auto& [origin, node] : empty_)
      if (!isOutside(node)) found.leaves.push_back({origin, domainMask(origin)});
    std::sort(found.leaves.begin(), found.leaves.end(), ByOrigin());
    return found;
  }

  const LeafIndex& object_;
  std::optional<Domain> domain_;
  bool open_;
  int64_t fillHoles_;
  std::vector<Piece> pieces_;         // ascending by leaf; the first nodes
  std::vector<uint32_t> firstPiece_;  // per leaf; one more at the end
  std::unordered_map<Coord, uint32_t, CoordHash> empty_;
  detail::DisjointSets sets_{0};
  std::vector<int64_t> size_;  // of a component, at its root
  std::vector<bool> outside_;  // no cavity, at the root
};

/// The object, and without a voxel of it the leaves of a region of which only a part is inside:
/// other untouched ones are in one piece.
LeafIndex withPartialLeaves(const LeafIndex& object, const MaskTree& region) {
  std::vector<LeafIndex::LeafVoxels> leaves;
  for (auto leaf = region.cbeginLeaf(); leaf; ++leaf) leaves.push_back({leaf->origin(), Mask{}});
  std::sort(leaves.begin(), leaves.end(), ByOrigin());
  return {object, leaves};
}

}  // namespace

int64_t defaultFillHoles(const std::optional<Domain>& domain) {
  return domain && domain->flatAxis() ? 0 : kFillHoles;
}

Cavities detail::smallHoles(const LeafIndex& object, const std::optional<Domain>& domain, bool open,
                            int64_t fillHoles, Interrupter* interrupter) {
  if (domain && !domain->isBox())
    return CavityFinder(withPartialLeaves(object, *domain->region()), domain, open, fillHoles)
        .run(interrupter);
  return CavityFinder(object, domain, open, fillHoles).run(interrupter);
}

Cavities findCavities(const LeafIndex& object, const std::optional<Domain>& domain, bool open,
                      int64_t fillHoles, Interrupter* interrupter) {
  if (fillHoles <= 1 || object.voxelCount() == 0) return {};
  const __int128 background = open && domain ? domain->voxelCount() - object.voxelCount() : 0;
  if (open && background < fillHoles) return {};  // all of it would be filled
  Cavities found = detail::smallHoles(object, domain, open, fillHoles, interrupter);
  if (open && background == found.voxels) return {};
  return found;
}

std::vector<VoxelId> cavityVoxels(const LeafIndex& body, const Cavities& cavities) {
  std::vector<VoxelId> ids;
  ids.reserve(size_t(cavities.voxels));
  for (const LeafIndex::LeafVoxels& leaf : cavities.leaves) {
    const uint32_t number = *body.findLeaf(leaf.origin);
    for (uint32_t x = 0; x < 8; ++x)
      detail::forEachBit(leaf.mask[x],
                         [&](int bit) { ids.push_back(voxelId(number, x, size_t(bit))); });
  }
  return ids;
}

}  // namespace vdb_madf
