// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/measure.h"

#include <algorithm>
#include <unordered_map>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/labels/detail/slab_window.h"
#include "vdb_madf/measure/correlation_length.h"
#include "vdb_madf/measure/detail/correlation_decay.h"
#include "vdb_madf/measure/detail/measuring.h"
#include "vdb_madf/measure/detail/voxel_pairs.h"
#include "vdb_madf/segmentation/segment.h"

namespace vdb_madf {

namespace {

/// \p graph: of the segmentation, if it tells the representatives under its weights; else null.
Measurements measureLabels(const Int32Grid& labels, const MeasureOptions& options,
                           const ManifoldGraph* graph, Interrupter* interrupter) {
  detail::Measuring measuring(labels, options);
  const detail::LabelLeaves leaves(labels, interrupter);
  measuring.survey(leaves);
  const VoxelWeights& weights = measuring.weights();
  measuring.add(
      leaves, leaves, {}, [](int32_t) { return true; }, interrupter);
  const auto representatives =
      graph && graph->weights == weights
          ? detail::grainRepresentatives(labels, *graph)
          : detail::grainRepresentatives(leaves, measuring.obstacles(), weights,
                                         measuring.bondDepths(), interrupter);
  const auto lengths = correlationLengths(leaves.index(), measuring.whole(), interrupter);
  return measuring.finish(representatives, lengths, interrupter);
}

/// Labels slab by slab. What is around a slab is read, too, as far as it matters.
class SlabMeasuring {
 public:
  SlabMeasuring(const LabelSlabs& slabs, const MeasureOptions& options, Interrupter* interrupter)
      : slabs_(slabs), measuring_(*slabs.about, options), interrupter_(interrupter) {
    if (!measuring_.obstacles().domain.isBox())
      throw InvalidInput("labels in slabs cannot be measured in a region: take a box as domain");
  }

  Measurements run() {
    survey();
    measure();
    std::array<std::optional<double>, 3> lengths;
    for (size_t axis = 0; axis < decays_.size(); ++axis) lengths[axis] = decays_[axis].length();
    detail::WorkPart part(interrupter_, 100, 100);
    return measuring_.finish(representatives_, lengths, &part);
  }

 private:
  /// So far does the correlation fall in most samples.
  static constexpr int kLags = detail::SlabRepresentatives::kFirstReach - 8;
  static constexpr int kMostLags = 512;  // that are looked at together

  detail::LeafLayers layersOf(size_t slab) const {
    return {slabs_.cuts[slab], slabs_.cuts[slab + 1]};
  }
  /// The share of a slab in a part of the work that goes over all slabs.
  detail::WorkPart workPart(int begin, int end, size_t slab) const {
    const auto at = [&](size_t s) {
      return begin + int(s) * (end - begin) / int(slabs_.slabCount());
    };
    return {interrupter_, at(slab), at(slab + 1)};
  }

  void survey() {
    detail::SlabWindow window(slabs_);
    for (size_t s = 0; s < slabs_.slabCount(); ++s) {
      detail::WorkPart part = workPart(0, 20, s);
      const detail::LabelLeaves slab = window.leaves(layersOf(s), &part);
      measuring_.survey(slab);
      for (size_t leaf = 0; leaf < slab.index().leafCount(); ++leaf)
        for (const detail::LabelPart& labeled : slab.parts(leaf)) lastSlab_[labeled.label] = s;
    }
  }

  void measure() {
    if (measuring_.voxels() == 0) return;
    for (int axis = 0; axis < 3; ++axis)
      decays_.emplace_back(measuring_.voxels(), measuring_.whole(), axis);
    detail::SlabRepresentatives representatives(measuring_.object(), measuring_.obstacles(),
                                                measuring_.weights(), measuring_.bondDepths());
    Pairs pairs = noPairs(kLags);
    detail::SlabWindow window(slabs_);
    for (size_t s = 0; s < slabs_.slabCount(); ++s) {
      detail::WorkPart part = workPart(20, 90, s);
      const detail::LeafLayers own = layersOf(s);
      detail::LabelLeaves around = window.leaves(representatives.around(own), &part);
      while (measuring_.hasBackground() && !representatives.add(around, own, &part))
        around = window.leaves(representatives.around(own), &part);
      measuring_.add(
          window.leaves(own, &part), around, own,
          [&](int32_t label) { return lastSlab_.at(label) <= s; }, &part);
      addPairs(around.index(), own, pairs, &part);
    }
    representatives_ = std::move(representatives.best);
    follow(pairs);
    for (int lags = 2 * kLags; !allDone(); lags = std::min(2 * lags, kMostLags)) correlate(lags);
  }

  /// Pairs of object voxels along each axis, for lags from that of its decay on.
  using Pairs = std::array<std::vector<int64_t>, 3>;
  Pairs noPairs(int lags) const {
    Pairs pairs;
    for (size_t axis = 0; axis < 3; ++axis)
      if (!decays_[axis].isDone()) pairs[axis].assign(size_t(lags), 0);
    return pairs;
  }
  void addPairs(const LeafIndex& index, const detail::LeafLayers& own, Pairs& pairs,
                Interrupter* interrupter) const {
    for (size_t axis = 0; axis < 3; ++axis) {
      if (pairs[axis].empty()) continue;
      detail::VoxelPairs counter(index, int(axis), own);
      for (size_t i = 0; i < pairs[axis].size(); ++i)
        pairs[axis][i] += counter.count(decays_[axis].lag() + int(i), interrupter);
    }
  }
  void follow(const Pairs& pairs) {
    for (size_t axis = 0; axis < 3; ++axis)
      for (size_t i = 0; i < pairs[axis].size() && !decays_[axis].isDone(); ++i)
        decays_[axis].add(pairs[axis][i], interrupter_);
  }
  bool allDone() const {
    return std::all_of(decays_.begin(), decays_.end(),
                       [](const auto& decay) { return decay.isDone(); });
  }

  /// Goes over all slabs again, for that many lags more.
  void correlate(int lags) {
    Pairs pairs = noPairs(lags);
    detail::SlabWindow window(slabs_), further(slabs_);
    for (size_t s = 0; s < slabs_.slabCount(); ++s) {
      detail::WorkPart part = workPart(90, 100, s);
      const detail::LeafLayers own = layersOf(s);
      // Where the second voxels of pairs along z lie, as far as that is beyond the slab.
      const int lag = decays_[2].lag() & ~7;
      const detail::LeafLayers beyond{std::max(own.end, own.begin + lag),
                                      own.end + lag + lags + 16};
      const detail::LabelLeaves slab = window.leaves(own, &part);
      if (decays_[2].isDone()) {
        addPairs(slab.index(), own, pairs, &part);
        continue;
      }
      const detail::LabelLeaves second = further.leaves(beyond, &part);
      addPairs(detail::LabelLeaves({&slab, &second}, {}).index(), own, pairs, &part);
    }
    follow(pairs);
  }

  const LabelSlabs& slabs_;
  detail::Measuring measuring_;
  Interrupter* interrupter_;
  std::unordered_map<int32_t, size_t> lastSlab_;  // of each label
  detail::GrainRepresentatives representatives_;
  std::vector<detail::CorrelationDecay> decays_;  // along each axis
};

}  // namespace

Measurements measure(const Int32Grid& labels, const MeasureOptions& options,
                     Interrupter* interrupter) {
  return measureLabels(labels, options, nullptr, interrupter);
}

Measurements measure(const LabelSlabs& labels, const MeasureOptions& options,
                     Interrupter* interrupter) {
  return SlabMeasuring(labels, options, interrupter).run();
}

Measurements measure(const Segmentation& segmentation, Interrupter* interrupter) {
  // The labels' own: of unfiltered balls, no cavity filled, each voxel where the flow led it.
  const SegmentCounts& counts = segmentation.counts;
  const bool graphTells =
      counts.keptBalls == counts.medialBalls && counts.cavities == 0 && segmentation.tidy == 0;
  return measureLabels(*segmentation.grain, {}, graphTells ? &segmentation.graph : nullptr,
                       interrupter);
}

double contactCoordination(const Measurements& measured) {
  if (measured.grains.empty()) return 0;
  const auto contacts =
      std::count_if(measured.bonds.begin(), measured.bonds.end(),
                    [](const BondMeasures& bond) { return bond.neck && bond.neck->touches(); });
  return 2.0 * double(contacts) / double(measured.grains.size());
}

ConfirmedNecks confirmedNecks(const Measurements& measured) {
  ConfirmedNecks necks;
  for (const BondMeasures& bond : measured.bonds)
    if (bond.neck && bond.neck->confirmed) {
      ++necks.count;
      necks.area += bond.neck->area;
      necks.labeledArea += bond.area;
    }
  return necks;
}

}  // namespace vdb_madf
