// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/label_flaws.h"

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_neighborhood.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/grain_flags.h"
#include "vdb_madf/method/detail/label_block.h"

namespace vdb_madf {

namespace {

using Mask = LeafIndex::Mask;
using Piece = detail::ConnectedComponents::Piece;

/// One flag a grain, set by any thread.
bool isSet(const std::vector<char>& flags, uint32_t label) {
  return __atomic_load_n(&flags[label - 1], __ATOMIC_RELAXED) != 0;
}
void setFlag(std::vector<char>& flags, uint32_t label) {
  __atomic_store_n(&flags[label - 1], char(1), __ATOMIC_RELAXED);
}

/// The voxels of a mask with the 26 around them in it too, as far as the leaf tells.
Mask erode(const Mask& mask) {
  constexpr uint64_t kInnerZ = ~(detail::kFirstZ | detail::kLastZ);
  Mask planes{};  // along y and z
  for (size_t x = 0; x < 8; ++x) {
    const uint64_t row = mask[x] & mask[x] << 1 & mask[x] >> 1 & kInnerZ;
    planes[x] = row & row << 8 & row >> 8 & ~(detail::kFirstY | detail::kLastY);
  }
  Mask deep{};
  for (size_t x = 1; x < 7; ++x) deep[x] = planes[x - 1] & planes[x] & planes[x + 1];
  return deep;
}

class FlawFinder {
 public:
  FlawFinder(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
             const detail::ConnectedComponents& components, const std::optional<Domain>& domain)
      : index_(index), labels_(labels), components_(components), domain_(domain) {}

  /// Has a piece a voxel that is two layers deep?
  bool isDeep(uint32_t leaf, const Piece& piece, detail::LeafNeighborhood& neighborhood,
              detail::LabelBlock& block) const {
    block.load(index_, labels_, neighborhood.around(leaf));
    for (uint32_t x = 0; x < 8; ++x)
      for (uint64_t rest = piece.mask[x]; rest; rest &= rest - 1)
        if (isDeep(index_.origin(leaf), x * 64 + uint32_t(__builtin_ctzll(rest)), block))
          return true;
    return false;
  }

  /// Has a voxel of a piece a neighbor of another label?
  bool touchesAnother(uint32_t leaf, const Piece& piece) const {
    if (meetsAnother(leaf, detail::dilate(piece.mask), piece.label)) return true;
    for (size_t side = 0; side < 6; ++side) {
      const uint32_t next = index_.neighbors(leaf)[side];
      if (next != LeafIndex::kNone &&
          meetsAnother(next, detail::across(piece.mask, side), piece.label))
        return true;
    }
    return false;
  }

 private:
  bool isDeep(const Coord& origin, uint32_t offset, const detail::LabelBlock& block) const {
    const int p[3] = {int(offset >> 6), int(offset >> 3 & 7), int(offset & 7)};
    const uint32_t own = block.at(offset);
    for (int x = p[0]; x < p[0] + 3; ++x)
      for (int y = p[1]; y < p[1] + 3; ++y)
        for (int z = p[2]; z < p[2] + 3; ++z)
          if (block.label[x][y][z] != own &&
              (!domain_ || domain_->isInside(origin.offsetBy(x - 1, y - 1, z - 1))))
            return false;
    return true;
  }
  bool meetsAnother(uint32_t leaf, const Mask& voxels, uint32_t label) const {
    for (auto piece = components_.begin(leaf); piece != components_.end(leaf); ++piece)
      if (piece->label != label && detail::meet(piece->mask, voxels)) return true;
    return false;
  }

  const LeafIndex& index_;
  const VoxelArray<uint32_t>& labels_;
  const detail::ConnectedComponents& components_;
  std::optional<Domain> domain_;
};

/// f(leaf, piece) for all pieces, in parallel.
template <typename F>
void forEachLeafPiece(const LeafIndex& index, const detail::ConnectedComponents& components,
                      Interrupter* interrupter, const F& f) {
  detail::parallelFor(
      index.leafCount(), detail::kLeafGrain, interrupter, [&](size_t begin, size_t end) {
        for (uint32_t leaf = uint32_t(begin); leaf < end; ++leaf)
          for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
            f(leaf, *piece);
      });
}

/// How many pieces each grain g is in, at g - 1.
std::vector<uint32_t> countPieces(const LeafIndex& index,
                                  const detail::ConnectedComponents& components, size_t grains) {
  std::vector<uint32_t> pieces(grains, 0);
  uint32_t seen = 0;  // components are numbered by their first pieces
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
      if (piece->component == seen) {
        ++seen;
        ++pieces[piece->label - 1];
      }
  return pieces;
}

constexpr int64_t kCrumbVoxels = 100, kSliverVoxels = 20;

}  // namespace

void detail::findFlags(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                       const ConnectedComponents& components, const std::optional<Domain>& domain,
                       const std::vector<char>& small, GrainFlags& flags,
                       Interrupter* interrupter) {
  const FlawFinder finder(index, labels, components, domain);
  std::vector<char>&deep = flags.deep, &touching = flags.touching;
  // Nearly all grains show within a leaf that they are deep.
  forEachLeafPiece(index, components, interrupter, [&](uint32_t, const Piece& piece) {
    if (!isSet(deep, piece.label) && anyVoxel(erode(piece.mask))) setFlag(deep, piece.label);
  });
  struct Scratch {
    explicit Scratch(const LeafIndex& i) : neighborhood(i) {}
    LeafNeighborhood neighborhood;
    LabelBlock block;
  };
  PerThread<Scratch> scratches{Scratch(index)};
  forEachLeafPiece(index, components, interrupter, [&](uint32_t leaf, const Piece& piece) {
    const uint32_t label = piece.label;
    if (!isSet(deep, label)) {
      Scratch& s = scratches.local();
      if (finder.isDeep(leaf, piece, s.neighborhood, s.block)) setFlag(deep, label);
    }
    const bool matters = small[label - 1] || !isSet(deep, label);
    if (matters && !isSet(touching, label) && finder.touchesAnother(leaf, piece))
      setFlag(touching, label);
  });
}

LabelFlaws detail::countFlaws(const GrainFlags& flags, const std::vector<int64_t>& grainVoxels,
                              const std::vector<uint32_t>& pieces) {
  LabelFlaws flaws;
  for (uint32_t g = 0; g < grainVoxels.size(); ++g) {
    const bool touches = flags.touching[g];
    if (grainVoxels[g] < kCrumbVoxels) ++(touches ? flaws.crumbs : flaws.specks);
    if (grainVoxels[g] >= kSliverVoxels && touches && !flags.deep[g]) ++flaws.slivers;
    if (pieces[g] > 1) ++flaws.inPieces;
  }
  return flaws;
}

LabelFlaws labelFlaws(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                      const std::vector<int64_t>& grainVoxels, const std::optional<Domain>& domain,
                      Interrupter* interrupter) {
  const detail::ConnectedComponents components(index, labels, interrupter);
  std::vector<char> small;
  for (const int64_t voxels : grainVoxels) small.push_back(voxels < kCrumbVoxels);
  detail::GrainFlags flags(grainVoxels.size());
  detail::findFlags(index, labels, components, domain, small, flags, interrupter);
  return detail::countFlaws(flags, grainVoxels, countPieces(index, components, grainVoxels.size()));
}

}  // namespace vdb_madf
