// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "image_values.h"

#include <cmath>

#include "scan_option.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/intensity/estimate_blur.h"
#include "vdb_madf/pictures/histogram_plot.h"

namespace vdb_madf::tools {

namespace {

/// Bins of what is written; what is shown of a histogram with more is gathered.
constexpr size_t kBins = 256;

const char* nameOf(ImageKind kind) {
  switch (kind) {
    case ImageKind::mask:
      return "mask";
    case ImageKind::phases:
      return "phases";
    case ImageKind::labels:
      return "labels";
    case ImageKind::gray:
      break;
  }
  return "gray";
}

/// 255 rather than 255.0.
Json number(double value) {
  if (std::floor(value) == value && std::abs(value) < 1e15) return int64_t(value);
  return value;
}

}  // namespace

Histogram countValues(const InputOptions& input, Progress* progress) {
  return histogramOf(*openVolumeImage(input.path, input.volume(progress)), progress);
}

void describeValues(const InputOptions& input, const Histogram& histogram, Json& json,
                    Progress* progress) {
  const ImageKind kind = kindOf(histogram);
  json["kind"] = nameOf(kind);
  if (histogram.notFinite > 0) json["voxels_not_finite"] = histogram.notFinite;
  if (histogram.counts.empty()) return;
  json["value_min"] = number(histogram.min);
  json["value_max"] = number(histogram.max);
  json["histogram"] = histogramLine(histogram);
  if (histogram.max > histogram.min)
    json["histogram_counts"] = gathered(histogram, histogram.min, histogram.max, kBins);
  if (kind == ImageKind::mask || kind == ImageKind::phases)
    for (size_t i = 0; i < histogram.few.size(); ++i)
      json["voxels_of_value"].push_back({number(histogram.few[i]), histogram.fewCounts[i]});
  if (kind == ImageKind::labels)
    json["labels"] =
        countLabels(histogram, *openVolumeImage(input.path, input.volume(progress)), progress);
  if (kind != ImageKind::gray) return;
  if (const auto otsu = otsuThreshold(histogram)) {
    json["otsu_threshold"] = number(*otsu);
    json["otsu_object_share"] =
        double(voxelsFrom(histogram, *otsu)) / double(histogram.finite + histogram.notFinite);
  }
  if (histogram.inside) {
    json["value_at_all_corners"] = number(*histogram.corner);
    if (const auto otsu = otsuThreshold(*histogram.inside))
      json["otsu_threshold_without_it"] = number(*otsu);
  }
  if (const auto valley = valleyThreshold(histogram)) json["valley_threshold"] = number(*valley);
  if (const auto blur =
          estimateBlur(*openVolumeImage(input.path, input.volume(progress)), progress)) {
    noteOfScan(input.path, noteOn(*blur), progress);
    json["blur_voxels"] = blur->sigma;
    json["noise_of_contrast"] = blur->noise;
  }
}

std::string plotValues(const InputOptions& input, const Histogram& histogram, PlotType type) {
  if (!(histogram.max > histogram.min))
    throw InvalidInput(input.path + ": has one value at most, so there is no histogram to draw");
  std::vector<PlotMark> marks;
  if (kindOf(histogram) == ImageKind::gray) {
    if (const auto otsu = otsuThreshold(histogram)) marks.push_back({*otsu, "otsu"});
    if (const auto valley = valleyThreshold(histogram)) marks.push_back({*valley, "valley"});
  }
  return histogramPlot(gathered(histogram, histogram.min, histogram.max, kBins), histogram.min,
                       histogram.max, marks, type);
}

}  // namespace vdb_madf::tools
