// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/gray/measure_gray.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/gray/detail/gray_statistics.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf {

namespace {

constexpr size_t kLeavesTogether = 64, kGrainsTogether = 4;
constexpr int kLeaf = 8;

std::string text(const CoordBBox& box) {
  const Coord size = box.dim(), first = box.min();
  const auto join = [](const Coord& c, const std::string& with) {
    return std::to_string(c.x()) + with + std::to_string(c.y()) + with + std::to_string(c.z());
  };
  return join(size, "x") + " voxels" +
         (first == Coord(0) ? "" : " from " + join(first, ",") + " on");
}

void checkBox(const std::string& path, const CoordBBox& scan, const SampleMeasures& sample) {
  if (!sample.domainKnown)
    throw InvalidInput(path +
                       ": the domain of the labels is unknown, so that nothing tells whether this "
                       "is their scan: give the domain");
  const bool isPart = sample.regionVoxels || sample.box.min() != scan.min();
  if (scan == sample.box || (isPart && scan.isInside(sample.box))) return;
  throw InvalidInput(path + ": has " + text(scan) + ", and the labels are those of a scan of " +
                     text(sample.box) +
                     ": give the one that they were made of, cropped as they were");
}

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

/// Gathers the samples of each grain and bond, in an order that depends on the labels alone.
template <typename T>
class SampleLists {
 public:
  SampleLists(const Int32Grid& labels, const Measurements& measured, Interrupter* interrupter)
      : leaves_(labels, interrupter),
        tree_(detail::withoutTiles(labels)),
        measured_(measured),
        ofGrains_(size_t(leaves_.index().voxelCount())),
        ofBonds_(measured.bonds.size()) {
    first_.push_back(0);
    for (const GrainMeasures& grain : measured.grains)
      first_.push_back(first_.back() + size_t(grain.voxels));
    next_.assign(first_.begin(), first_.end() - 1);
    for (size_t leaf = 0; leaf < leaves_.index().leafCount(); ++leaf)
      layers_[leaves_.index().origin(leaf).z()].push_back(leaf);
  }

  /// By the z of their origins; ascending.
  const std::map<int, std::vector<size_t>>& layers() const { return layers_; }

  /// The leaves of a layer, which the slab holds.
  void add(const std::vector<size_t>& layer, const Slab<T>& slab) {
    std::vector<std::vector<size_t>> places(layer.size());  // of the samples of each part
    for (size_t i = 0; i < layer.size(); ++i)
      for (const detail::LabelPart& part : leaves_.parts(layer[i])) {
        size_t& next = next_[rowOf(part.label)];
        places[i].push_back(next);
        next += detail::countVoxels(part.mask);
      }
    std::vector<std::vector<std::pair<size_t, T>>> besideBonds(layer.size());
    detail::parallelFor(layer.size(), kLeavesTogether, nullptr, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        addParts(layer[i], places[i], slab);
        besideBonds[i] = samplesBesideBonds(leaves_.index().origin(layer[i]), slab);
      }
    });
    for (const auto& samples : besideBonds)
      for (const auto& [bond, sample] : samples) ofBonds_[bond].push_back(sample);
  }

  void finish(Measurements& result, Interrupter* interrupter) {
    detail::parallelFor(
        result.grains.size(), kGrainsTogether, interrupter, [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i)
            result.grains[i].gray =
                detail::grayValues(ofGrains_.data() + first_[i], ofGrains_.data() + first_[i + 1]);
        });
    for (size_t i = 0; i < result.bonds.size(); ++i)
      result.bonds[i].gray =
          detail::grayValues(ofBonds_[i].data(), ofBonds_[i].data() + ofBonds_[i].size());
  }

 private:
  size_t rowOf(int32_t label) const {
    const auto& grains = measured_.grains;
    return size_t(
        std::lower_bound(grains.begin(), grains.end(), label,
                         [](const GrainMeasures& grain, int32_t id) { return grain.id < id; }) -
        grains.begin());
  }

  void addParts(size_t leaf, const std::vector<size_t>& places, const Slab<T>& slab) {
    const Coord& origin = leaves_.index().origin(leaf);
    auto place = places.begin();
    for (const detail::LabelPart& part : leaves_.parts(leaf)) {
      T* to = ofGrains_.data() + *place++;
      for (int x = 0; x < kLeaf; ++x)
        for (uint64_t bits = part.mask[size_t(x)]; bits; bits &= bits - 1) {
          const int bit = __builtin_ctzll(bits);
          *to++ = slab.at(origin + Coord(x, bit >> 3, bit & 7));
        }
    }
  }

  /// With the row of the bond; a voxel comes once for each bond of which it has a face.
  std::vector<std::pair<size_t, T>> samplesBesideBonds(const Coord& origin,
                                                       const Slab<T>& slab) const {
    std::vector<std::pair<size_t, T>> found;
    detail::LabelHalo halo;
    detail::readLabelHalo(*tree_, origin, halo);
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

  detail::LabelLeaves leaves_;
  Int32Tree::ConstPtr tree_;
  const Measurements& measured_;
  std::map<int, std::vector<size_t>> layers_;
  std::vector<size_t> first_, next_;  // of each grain in ofGrains_
  std::vector<T> ofGrains_;
  std::vector<std::vector<T>> ofBonds_;
};

template <typename T>
void measureSamples(const Int32Grid& labels, GrayScan& scan, Measurements& measured,
                    Interrupter* interrupter) {
  SampleLists<T> lists(labels, measured, interrupter);
  const CoordBBox box = scan.box();
  std::vector<char> bytes(size_t(detail::sliceBytes(scan.image->info())) *
                          size_t(std::min(kLeaf, box.dim().z())));
  const auto* samples = reinterpret_cast<const T*>(bytes.data());
  int percent = 0, done = 0;
  for (const auto& [z, layer] : lists.layers()) {
    if (interrupter && interrupter->wasInterrupted(percent)) throw Interrupted();
    CoordBBox part = box;
    part.min().z() = std::max(z, box.min().z());
    part.max().z() = std::min(z + kLeaf - 1, box.max().z());
    scan.image->read(part.min().z() - box.min().z(), part.dim().z(), bytes.data());
    lists.add(layer, {samples, part});
    percent = ++done * 100 / int(lists.layers().size());
  }
  lists.finish(measured, interrupter);
}

}  // namespace

void measureGray(const Int32Grid& labels, GrayScan& scan, Measurements& measured,
                 Interrupter* interrupter) {
  checkBox(scan.image->path(), scan.box(), measured.sample);
  detail::withSampleType(scan.image->info().type, [&](auto sample) {
    measureSamples<decltype(sample)>(labels, scan, measured, interrupter);
  });
  measured.extra.gray = true;
}

}  // namespace vdb_madf
