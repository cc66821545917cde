// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/measure_sensitivity.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/intensity/estimate_blur.h"
#include "vdb_madf/matching/compare.h"
#include "vdb_madf/scans/filtered_image.h"
#include "vdb_madf/scans/histogram.h"
#include "vdb_madf/scans/image_object.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf {

namespace {

constexpr double kThresholdShare = 0.2;  // of the contrast
constexpr double kSmoothShare = 0.5;     // of the blur
constexpr double kUsualBlur = 0.7;       // voxels, where a scan tells none
constexpr double kStrictness = 3;
constexpr double kGamma = 8;
/// Of the voxels of an object: a mask that was cropped after it was despeckled differs by less.
constexpr double kOtherVoxels = 0.001;

/// How labels were made of a scan.
struct Choices {
  Selection selection;
  GrayOptions gray;
  SegmentOptions segment;
};

Choices choicesOf(const Int32Grid& labels) {
  const auto reading = storedReading(labels);
  if (!reading)
    throw InvalidInput(
        "the labels do not tell the threshold of a scan that they were made by: segment the scan "
        "itself with a threshold");
  if (labels[kEditsKey])
    throw InvalidInput(
        "the sensitivity is that of grains as they were segmented, and these were edited: measure "
        "it without the edits");
  const auto merging = storedMerging(labels);
  if (!merging || merging->options.mode != MergeMode::score)
    throw InvalidInput(
        "the labels do not tell that they were merged by score: what another merging hangs on is "
        "not known");
  if (!hasSegmentedVoxels(labels))
    throw InvalidInput(
        "the labels are not all that was segmented, or of other voxels, and grains hang on what "
        "was beside them: measure the sensitivity of the whole labels, or crop the scan and "
        "segment that");
  Choices choices{reading->selection, reading->gray, {}};
  choices.segment.merge = merging->options;
  choices.segment.tidy = merging->tidy;
  const auto number = [&](const char* key) {
    const auto value = labels.getMetadata<openvdb::Int64Metadata>(key);
    return value ? value->value() : 0;
  };
  choices.segment.gamma = number("madf_gamma");
  choices.segment.fillHoles = number("madf_fill_holes");
  choices.segment.boundary = storedBoundary(labels);
  choices.segment.domain = storedDomain(labels);
  return choices;
}

/// The difference of the means of the gray values from a threshold on and of those below it.
double contrastAt(double threshold, ImageReader& image) {
  const Histogram histogram = histogramOf(image);
  if (kindOf(histogram) != ImageKind::gray)
    throw InvalidInput(image.path() + ": is no gray scan, so that its threshold cannot be varied");
  double sums[2] = {0, 0}, counts[2] = {0, 0};
  for (size_t bin = 0; bin < histogram.counts.size(); ++bin) {
    const double value = histogram.lowerEdge(bin);
    sums[value >= threshold] += value * double(histogram.counts[bin]);
    counts[value >= threshold] += double(histogram.counts[bin]);
  }
  return sums[1] / std::max(1.0, counts[1]) - sums[0] / std::max(1.0, counts[0]);
}

Sensitivity boundsOf(const Choices& choices, const SensitivityOptions& options,
                     const std::optional<ScanBlur>& known, const std::function<GrayScan()>& open,
                     Interrupter* interrupter) {
  double threshold = options.threshold.value_or(0), smooth = options.smooth.value_or(0);
  if (!options.threshold || !options.smooth) {
    const auto blur = known ? known : estimateBlur(open(), choices.segment.domain, interrupter);
    const double contrast = blur ? std::abs(blur->inside - blur->outside)
                                 : contrastAt(choices.selection.low, *open().image);
    const double share = std::max(kThresholdShare, blur ? blur->noise : 0);
    threshold = options.threshold.value_or(share * contrast);
    smooth = options.smooth.value_or(kSmoothShare * (blur ? blur->sigma : kUsualBlur));
  }
  const double strictness = options.strictness.value_or(kStrictness);
  Sensitivity bounds;
  bounds.runs = options.runs;
  bounds.threshold = {choices.selection.low - threshold, choices.selection.low + threshold};
  bounds.smooth = {std::max(0.0, choices.gray.smooth - smooth),
                   std::min(kMaxSmoothing, choices.gray.smooth + smooth)};
  bounds.strictness = {choices.segment.merge.strictness - strictness,
                       choices.segment.merge.strictness + strictness};
  const auto gamma = double(std::max<int64_t>(1, choices.segment.gamma));
  bounds.gamma = {gamma, std::max(gamma, std::floor(options.gamma.value_or(kGamma)))};
  return bounds;
}

/// Element `index` of the van der Corput sequence: the digits behind the point, turned around.
double radicalInverse(int index, int base) {
  double value = 0, digit = 1;
  for (; index > 0; index /= base) value += (digit /= base) * (index % base);
  return value;
}

Choices choicesOfRun(Choices choices, const Sensitivity& bounds, int run) {
  const auto drawn = [&](const VariedRange& range, int base) {
    return range.low + (range.high - range.low) * radicalInverse(run, base);
  };
  const double threshold = drawn(bounds.threshold, 2);
  if (choices.gray.low) *choices.gray.low += threshold - choices.selection.low;
  choices.selection.low = threshold;
  choices.gray.smooth = drawn(bounds.smooth, 3);
  if (choices.gray.smooth < kMinSmoothing) choices.gray.smooth = 0;
  choices.segment.merge.strictness = drawn(bounds.strictness, 5);
  const VariedRange logarithms{std::log(bounds.gamma.low), std::log(bounds.gamma.high)};
  choices.segment.gamma = std::llround(std::exp(drawn(logarithms, 7)));
  return choices;
}

/// Adds up how often grains and bonds come again.
class Recurrences {
 public:
  explicit Recurrences(const Measurements& measured)
      : measured_(measured), grains_(measured.grains.size()), bonds_(measured.bonds.size()) {}

  void add(const Comparison& comparison, const Measurements& run) {
    std::map<int32_t, const GrainMatch*> matches;
    for (const GrainMatch& match : comparison.truthMatches) matches[match.grain] = &match;
    std::map<int32_t, double> volumes;
    for (const GrainMeasures& grain : run.grains) volumes[grain.id] = grain.volume;
    std::map<std::pair<int32_t, int32_t>, double> areas;
    for (const BondMeasures& bond : run.bonds) areas[{bond.first, bond.second}] = bond.area;
    for (size_t i = 0; i < grains_.size(); ++i) {
      const GrainMatch& match = *matches.at(measured_.grains[i].id);
      if (match.intersectionOverUnion > 0.5) grains_[i].add(volumes.at(match.partner));
    }
    for (size_t i = 0; i < bonds_.size(); ++i) {
      const auto [a, b] = std::minmax(matches.at(measured_.bonds[i].first)->partner,
                                      matches.at(measured_.bonds[i].second)->partner);
      const auto area = areas.find({a, b});
      if (area != areas.end()) bonds_[i].add(area->second);
    }
  }

  Recurrence ofGrain(size_t i, int runs) const { return grains_[i].recurrence(runs); }
  Recurrence ofBond(size_t i, int runs) const { return bonds_[i].recurrence(runs); }

 private:
  /// Numbers that are met one by one: their count, mean and sum of squared deviations (Welford
  /// 1962).
  struct Met {
    int count = 0;
    double mean = 0, squares = 0;

    void add(double value) {
      const double before = value - mean;
      mean += before / ++count;
      squares += before * (value - mean);
    }
    Recurrence recurrence(int runs) const {
      return {double(count) / runs, count > 0 ? std::sqrt(squares / count) : 0};
    }
  };

  const Measurements& measured_;
  std::vector<Met> grains_, bonds_;
};

/// A scan is the one that labels were made of if their choices make their voxels of it.
void checkObject(const Int32Grid& labels, const MaskGrid& object, const std::string& path) {
  const MaskGrid::Ptr labeled = objectMask(labels);
  const auto own = double(labeled->activeVoxelCount());
  double others = own + double(object.activeVoxelCount());
  labeled->tree().topologyIntersection(object.tree());
  others -= 2 * double(labeled->activeVoxelCount());
  if (others <= kOtherVoxels * own) return;
  throw InvalidInput(fmt::format(
      "{}: the threshold and filters of the labels make another object of it, {:.1f} % of its "
      "voxels are others: give the scan as it was segmented, of the same values and voxels",
      path, 100 * others / std::max(1.0, own)));
}

/// The numbers of a sample that intervals are told of; those of grains where there are any.
std::vector<MeanInterval> numbersOf(const Measurements& m) {
  double area = 0;
  for (const BondMeasures& bond : m.bonds) area += bond.area;
  std::optional<double> byNumber, byVolume, surface, coordination, meanArea;
  if (!m.grains.empty()) {
    byNumber = diameterPercentile(m.grains, 0.5, false);
    byVolume = diameterPercentile(m.grains, 0.5, true);
    surface = m.sample.specificSurface;
    coordination = m.sample.meanCoordination;
  }
  if (!m.bonds.empty()) meanArea = area / double(m.bonds.size());
  return {{"grains", 0, double(m.grains.size()), {}, {}},
          {"grain_diameter_d50_by_number", 1, byNumber, {}, {}},
          {"grain_diameter_d50_by_volume", 1, byVolume, {}, {}},
          {"solid_fraction", 0, m.sample.objectFraction, {}, {}},
          {"specific_surface", -1, surface, {}, {}},
          {"mean_coordination", 0, coordination, {}, {}},
          {"bond_area_mean", 2, meanArea, {}, {}}};
}

std::vector<MeanInterval> intervalsOf(const std::vector<std::vector<MeanInterval>>& runs) {
  std::vector<MeanInterval> result = runs.front();
  for (size_t k = 0; k < result.size(); ++k) {
    std::vector<double> values;
    for (const auto& numbers : runs)
      if (numbers[k].mean) values.push_back(*numbers[k].mean);
    if (values.empty()) continue;
    result[k].mean = std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
    setInterval(std::move(values), result[k]);
  }
  return result;
}

}  // namespace

bool SensitivityOptions::vary(const std::string& name, double number) {
  std::optional<double>* const choice = name == "threshold"    ? &threshold
                                        : name == "smooth"     ? &smooth
                                        : name == "strictness" ? &strictness
                                        : name == "gamma"      ? &gamma
                                                               : nullptr;
  if (!choice) return false;
  if (!(number >= 0)) throw InvalidInput(name + " must be 0 or more");
  if (choice == &strictness && number > kMaxStrictness)
    throw InvalidInput(fmt::format("{} must be at most {}", name, kMaxStrictness));
  *choice = number;
  return true;
}

void measureSensitivity(const Int32Grid& labels, const std::function<GrayScan()>& open,
                        const SensitivityOptions& options, Measurements& measured,
                        Interrupter* interrupter) {
  if (options.runs < kMinRuns || options.runs > kMaxRuns)
    throw InvalidInput(fmt::format("a sensitivity from {} runs: must be from {} to {}",
                                   options.runs, kMinRuns, kMaxRuns));
  const Choices choices = choicesOf(labels);
  {
    GrayScan scan = open();
    if (scan.first != Coord(0))
      throw InvalidInput(scan.image->path() +
                         ": its voxels do not begin at 0,0,0: save it as .tif");
    placeScan(scan, measured.sample);
    if (scan.first != Coord(0))
      throw InvalidInput(scan.image->path() + ": is a part of the scan: give the whole one");
  }
  const Domain& domain = *choices.segment.domain;
  const auto objectOf = [&](const Choices& chosen, Interrupter* reading) {
    const auto image = [&] { return std::move(open().image); };
    return imageObject(image, chosen.selection, chosen.gray, ScanPart{domain.box(), domain},
                       reading)
        .mask;
  };
  detail::WorkPart before(interrupter, 0, 0);
  checkObject(labels, *objectOf(choices, &before), open().image->path());
  Sensitivity sensitivity = boundsOf(choices, options, measured.scan, open, interrupter);
  MeasureOptions measuring;
  measuring.boundary = options.measure.boundary == Boundary::automatic ? choices.segment.boundary
                                                                       : options.measure.boundary;
  measuring.domain = domain;
  measuring.minFaces = options.measure.minFaces;
  Recurrences recurrences(measured);
  std::vector<std::vector<MeanInterval>> numbers;
  for (int run = 1; run <= options.runs; ++run) {
    detail::WorkPart part(interrupter, 100 * (run - 1) / options.runs, 100 * run / options.runs);
    const Choices varied = choicesOfRun(choices, sensitivity, run);
    detail::WorkPart reading(&part, 0, 20), segmenting(&part, 20, 70), rest(&part, 70, 100);
    try {
      const MaskGrid::Ptr object = objectOf(varied, &reading);
      copyProvenance(labels, *object);
      const Segmentation again = segment(*object, varied.segment, &segmenting);
      const Measurements there = measure(*again.grain, measuring, &rest);
      recurrences.add(compare(labels, *again.grain, &rest), there);
      numbers.push_back(numbersOf(there));
    } catch (const InvalidInput& error) {
      throw InvalidInput(
          fmt::format("run {} (threshold {:g}, smooth {:.3g}, strictness {:.4g}, gamma {}): {}; "
                      "vary less",
                      run, varied.selection.low, varied.gray.smooth,
                      varied.segment.merge.strictness, varied.segment.gamma, error.what()),
          error.hint());
    }
  }
  for (size_t i = 0; i < measured.grains.size(); ++i)
    measured.grains[i].recurrence = recurrences.ofGrain(i, options.runs);
  for (size_t i = 0; i < measured.bonds.size(); ++i)
    measured.bonds[i].recurrence = recurrences.ofBond(i, options.runs);
  sensitivity.intervals = intervalsOf(numbers);
  measured.sensitivity = std::move(sensitivity);
  measured.extra.recurrence = true;
}

}  // namespace vdb_madf
