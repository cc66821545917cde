// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/label_flaws.h"

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_neighborhood.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/tidy_steps.h"
#include "vdb_madf/method/detail/voxels_around.h"
#include "vdb_madf/segmentation/detail/grain_flags.h"

namespace vdb_madf {

namespace {

using Mask = LeafIndex::Mask;
using Entry = detail::LabelMasks::Entry;

/// One flag a grain, set by any thread.
bool isSet(const std::vector<char>& flags, uint32_t label) {
  return __atomic_load_n(&flags[label - 1], __ATOMIC_RELAXED) != 0;
}
void setFlag(std::vector<char>& flags, uint32_t label) {
  __atomic_store_n(&flags[label - 1], char(1), __ATOMIC_RELAXED);
}

class FlawFinder {
 public:
  FlawFinder(const LeafIndex& index, const detail::LabelMasks& labels,
             const std::optional<Domain>& domain)
      : index_(index), labels_(labels), domain_(domain) {}

  /// False if what lies in a leaf tells that a label is not two layers deep there. \p outside: what
  /// of the leaf lies outside the domain.
  static bool mayBeDeep(const Entry& own, const Mask& outside) {
    return detail::meet(own.mask, detail::erode(detail::either(own.mask, outside), ~uint64_t(0)));
  }

  /// Has a label a voxel in a leaf that is two layers deep? What lies outside the domain does not
  /// count.
  bool isDeep(uint32_t leaf, const Entry& own, detail::LeafNeighborhood& neighborhood) const {
    std::array<Mask, 27> masks{};
    std::array<const Mask*, 27> set;
    const std::array<uint32_t, 27>& around = neighborhood.around(leaf);
    for (size_t i = 0; i < 27; ++i) {
      set[i] = &masks[i];
      if (around[i] != LeafIndex::kNone) masks[i] = maskOf(around[i], own.label);
      if (!domain_) continue;
      const Coord origin = index_.origin(leaf).offsetBy(
          8 * (int(i) / 9 - 1), 8 * (int(i) / 3 % 3 - 1), 8 * (int(i) % 3 - 1));
      masks[i] = detail::either(masks[i], outside(origin));
    }
    return detail::meet(own.mask, detail::areSurrounded(detail::voxelsAround(set)));
  }

  /// Has such a voxel a neighbor of another label? \p voxels: those of the leaf with a label.
  bool touchesAnother(uint32_t leaf, const Entry& own, const Mask& voxels) const {
    if (detail::meet(detail::without(detail::dilate(own.mask), own.mask), voxels)) return true;
    for (size_t side = 0; side < 6; ++side) {
      const uint32_t next = index_.neighbors(leaf)[side];
      if (next == LeafIndex::kNone) continue;
      const Mask touched = detail::both(detail::across(own.mask, side), index_.mask(next));
      if (detail::anyVoxel(touched) && meetsAnother(next, touched, own.label)) return true;
    }
    return false;
  }

  /// What of the leaf at an origin lies outside the domain.
  Mask outside(const Coord& origin) const {
    if (!domain_) return {};
    return detail::without(detail::kFullMask, detail::insideMask(*domain_, origin));
  }
  Mask labelled(uint32_t leaf) const {
    Mask all{};
    for (auto entry = labels_.begin(leaf); entry != labels_.end(leaf); ++entry)
      all = detail::either(all, entry->mask);
    return all;
  }

 private:
  Mask maskOf(uint32_t leaf, uint32_t label) const {
    for (auto entry = labels_.begin(leaf); entry != labels_.end(leaf); ++entry)
      if (entry->label == label) return entry->mask;
    return {};
  }
  bool meetsAnother(uint32_t leaf, const Mask& voxels, uint32_t label) const {
    for (auto entry = labels_.begin(leaf); entry != labels_.end(leaf); ++entry)
      if (entry->label != label && detail::meet(entry->mask, voxels)) return true;
    return false;
  }

  const LeafIndex& index_;
  const detail::LabelMasks& labels_;
  std::optional<Domain> domain_;
};

constexpr int64_t kCrumbVoxels = 100, kSliverVoxels = 20;

}  // namespace

void detail::findFlags(const LeafIndex& index, const LabelMasks& labels,
                       const std::optional<Domain>& domain, const std::vector<char>& small,
                       GrainFlags& flags, Interrupter* interrupter) {
  const FlawFinder finder(index, labels, domain);
  std::vector<char>&deep = flags.deep, &touching = flags.touching;
  // Nearly all grains show within a leaf that they are deep.
  parallelForEach(index.leafCount(), kLeafGrain, interrupter, [&](size_t leaf) {
    for (auto own = labels.begin(leaf); own != labels.end(leaf); ++own)
      if (!isSet(deep, own->label) && anyVoxel(erode(own->mask, 0))) setFlag(deep, own->label);
  });
  PerThread<LeafNeighborhood> neighborhoods{LeafNeighborhood(index)};
  parallelForEach(index.leafCount(), kLeafGrain, interrupter, [&](uint32_t leaf) {
    std::optional<Mask> outside, labelled;  // of the leaf, once they are needed
    for (auto own = labels.begin(leaf); own != labels.end(leaf); ++own) {
      const uint32_t label = own->label;
      if (!isSet(deep, label)) {
        if (!outside) outside = finder.outside(index.origin(leaf));
        if (FlawFinder::mayBeDeep(*own, *outside) &&
            finder.isDeep(leaf, *own, neighborhoods.local()))
          setFlag(deep, label);
      }
      const bool matters = small[label - 1] || !isSet(deep, label);
      if (!matters || isSet(touching, label)) continue;
      if (!labelled) labelled = finder.labelled(leaf);
      if (finder.touchesAnother(leaf, *own, *labelled)) setFlag(touching, label);
    }
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

std::vector<uint32_t> detail::countPieces(const LeafIndex& index, const LabelMasks& labels,
                                          size_t grains, Interrupter* interrupter) {
  const ConnectedComponents components(index, labels, interrupter);
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

LabelFlaws labelFlaws(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                      const std::vector<int64_t>& grainVoxels, const std::optional<Domain>& domain,
                      Interrupter* interrupter) {
  const detail::LabelMasks masks(index, labels, interrupter);
  return detail::labelFlaws(index, masks, grainVoxels,
                            detail::countPieces(index, masks, grainVoxels.size(), interrupter),
                            domain, interrupter);
}

LabelFlaws detail::labelFlaws(const LeafIndex& index, const LabelMasks& labels,
                              const std::vector<int64_t>& grainVoxels,
                              const std::vector<uint32_t>& pieces,
                              const std::optional<Domain>& domain, Interrupter* interrupter) {
  std::vector<char> small;
  for (const int64_t voxels : grainVoxels) small.push_back(voxels < kCrumbVoxels);
  GrainFlags flags(grainVoxels.size());
  findFlags(index, labels, domain, small, flags, interrupter);
  return countFlaws(flags, grainVoxels, pieces);
}

LabelFlaws detail::tidyAndCountFlaws(const LeafIndex& index, int rounds,
                                     const std::optional<Domain>& domain, GrainLabels& grains,
                                     Interrupter* interrupter) {
  checkTidy(rounds);
  LabelMasks masks(index, grains.label, interrupter);
  const bool areConnected = rounds > 0 && tidyMasks(index, rounds, masks, grains, interrupter);
  const size_t count = grains.voxels.size();
  const std::vector<uint32_t> pieces = areConnected ? std::vector<uint32_t>(count, 1)
                                                    : countPieces(index, masks, count, interrupter);
  return labelFlaws(index, masks, grains.voxels, pieces, domain, interrupter);
}

}  // namespace vdb_madf
