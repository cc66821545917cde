// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/size_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/measure/detail/weighted_percentile.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

namespace {

constexpr double kNoSize = std::numeric_limits<double>::quiet_NaN();
constexpr double kAsTables = 1 + 1e-8;        // sizes that tables show as equal are equal
constexpr double kLowest = 5, kHighest = 95;  // per cent that deviations are taken of

/// The columns of sizes, and what each row counts.
struct Sizes {
  std::vector<MeasureColumn> kinds;
  std::vector<double> weights;

  explicit Sizes(const Measurements& measured) {
    const std::vector<std::string> names{"equivalent_diameter", "feret_min", "axis2_length",
                                         "projected_diameter"};
    for (MeasureColumn& column : grainColumns(measured.grains, measured.extra))
      if (std::count(names.begin(), names.end(), column.name)) kinds.push_back(std::move(column));
    for (const GrainMeasures& grain : measured.grains)
      weights.push_back(grain.volume * (measured.extra.edgeWeights ? grain.edgeWeight : 1));
  }
};

/// @throw InvalidInput
std::pair<double, double> pointOf(const std::string& line) {
  const size_t comma = line.find(',');
  const auto size = detail::reals(line.substr(0, comma));
  const auto percent =
      detail::reals(comma == std::string::npos ? std::string() : line.substr(comma + 1));
  if (!size || !percent || size->size() != 1 || percent->size() != 1 ||
      !std::isfinite(size->front()) || !(size->front() > 0) || !(percent->front() >= 0) ||
      !(percent->front() <= 100))
    throw InvalidInput(detail::inQuotes(line) +
                       ": is no size above 0 and percentage from 0 to 100, with a comma between");
  return {size->front(), percent->front()};
}

}  // namespace

std::vector<MeasureColumn> sizeCurve(const Measurements& measured) {
  const Sizes sizes(measured);
  std::vector<MeasureColumn> curve{{"percent_passing", MeasureColumn::Kind::count, 0, 0, {}}};
  for (int percent = 0; percent <= 100; ++percent) curve.front().values.push_back(percent);
  for (const MeasureColumn& kind : sizes.kinds) {
    std::vector<std::pair<double, double>> items;
    for (size_t i = 0; i < kind.values.size(); ++i)
      if (sizes.weights[i] > 0) items.emplace_back(kind.values[i], sizes.weights[i]);
    MeasureColumn column{kind.name, kind.kind, kind.power, 0, {}};
    for (const double percent : curve.front().values)
      column.values.push_back(items.empty() ? kNoSize : detail::weightedPercentile(items, percent));
    curve.push_back(std::move(column));
  }
  return curve;
}

SizeReference parseSizeReference(const std::string& text) {
  std::istringstream stream(text);
  std::string line;
  std::getline(stream, line);
  line = detail::trimmed(line);
  const std::string begin = "size_", end = ",percent_passing";
  SizeReference reference;
  if (line.size() > begin.size() + end.size() && line.compare(0, begin.size(), begin) == 0 &&
      line.compare(line.size() - end.size(), end.size(), end) == 0)
    reference.unit = line.substr(begin.size(), line.size() - begin.size() - end.size());
  if (reference.unit != "voxel" && !unitsPerMetre(reference.unit))
    throw InvalidInput(
        "a curve of sizes begins with the line size_mm,percent_passing (or size_um, "
        "size_voxel); this one with " +
        detail::inQuotes(line));
  bool isWithin = false;
  while (std::getline(stream, line)) {
    if (detail::trimmed(line).empty()) continue;
    const auto [size, percent] = pointOf(detail::trimmed(line));
    if (!reference.points.empty() &&
        (size <= reference.points.back().first || percent < reference.points.back().second))
      throw InvalidInput(
          detail::inQuotes(detail::trimmed(line)) +
          ": sizes have to ascend, and the percentage that passes must not fall with them");
    reference.points.emplace_back(size, percent);
    isWithin = isWithin || (percent >= kLowest && percent <= kHighest);
  }
  if (!isWithin)
    throw InvalidInput("a curve of sizes to compare with needs a percentage from 5 to 95");
  return reference;
}

double edgeIn(const SizeReference& reference, const std::optional<VoxelSize>& voxelSize) {
  if (reference.unit == "voxel") {
    if (voxelSize)
      throw InvalidInput("the sizes to compare with are in voxels, those of the grains in " +
                         voxelSize->unit() + ": give them in a unit of length, too");
    return 1;
  }
  if (!voxelSize)
    throw InvalidInput("the sizes to compare with are in " + reference.unit +
                       ", and the voxel size is unknown: give it");
  return voxelSize->shortestEdge() * unitsPerMetre(reference.unit).value();
}

std::vector<SizeDeviation> sizeDeviations(const Measurements& measured,
                                          const SizeReference& reference) {
  const double edge = edgeIn(reference, measured.voxelSize);
  const Sizes sizes(measured);
  double whole = 0;
  for (const double weight : sizes.weights) whole += weight;
  std::vector<SizeDeviation> deviations;
  for (const MeasureColumn& kind : sizes.kinds) {
    double squares = 0, points = 0;
    for (const auto& [size, percent] : reference.points) {
      if (percent < kLowest || percent > kHighest) continue;
      double passing = 0;
      for (size_t i = 0; i < kind.values.size(); ++i)
        if (kind.values[i] * edge <= size * kAsTables) passing += sizes.weights[i];
      const double difference = 100 * passing / whole - percent;
      squares += difference * difference;
      ++points;
    }
    deviations.push_back({kind.name, std::sqrt(squares / points)});
  }
  return deviations;
}

}  // namespace vdb_madf
