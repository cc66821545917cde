// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/column_colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/pictures/detail/canvas.h"
#include "vdb_madf/pictures/detail/diagram.h"

namespace vdb_madf {

namespace {

/// As in the page of `report` (viridis of matplotlib).
constexpr std::array<Rgb, 9> kScale{{{68, 1, 84},
                                     {71, 44, 122},
                                     {59, 81, 139},
                                     {44, 113, 142},
                                     {33, 144, 141},
                                     {39, 173, 129},
                                     {92, 200, 99},
                                     {170, 220, 50},
                                     {253, 231, 37}}};
constexpr Rgb kUnknown{150, 150, 150};

/// Of a share from 0 to 1.
Rgb scaleColor(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * double(kScale.size() - 1);
  const size_t below = std::min(kScale.size() - 2, size_t(place));
  Rgb color{};
  for (size_t i = 0; i < 3; ++i)
    color[i] = uint8_t(std::lround(
        kScale[below][i] + (place - double(below)) * (kScale[below + 1][i] - kScale[below][i])));
  return color;
}

/// A grain that is the same this much farther is as sure as any, and so is one that always is.
constexpr char kStability[] = "stability";
constexpr double kSure = 1;

void spanScale(std::vector<double> values, ColumnColors& result) {
  if (result.title == kStability) {
    result.high = kSure;
    return;
  }
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
               values.end());
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[size_t(std::lround(share * double(values.size() - 1)))];
  };
  result.low = at(0.01);
  result.high = at(0.99);
  if (!(result.high > result.low))
    result.high = result.low + (result.low == 0 ? 1 : std::abs(result.low));
}

}  // namespace

ColumnColors columnColors(const Measurements& measured, const std::string& column) {
  const std::string unit = measured.voxelSize ? measured.voxelSize->unit() : "voxel";
  openvdb::Vec3d edges = measured.edges;
  if (measured.voxelSize) edges = openvdb::Vec3d(measured.voxelSize->edgesInUnit().data());
  std::string all;
  const auto columns = grainColumns(measured.grains, measured.extra);
  const bool isGiven = std::any_of(columns.begin(), columns.end(), [&](const MeasureColumn& known) {
    return known.name == givenName(column);
  });
  const std::string wanted = isGiven ? givenName(column) : column;
  for (const MeasureColumn& known : columns) {
    const std::string title = known.name + unitSuffix(known.power, unit);
    if (wanted != known.name && wanted != title) {
      all += (all.empty() ? "" : ", ") + known.name;
      continue;
    }
    ColumnColors result;
    result.title = title;
    std::vector<double> values;
    for (const double value : known.values)
      values.push_back(title == kStability && std::isnan(value) ? kSure
                                                                : scaled(known, value, edges));
    spanScale(values, result);
    for (size_t i = 0; i < values.size(); ++i) {
      result.colors.labels.push_back(measured.grains[i].id);
      result.colors.colors.push_back(
          std::isnan(values[i])
              ? kUnknown
              : scaleColor((values[i] - result.low) / (result.high - result.low)));
    }
    return result;
  }
  throw InvalidInput("grains have no " + detail::inQuotes(column) + ": there are " + all);
}

PicturePanel colorScalePanel(const ColumnColors& colors, int edge, const Rgb& background) {
  constexpr int kSteps = 256, kTicks = 4;
  const double text = std::max(10.0, edge / 36.0);
  const double top = text, tall = std::max(1.0, edge - 2 * text), wide = 2 * text;
  PicturePanel panel{Picture(int(std::ceil(9 * text)), edge, background), colors.title, 0, false};
  detail::paint(panel.picture, 0, 0, panel.picture.width, edge, [&](detail::Canvas& canvas) {
    for (int i = 0; i < kSteps; ++i)  // each reaches below the next one
      canvas.rectangle({0, top + tall * i / kSteps}, wide, tall * (kSteps - i) / kSteps,
                       scaleColor(1 - (i + 0.5) / kSteps));
    for (int i = 0; i <= kTicks; ++i) {
      const double share = double(i) / kTicks;
      canvas.text({wide + 0.5 * text, top + tall * (1 - share) + 0.35 * text},
                  detail::generalDecimal(colors.low + share * (colors.high - colors.low), 3), text,
                  detail::kPlotInk);
    }
  });
  return panel;
}

}  // namespace vdb_madf
