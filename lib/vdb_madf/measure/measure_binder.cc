// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/measure_binder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/size_and_place.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/measure/detail/label_sums.h"
#include "vdb_madf/measure/detail/voronoi_cells.h"

namespace vdb_madf {

namespace {

using LabelPair = std::pair<int32_t, int32_t>;

LabelPair ordered(int32_t a, int32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

void checkDomains(const MaskGrid& binder, const SampleMeasures& sample) {
  const auto domain = storedDomain(binder);
  if (!domain || !sample.domainKnown)
    throw InvalidInput(
        "whether phases and labels have the same voxels is unknown, for the domain "
        "of one of them is: give both as images, or --domain");
  if (domain->box().isInside(sample.box)) return;
  throw InvalidInput("the phases have " + detail::sizeAndPlace(domain->box()) + ", the labels " +
                     detail::sizeAndPlace(sample.box) + ": give those of the whole scan");
}

class BinderMeter {
 public:
  BinderMeter(const Int32Grid& labels, const MaskGrid& binder, const Domain& domain, bool open)
      : labels_(labels),
        index_(binder),
        domain_(domain),
        open_(open),
        voxel_{detail::proportions(labels.transform())},
        cell_(index_.voxelCount()),
        partner_(index_.voxelCount()) {}

  Binder measure(const Measurements& measured, Interrupter* interrupter) {
    if (measured.grains.empty()) return withoutGrains();
    findCells(interrupter);
    findPartners(interrupter);
    std::map<LabelPair, Bridge> bridges;
    Binder result;
    forEach([&](VoxelId, size_t rank) {
      if (cell_[rank] == 0) return;
      result.volume += voxel_.volume();
      if (partner_[rank] == 0)
        result.looseVolume += voxel_.volume();
      else
        ++bridges[ordered(cell_[rank], partner_[rank])].voxels;
    });
    for (const auto& [pair, bridge] : bridges) {
      result.bridges.push_back(bridge);
      std::tie(result.bridges.back().first, result.bridges.back().second) = pair;
      result.bridges.back().volume = double(bridge.voxels) * voxel_.volume();
    }
    setSections(measured, result.bridges, interrupter);
    setCovers(measured, result.bridges, interrupter);
    return result;
  }

 private:
  template <typename F>
  void forEach(const F& f) const {
    detail::forEachVoxel(index_, 0, index_.leafCount(), f);
  }

  Binder withoutGrains() const {
    Binder result;
    forEach([&](VoxelId id, size_t) {
      if (domain_.isInside(index_.coord(id))) result.volume += voxel_.volume();
    });
    result.looseVolume = result.volume;
    return result;
  }

  /// The nearest grain of each voxel, and the labels that have grown by these.
  void findCells(Interrupter* interrupter) {
    const detail::LabelLeaves leaves(labels_, interrupter);
    first_ = leaves.index().boundingBox().min();
    detail::VoronoiCells cells(domain_, labels_.transform());
    cells.add(leaves);
    const CoordBBox box = domain_.box();
    std::map<int, std::vector<size_t>> layers;  // by the z of their origins
    for (size_t leaf = 0; leaf < index_.leafCount(); ++leaf)
      layers[index_.origin(leaf).z()].push_back(leaf);
    const std::vector<std::pair<int, std::vector<size_t>>> list(layers.begin(), layers.end());
    detail::parallelForEach(list.size(), 1, interrupter, [&](size_t i) {
      for (int z = list[i].first; z < list[i].first + detail::kLeafSide; ++z) {
        const bool isWithin = z >= box.min().z() && z <= box.max().z();
        setSlice(list[i].second, z, isWithin ? cells.slice(z - box.min().z()) : Slice());
      }
    });
    grown_ = labels_.deepCopy();
    auto grown = grown_->getAccessor();
    forEach([&](VoxelId id, size_t rank) {
      const Coord p = index_.coord(id);
      int32_t label = 0;
      if (grown.probeValue(p, label) && label > 0)
        cell_[rank] = 0;
      else if (cell_[rank] > 0)
        grown.setValue(p, cell_[rank]);
    });
  }

  using Slice = detail::VoronoiCells::Slice;
  void setSlice(const std::vector<size_t>& leaves, int z, const Slice& slice) {
    const CoordBBox box = domain_.box();
    const auto ny = size_t(box.dim().y());
    for (const size_t leaf : leaves)
      detail::forEachVoxel(index_, leaf, leaf + 1, [&](VoxelId id, size_t rank) {
        const Coord p = index_.coord(id), from = p - box.min();
        if (p.z() == z)
          cell_[rank] = slice.empty() || !box.isInside(p)
                            ? 0
                            : slice[size_t(from.x()) * ny + size_t(from.y())];
      });
  }

  /// Step by step from the voxels beside another cell.
  void findPartners(Interrupter* interrupter) {
    std::vector<std::pair<VoxelId, int32_t>> reached, next;  // voxels with their partners
    const auto grown = grown_->getConstUnsafeAccessor();
    forEach([&](VoxelId id, size_t rank) {
      partner_[rank] = 0;
      if (cell_[rank] == 0) return;
      for (int i = 0; i < 6; ++i) {
        Coord beside = index_.coord(id);
        beside[i / 2] += i % 2 ? 1 : -1;
        int32_t other = 0;
        if (grown.probeValue(beside, other) && other > 0 && other != cell_[rank])
          reached.emplace_back(id, other);
      }
    });
    while (!reached.empty()) {
      if (interrupter && interrupter->wasInterrupted(-1)) throw Interrupted();
      detail::parallelSort(reached.begin(), reached.end());
      next.clear();
      for (const auto& [id, partner] : reached) {
        const size_t rank = index_.rank(id);
        if (partner_[rank] != 0) continue;  // the smaller partner came first
        partner_[rank] = partner;
        detail::forEachNeighbor(index_, id, [&, own = partner](VoxelId beside, int, int) {
          if (!detail::isObject(index_, beside)) return;
          const size_t other = index_.rank(beside);
          if (partner_[other] == 0 && cell_[other] == cell_[rank]) next.emplace_back(beside, own);
        });
      }
      reached.swap(next);
    }
  }

  /// Areas of the interfaces of labels.
  std::map<LabelPair, double> interfaces(const Int32Grid& labels, Interrupter* interrupter) const {
    const detail::LabelLeaves leaves(labels, interrupter);
    detail::LabelSums sums(first_, domain_, open_, voxel_);
    sums.add(leaves, {}, interrupter);
    std::map<LabelPair, double> areas;
    for (const detail::BondSums& bond :
         sums.takeBonds([](int32_t, int32_t) { return true; }, interrupter))
      areas[{bond.first, bond.second}] = detail::bondArea(bond.areas, voxel_);
    return areas;
  }

  /// Between the grains with what is nearest to them, without their contacts: those of too few
  /// faces for a bond are no binder, either.
  void setSections(const Measurements& measured, std::vector<Bridge>& bridges,
                   Interrupter* interrupter) const {
    const auto areas = interfaces(*grown_, interrupter),
               contacts = interfaces(labels_, interrupter);
    std::set<LabelPair> bonds;
    for (const BondMeasures& bond : measured.bonds) bonds.emplace(bond.first, bond.second);
    for (Bridge& bridge : bridges) {
      const LabelPair pair(bridge.first, bridge.second);
      bridge.bonded = bonds.count(pair) > 0;
      const auto contact = contacts.find(pair);
      if (const auto area = areas.find(pair); area != areas.end())
        bridge.section =
            std::max(0.0, area->second - (contact == contacts.end() ? 0 : contact->second));
      bridge.sectionRadius = std::sqrt(bridge.section / M_PI);
    }
  }

  /// Between each bridge, which gets a label of its own, and its two grains.
  void setCovers(const Measurements& measured, std::vector<Bridge>& bridges,
                 Interrupter* interrupter) const {
    const int64_t last = measured.grains.empty() ? 0 : measured.grains.back().id;
    if (last + int64_t(bridges.size()) > std::numeric_limits<int32_t>::max())
      throw InvalidInput(
          "the labels are too large to number bridges beyond them: renumber the "
          "grains (vdb_madf edit --renumber)");
    std::map<LabelPair, int32_t> numbers;
    for (const Bridge& bridge : bridges)
      numbers[{bridge.first, bridge.second}] = int32_t(last + 1 + int64_t(numbers.size()));
    const Int32Grid::Ptr numbered = labels_.deepCopy();
    auto accessor = numbered->getAccessor();
    forEach([&](VoxelId id, size_t rank) {
      if (partner_[rank] != 0)
        accessor.setValue(index_.coord(id), numbers.at(ordered(cell_[rank], partner_[rank])));
    });
    const auto areas = interfaces(*numbered, interrupter);
    std::map<int32_t, double> freeAreas;
    for (const GrainMeasures& grain : measured.grains) freeAreas[grain.id] = grain.freeArea;
    for (Bridge& bridge : bridges) {
      const int32_t number = numbers.at({bridge.first, bridge.second});
      const auto cover = [&](int32_t grain, double& area, double& share) {
        const auto found = areas.find({grain, number});
        area = found == areas.end() ? 0 : found->second;
        share = freeAreas.at(grain) > 0 ? area / freeAreas.at(grain) : 0;
      };
      cover(bridge.first, bridge.firstCover, bridge.firstShare);
      cover(bridge.second, bridge.secondCover, bridge.secondShare);
    }
  }

  const Int32Grid& labels_;
  LeafIndex index_;  // of the binder
  Domain domain_;
  bool open_;
  detail::VoxelShape voxel_;
  Coord first_;                  // of the labeled voxels
  VoxelArray<int32_t> cell_;     // the nearest grain; 0 outside of the domain and in grains
  VoxelArray<int32_t> partner_;  // 0: no other grain is reached
  Int32Grid::Ptr grown_;         // the labels with cell_
};

}  // namespace

void measureBinder(const Int32Grid& labels, const MaskGrid& binder, const MeasureOptions& options,
                   Measurements& measured, Interrupter* interrupter) {
  checkDomains(binder, measured.sample);
  const Domain domain = options.domain ? *options.domain : storedDomain(labels).value();
  BinderMeter meter(labels, binder, domain, measured.open);
  measured.binder = meter.measure(measured, interrupter);
}

std::string noteOn(const Binder& binder, int64_t value) {
  if (binder.volume > 0) return "";
  return "no voxel outside of the grains has the value " + std::to_string(value) +
         ", that of binder: there is none";
}

}  // namespace vdb_madf
