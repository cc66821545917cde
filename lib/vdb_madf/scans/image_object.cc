// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/image_object.h"

#include <fmt/core.h>
#include <openvdb/Metadata.h>

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/gaussian.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/mask_sets.h"
#include "vdb_madf/grids/object_keys.h"
#include "vdb_madf/scans/detail/histogram_builder.h"
#include "vdb_madf/scans/detail/non_finite_count.h"
#include "vdb_madf/scans/detail/padded_image.h"
#include "vdb_madf/scans/detail/scan_part.h"
#include "vdb_madf/scans/filtered_image.h"
#include "vdb_madf/scans/histogram.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/scans/mask_cleaning.h"
#include "vdb_madf/scans/read_mask.h"

namespace vdb_madf {

namespace {

using detail::shortestDecimal;

std::string percent(int64_t part, int64_t whole) {
  return detail::fixedDecimal(100 * double(part) / double(whole), 1) + " %";
}

using ThresholdOf = std::optional<double> (*)(const Histogram&);

/// What the threshold of a gray image would be without the padding around a round field of view;
/// none if there is hardly any, or if that hardly changes the object.
std::optional<double> thresholdInside(const Histogram& histogram, ThresholdOf thresholdOf,
                                      double threshold) {
  constexpr double kLittle = 0.001;  // of the voxels
  const double little = kLittle * double(histogram.finite);
  if (!histogram.inside || double(histogram.padding) <= little) return std::nullopt;
  if (kindOf(histogram) != ImageKind::gray) return std::nullopt;
  const auto other = thresholdOf(*histogram.inside);
  if (!other) return std::nullopt;
  const auto change = double(voxelsFrom(histogram, threshold) - voxelsFrom(histogram, *other));
  return std::abs(change) <= little ? std::nullopt : other;
}

std::string cornerText(const Histogram& histogram) {
  return "without the value " + shortestDecimal(*histogram.corner) +
         ", which the corners of all slices have";
}

std::string grayRefusal(const Histogram& histogram) {
  std::string text =
      fmt::format("is a gray image ({}, values {} to {}; {}): say which values are object",
                  sampleTypeName(histogram.type), shortestDecimal(histogram.min),
                  shortestDecimal(histogram.max), histogramLine(histogram));
  if (const auto otsu = otsuThreshold(histogram)) {
    const auto voxels = histogram.finite + histogram.notFinite;
    text += fmt::format("; Otsu's threshold is {}, which takes {}", shortestDecimal(*otsu),
                        percent(voxelsFrom(histogram, *otsu), voxels));
    if (const auto inside = thresholdInside(histogram, otsuThreshold, *otsu))
      text += fmt::format(", or {} {}, which takes {}", shortestDecimal(*inside),
                          cornerText(histogram), percent(voxelsFrom(histogram, *inside), voxels));
  }
  return text;
}

std::string phasesRefusal(const Histogram& histogram) {
  std::string text = "has the values";
  for (const double value : histogram.few)
    text += (value == histogram.few[0] ? " " : ", ") + shortestDecimal(value);
  return text + ": say which of them are object";
}

using Part = std::optional<ScanPart>;

/// An image behind its filters; what is said of it and of its padding is so before them.
struct FilteredScan {
  FilteredScan(std::unique_ptr<ImageReader> image, const GrayOptions& gray, const Part& part)
      : scan(std::move(image)),
        padded(*scan, gray.median + (gray.smooth > 0 ? detail::gaussianRadius(gray.smooth) : 0),
               part ? part->box : CoordBBox::inf()) {
    auto counted =
        std::make_unique<detail::CountedImage>(padded, detail::middleRows(scan->info().size));
    sample = counted.get();
    filtered = filteredImage(std::move(counted), gray);
  }
  std::unique_ptr<ImageReader> scan;
  detail::PaddedImage padded;
  const detail::CountedImage* sample;  ///< the middle rows, which tell the kind at little cost
  std::unique_ptr<ImageReader> filtered;
};

bool isBox(const Part& part) {
  return !part || part->domain.isBox();
}

struct PartMasks {
  std::vector<MaskGrid::Ptr> masks;
  int64_t leftOut = 0;  ///< of the first
};

/// One mask a selection, of the part of the image. `take` gets the layers of the first.
PartMasks readPart(ImageReader& image, const std::vector<Selection>& selections, const Part& part,
                   Interrupter* interrupter, const TakeLayer& take = nullptr) {
  int64_t leftOutOfLayers = 0;
  LayerRead layerRead;
  if (take)
    layerRead = [&](const std::vector<MaskGrid::Ptr>& masks) {
      if (part) leftOutOfLayers += detail::cutTo(*part, *masks[0]);
      masks[0]->tree().voxelizeActiveTiles();
      take(masks[0]->tree());
      masks[0]->clear();
    };
  if (!part) return {readMasks(image, selections, interrupter, std::nullopt, layerRead), 0};
  PartMasks result{
      readMasks(image, selections, interrupter, detail::boxOf(*part, image.info().size), layerRead),
      leftOutOfLayers};
  for (const MaskGrid::Ptr& mask : result.masks) {
    const int64_t leftOut = detail::cutTo(*part, *mask);
    if (mask == result.masks[0]) result.leftOut += leftOut;
  }
  if (selections[0].invert) result.leftOut = 0;
  return result;
}

/// What is not 0 (or, inverted, what is), unless that would be a guess.
ImageObject plainMask(ImageReader& image, const Selection& nonZero, const Part& part,
                      const detail::PaddedImage& padding, Interrupter* interrupter,
                      const TakeLayer& take) {
  detail::CountedImage counted(image, part ? detail::rowsOf(*part, image.info().size) : nullptr,
                               &padding);
  const PartMasks read = readPart(counted, {nonZero}, part, interrupter, take);
  const Histogram histogram = counted.histogram();
  const ImageKind kind = kindOf(histogram);
  if (kind == ImageKind::gray) throw SelectionNeeded(image.path() + ": " + grayRefusal(histogram));
  if (kind == ImageKind::phases)
    throw SelectionNeeded(image.path() + ": " + phasesRefusal(histogram));
  return {read.masks[0], read.leftOut, kind == ImageKind::labels && !nonZero.invert};
}

double automaticThreshold(const FilteredScan& scan, AutomaticThreshold method, const Part& part,
                          Interrupter* interrupter) {
  ImageReader& image = *scan.filtered;
  const CoordBBox whole = imageBox(image.info().size);
  const Histogram histogram = detail::histogramIn(part.value_or(ScanPart{whole, Domain(whole)}),
                                                  image, scan.padded, interrupter);
  const bool isOtsu = method == AutomaticThreshold::otsu;
  const ThresholdOf thresholdOf = isOtsu ? otsuThreshold : valleyThreshold;
  const auto threshold = thresholdOf(histogram);
  if (!threshold && isOtsu)
    throw InvalidInput(image.path() + ": has but one value, so Otsu's threshold cannot divide it");
  if (!threshold)
    throw SelectionNeeded(fmt::format(
        "{}: its histogram ({}) has no two modes with a valley between them: choose another "
        "threshold",
        image.path(), histogramLine(histogram)));
  if (const auto inside = thresholdInside(histogram, thresholdOf, *threshold))
    throw SelectionNeeded(
        fmt::format("{}: the threshold would be {}, but {} {} (a round field of view?): {}, or "
                    "choose one of the two by its value",
                    image.path(), shortestDecimal(*threshold), shortestDecimal(*inside),
                    cornerText(histogram),
                    isBox(part) ? "say that the scan is a cylinder" : "give a smaller region"),
        isBox(part));
  return *threshold;
}

/// The value at the corners of all slices, if it stands around a gray scan.
std::optional<double> cornerOfGray(const Histogram& histogram, std::optional<double> corner) {
  if (!corner || kindOf(histogram) != ImageKind::gray) return std::nullopt;
  // A circle leaves 21 % of its square; what most voxels have is the pore of a scan without noise.
  constexpr double kMostAround = 0.4;
  return double(voxelsAround(histogram, *corner)) <= kMostAround * double(histogram.finite)
             ? corner
             : std::nullopt;
}

/// Voxels from `high` on, and those from `low` on that are connected with them; if the selection is
/// inverted, all others.
ImageObject hysteresisMask(ImageReader& image, double low, const Selection& high, const Part& part,
                           Interrupter* interrupter) {
  Selection below = Selection::threshold(low);
  below.invert = true;
  std::vector<Selection> selections{Selection::threshold(low), Selection::threshold(high.low)};
  if (high.invert) selections.push_back(below);
  const PartMasks read = readPart(image, selections, part, interrupter);
  const std::vector<MaskGrid::Ptr>& masks = read.masks;
  const MaskGrid::Ptr object = masks[0];
  detail::WorkPart end(interrupter, 100, 100);
  if (!high.invert) {
    keepSeeded(*object, *masks[1], &end);
    return {object, read.leftOut};
  }
  const MaskGrid::Ptr seeded = object->deepCopy();
  keepSeeded(*seeded, *masks[1], &end);
  detail::subtract(object->tree(), seeded->tree());
  object->tree().topologyUnion(masks[2]->tree());
  return {object};
}

std::string describe(const Selection& selection, const GrayOptions& gray) {
  const std::string low = shortestDecimal(selection.low), high = shortestDecimal(selection.high);
  std::string text;
  switch (selection.kind) {
    case Selection::Kind::nonZero:
      text = "value not 0";
      break;
    case Selection::Kind::phase:
      text = "value " + low;
      for (const double value : selection.more) text += " or " + shortestDecimal(value);
      break;
    case Selection::Kind::threshold:
      text = "value >= " + low;
      break;
    case Selection::Kind::range:
      text = "value " + low + " to " + high;
      break;
  }
  if (gray.automatic == AutomaticThreshold::otsu) text += " (otsu)";
  if (gray.automatic == AutomaticThreshold::valley) text += " (valley)";
  if (gray.low) text += ", or >= " + shortestDecimal(*gray.low) + " connected with such";
  return text + (selection.invert ? ", inverted" : "");
}

void setText(openvdb::GridBase& grid, const std::string& text) {
  grid.insertMeta(kObjectKey, openvdb::StringMetadata(text));
}

void describeObject(const Selection& selection, const GrayOptions& gray, MaskGrid& object) {
  std::string text;
  if (gray.median > 0) text += "median " + std::to_string(gray.median) + ", ";
  if (gray.smooth > 0) text += "smooth " + shortestDecimal(gray.smooth) + ", ";
  setText(object, text + describe(selection, gray));
  if (gray.low) object.insertMeta(kThresholdLowKey, openvdb::DoubleMetadata(*gray.low));
}

}  // namespace

bool readsGray(const GrayOptions& gray) {
  return gray.median > 0 || gray.smooth > 0 || gray.low ||
         gray.automatic != AutomaticThreshold::none;
}

std::unique_ptr<ImageReader> filteredImage(std::unique_ptr<ImageReader> image,
                                           const GrayOptions& gray) {
  if (gray.median != 0) image = medianImage(std::move(image), gray.median);
  if (gray.smooth != 0) image = smoothedImage(std::move(image), gray.smooth);
  return image;
}

ImageObject imageObject(const std::function<std::unique_ptr<ImageReader>()>& open,
                        const std::optional<Selection>& selection, const GrayOptions& gray,
                        const std::optional<ScanPart>& part, Interrupter* interrupter,
                        const TakeLayer& take) {
  if (gray.smooth > 0 && selection && selection->kind == Selection::Kind::phase)
    throw InvalidInput(open()->path() +
                       ": a Gaussian leaves no voxel the value of a phase: write the phase as a "
                       "volume of its own first, or choose by a threshold");
  const bool automatic = gray.automatic != AutomaticThreshold::none;
  Selection chosen = selection.value_or(Selection{});
  if (automatic) {
    detail::WorkPart counting(interrupter, 0, 50);
    const bool invert = chosen.invert;
    const FilteredScan scan(open(), gray, part);
    chosen = Selection::threshold(automaticThreshold(scan, gray.automatic, part, &counting));
    chosen.invert = invert;
  }
  detail::WorkPart reading(interrupter, automatic ? 50 : 0, 100);
  const bool needsWhole = gray.low || gray.despeckle > 1;
  const TakeLayer takeRead = needsWhole ? nullptr : take;
  const FilteredScan scan(open(), gray, part);
  const ImageSize size = scan.filtered->info().size;
  const auto rowsIn = [&](const Domain& domain) {
    return detail::rowsOf({CoordBBox::inf(), domain}, size);
  };
  detail::NonFiniteCount read(*scan.filtered, part ? rowsIn(part->domain) : nullptr);
  ImageObject object;
  if (!gray.low && chosen.kind == Selection::Kind::nonZero) {
    object = plainMask(read, chosen, part, scan.padded, &reading, takeRead);
  } else {
    if (gray.low) {
      object = hysteresisMask(read, *gray.low, chosen, part, &reading);
    } else {
      const PartMasks found = readPart(read, {chosen}, part, &reading, takeRead);
      object = {found.masks[0], found.leftOut};
    }
    const int slices = part ? detail::boxOf(*part, size).dim().z() : size.z;
    if (isBox(part) && scan.padded.isAtCorners() && slices >= kCornerSlices)
      object.corner = cornerOfGray(scan.sample->histogram(), scan.padded.corner());
  }
  object.nans = read.nans();
  object.infinities = read.infinities();
  if (readsGray(gray) || (chosen.kind == Selection::Kind::threshold && chosen.invert))
    describeObject(chosen, gray, *object.mask);
  if (chosen.kind == Selection::Kind::threshold)
    object.mask->insertMeta(kThresholdKey, openvdb::DoubleMetadata(chosen.low));
  despeckleObject(*object.mask, gray.despeckle, interrupter);
  if (take && needsWhole) takeLayers(object.mask->tree(), take);
  return object;
}

void takeLayers(MaskTree& object, const TakeLayer& take) {
  object.voxelizeActiveTiles();
  std::vector<const MaskTree::LeafNodeType*> leaves;
  for (auto leaf = object.cbeginLeaf(); leaf; ++leaf) leaves.push_back(&*leaf);
  std::stable_sort(leaves.begin(), leaves.end(),
                   [](const auto* a, const auto* b) { return a->origin().z() < b->origin().z(); });
  for (auto next = leaves.begin(); next != leaves.end();) {
    MaskTree layer;
    const int z = (*next)->origin().z();
    for (; next != leaves.end() && (*next)->origin().z() == z; ++next)
      layer.addLeaf(new MaskTree::LeafNodeType(**next));
    take(layer);
  }
  object.clear();
}

std::optional<StoredReading> storedReading(const openvdb::MetaMap& metadata) {
  const auto threshold = metadata.getMetadata<openvdb::DoubleMetadata>(kThresholdKey);
  if (!threshold) return std::nullopt;
  StoredReading reading{Selection::threshold(threshold->value()), {}};
  if (const auto low = metadata.getMetadata<openvdb::DoubleMetadata>(kThresholdLowKey))
    reading.gray.low = low->value();
  const auto text = metadata.getMetadata<openvdb::StringMetadata>(kObjectKey);
  std::istringstream steps(text ? text->value() : "");
  steps.imbue(std::locale::classic());
  for (std::string word; steps >> word;) {
    if (word == "median") steps >> reading.gray.median;
    if (word == "smooth") steps >> reading.gray.smooth;
    if (word == "despeckle") steps >> reading.gray.despeckle;
    if (word == "inverted" || word == "inverted,") reading.selection.invert = true;
  }
  return reading;
}

void despeckleObject(MaskGrid& object, int64_t voxels, Interrupter* interrupter) {
  if (voxels <= 1) return;
  detail::WorkPart end(interrupter, 100, 100);
  const Despeckled counts = despeckle(object, voxels, &end);
  const auto before = object.getMetadata<openvdb::StringMetadata>(kObjectKey);
  setText(object, fmt::format("{}despeckle {} ({} voxels dropped, {} filled)",
                              before ? before->value() + ", " : "", voxels, counts.islandVoxels,
                              counts.cavityVoxels));
}

}  // namespace vdb_madf
