// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/measure_gray.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/intensity/detail/gray_statistics.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/labels/detail/rimmed_slabs.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf {

namespace {

constexpr size_t kLeavesTogether = 64, kGrainsTogether = 4;
constexpr int kLeaf = 8;

/// The samples of one slab at places of the grid.
template <typename T>
struct Slab {
  const T* samples;
  CoordBBox box;

  const T& at(const Coord& p) const {
    const Coord from = p - box.min(), size = box.dim();
    return samples[(size_t(from.z()) * size_t(size.y()) + size_t(from.y())) * size_t(size.x()) +
                   size_t(from.x())];
  }
};

/// Gathers the samples of each grain and bond, in an order that depends on the labels alone, until
/// all of them are there.
template <typename T>
class SampleLists {
 public:
  explicit SampleLists(Measurements& measured)
      : measured_(measured),
        ofGrains_(measured.grains.size()),
        counts_(measured.grains.size()),
        ofBonds_(measured.bonds.size()) {
    for (BondMeasures& bond : measured.bonds) bond.gray.reset();
  }

  /// Labels whose leaves in some layers come next; those beside them are known, too.
  void add(const Int32Grid& labels, const detail::LeafLayers& own, GrayScan& scan,
           Interrupter* interrupter) {
    const detail::LabelLeaves leaves(labels, interrupter);
    const Int32Tree::ConstPtr tree = detail::withoutTiles(labels);
    std::map<int, std::vector<size_t>> layers;  // by the z of their origins
    for (size_t leaf = 0; leaf < leaves.index().leafCount(); ++leaf)
      if (own.hold(leaves.index().origin(leaf)))
        layers[leaves.index().origin(leaf).z()].push_back(leaf);
    const CoordBBox box = scan.box();
    std::vector<char> bytes(size_t(detail::sliceBytes(scan.image->info())) *
                            size_t(std::min(kLeaf, box.dim().z())));
    const auto* samples = reinterpret_cast<const T*>(bytes.data());
    int percent = 0, done = 0;
    for (const auto& [z, layer] : layers) {
      if (interrupter && interrupter->wasInterrupted(percent)) throw Interrupted();
      CoordBBox part = box;
      part.min().z() = std::max(z, box.min().z());
      part.max().z() = std::min(z + kLeaf - 1, box.max().z());
      scan.image->read(part.min().z() - box.min().z(), part.dim().z(), bytes.data());
      addLayer(leaves, *tree, layer, {samples, part});
      percent = ++done * 100 / int(layers.size());
    }
    finishComplete(interrupter);
  }

 private:
  bool isComplete(size_t grain) const {
    return counts_[grain] == size_t(measured_.grains[grain].voxels);
  }

  /// The leaves of a layer, which the slab holds.
  void addLayer(const detail::LabelLeaves& leaves, const Int32Tree& tree,
                const std::vector<size_t>& layer, const Slab<T>& slab) {
    std::vector<std::vector<T*>> places(layer.size());  // of the samples of each part
    for (size_t i = 0; i < layer.size(); ++i)
      for (const detail::LabelPart& part : leaves.parts(layer[i])) {
        const size_t grain = rowOf(measured_.grains, part.label),
                     count = detail::countVoxels(part.mask);
        if (grain == counts_.size() || measured_.grains[grain].id != part.label ||
            counts_[grain] + count > size_t(measured_.grains[grain].voxels))
          throw InvalidInput("these are not the labels that were measured");
        if (counts_[grain] == 0) ofGrains_[grain].resize(size_t(measured_.grains[grain].voxels));
        places[i].push_back(ofGrains_[grain].data() + counts_[grain]);
        counts_[grain] += count;
        if (isComplete(grain)) complete_.push_back(grain);
      }
    std::vector<std::vector<std::pair<size_t, T>>> besideBonds(layer.size());
    detail::parallelForEach(layer.size(), kLeavesTogether, nullptr, [&](size_t i) {
      copyParts(leaves, layer[i], places[i], slab);
      besideBonds[i] = samplesBesideBonds(tree, leaves.index().origin(layer[i]), slab);
    });
    for (const auto& samples : besideBonds)
      for (const auto& [bond, sample] : samples) ofBonds_[bond].push_back(sample);
  }

  static void copyParts(const detail::LabelLeaves& leaves, size_t leaf,
                        const std::vector<T*>& places, const Slab<T>& slab) {
    const Coord& origin = leaves.index().origin(leaf);
    auto place = places.begin();
    for (const detail::LabelPart& part : leaves.parts(leaf)) {
      T* to = *place++;
      for (int x = 0; x < kLeaf; ++x)
        for (uint64_t bits = part.mask[size_t(x)]; bits; bits &= bits - 1) {
          const int bit = __builtin_ctzll(bits);
          *to++ = slab.at(origin + Coord(x, bit >> 3, bit & 7));
        }
    }
  }

  /// Samples with the row of their bond; a voxel comes once for each bond of which it has a face.
  std::vector<std::pair<size_t, T>> samplesBesideBonds(const Int32Tree& tree, const Coord& origin,
                                                       const Slab<T>& slab) const {
    std::vector<std::pair<size_t, T>> found;
    detail::LabelHalo halo;
    detail::readLabelHalo(tree, origin, halo);
    for (int x = 0; x < kLeaf; ++x)
      for (int y = 0; y < kLeaf; ++y)
        for (int z = 0; z < kLeaf; ++z) {
          const size_t at = detail::haloAt(x, y, z);
          const int32_t own = halo[at];
          if (own == 0) continue;
          int32_t others[6];
          size_t count = 0;
          for (const int stride : detail::kHaloStride)
            for (const size_t beside : {at - size_t(stride), at + size_t(stride)}) {
              const int32_t other = halo[beside];
              if (other != 0 && other != own && !std::count(others, others + count, other))
                others[count++] = other;
            }
          for (size_t i = 0; i < count; ++i)
            if (const auto bond = bondOf(own, others[i]))
              found.emplace_back(*bond, slab.at(origin + Coord(x, y, z)));
        }
    return found;
  }

  /// None if the grains share too few faces for a bond.
  std::optional<size_t> bondOf(int32_t a, int32_t b) const {
    const std::pair<int32_t, int32_t> pair = std::minmax(a, b);
    const auto& bonds = measured_.bonds;
    const auto found =
        std::lower_bound(bonds.begin(), bonds.end(), pair,
                         [](const BondMeasures& bond, const std::pair<int32_t, int32_t>& key) {
                           return std::pair(bond.first, bond.second) < key;
                         });
    if (found == bonds.end() || std::pair(found->first, found->second) != pair) return {};
    return size_t(found - bonds.begin());
  }

  /// What grains and bonds have no samples to come is known now, and their samples go.
  void finishComplete(Interrupter* interrupter) {
    detail::parallelForEach(complete_.size(), kGrainsTogether, interrupter, [&](size_t i) {
      measured_.grains[complete_[i]].gray = taken(ofGrains_[complete_[i]]);
    });
    complete_.clear();
    for (size_t i = 0; i < ofBonds_.size(); ++i) {
      BondMeasures& bond = measured_.bonds[i];
      if (!bond.gray && isComplete(rowOf(measured_.grains, bond.first)) &&
          isComplete(rowOf(measured_.grains, bond.second)))
        bond.gray = taken(ofBonds_[i]);
    }
  }
  static GrayValues taken(std::vector<T>& samples) {
    const GrayValues values = detail::grayValues(samples.data(), samples.data() + samples.size());
    samples = {};
    return values;
  }

  Measurements& measured_;
  std::vector<std::vector<T>> ofGrains_;  // of all their voxels, once there is one
  std::vector<size_t> counts_;            // of those that are there
  std::vector<size_t> complete_;          // grains whose values are still to be found
  std::vector<std::vector<T>> ofBonds_;
};

/// Slab by slab. Samples of a grain wait until all of them are there.
template <typename T>
void addSlabs(const LabelSlabs& slabs, GrayScan& scan, SampleLists<T>& lists,
              Interrupter* interrupter) {
  detail::RimmedSlabs rimmed(slabs);
  for (size_t s = 0; s < slabs.slabCount(); ++s) {
    const auto percent = [&](size_t done) { return int(done * 100 / slabs.slabCount()); };
    detail::WorkPart part(interrupter, percent(s), percent(s + 1));
    rimmed.next(&part);
    lists.add(rimmed.labels(), {slabs.cuts[s], slabs.cuts[s + 1]}, scan, &part);
  }
}

/// addAll(lists) adds all labels.
template <typename AddAll>
void measureSamples(GrayScan& scan, Measurements& measured, const AddAll& addAll) {
  placeScan(scan, measured.sample);
  detail::withSampleType(scan.image->info().type, [&](auto sample) {
    SampleLists<decltype(sample)> lists(measured);
    addAll(lists);
  });
  measured.extra.gray = true;
}

}  // namespace

void measureGray(const Int32Grid& labels, GrayScan& scan, Measurements& measured,
                 Interrupter* interrupter) {
  measureSamples(scan, measured, [&](auto& lists) { lists.add(labels, {}, scan, interrupter); });
}

void measureGray(const LabelSlabs& labels, GrayScan& scan, Measurements& measured,
                 Interrupter* interrupter) {
  measureSamples(scan, measured, [&](auto& lists) { addSlabs(labels, scan, lists, interrupter); });
}

}  // namespace vdb_madf
