// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/bootstrap.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf {

namespace {

constexpr double kLow = 0.025, kHigh = 0.975;
constexpr size_t kTogether = 4;  // replicates

/// A mean: the sum of numerators over that of denominators, an item a grain.
struct Quotient {
  double above = 0, below = 0;
};

/// What means are taken of.
class GrainQuotients {
 public:
  explicit GrainQuotients(const std::vector<GrainMeasures>& grains) : grains_(grains) {}

  template <typename Of>
  void add(const std::string& name, int power, const Of& of) {
    means_.push_back({name, power, {}, {}, {}});
    columns_.emplace_back();
    for (const GrainMeasures& grain : grains_) columns_.back().push_back(of(grain));
  }

  size_t count() const { return columns_.size(); }
  const Quotient& at(size_t mean, size_t grain) const { return columns_[mean][grain]; }
  const std::vector<MeanInterval>& means() const { return means_; }

 private:
  const std::vector<GrainMeasures>& grains_;
  std::vector<MeanInterval> means_;
  std::vector<std::vector<Quotient>> columns_;
};

/// The sum over the bonds of each grain, by id, of bond radius / radius of the smaller grain.
std::map<int32_t, double> bondRatios(const std::vector<GrainMeasures>& grains,
                                     const std::vector<BondMeasures>& bonds) {
  std::map<int32_t, double> diameters, ratios;
  for (const GrainMeasures& grain : grains) diameters[grain.id] = grain.equivalentDiameter;
  for (const BondMeasures& bond : bonds) {
    const double smaller = std::min(diameters.at(bond.first), diameters.at(bond.second));
    for (const int32_t id : {bond.first, bond.second})
      ratios[id] += 2 * bond.equivalentRadius / smaller;
  }
  return ratios;
}

GrainQuotients quotientsOf(const std::vector<GrainMeasures>& grains,
                           const std::vector<BondMeasures>& bonds, const ExtraMeasures& extra) {
  using G = GrainMeasures;
  GrainQuotients quotients(grains);
  const auto addMean = [&](const std::string& name, int power, const auto& number) {
    quotients.add(name, power, [&](const G& g) { return Quotient{double(number(g)), 1}; });
  };
  addMean("grain_diameter_mean", 1, [](const G& g) { return g.equivalentDiameter; });
  addMean("grain_volume_mean", 3, [](const G& g) { return g.volume; });
  quotients.add("sphericity_mean", 0, [](const G& g) {
    return Quotient{g.sphericity.value_or(0), g.sphericity ? 1.0 : 0.0};
  });
  quotients.add("specific_surface", -1, [](const G& g) { return Quotient{g.freeArea, g.volume}; });
  addMean("mean_coordination", 0, [](const G& g) { return g.coordination; });
  std::map<int32_t, double> ratios = bondRatios(grains, bonds);
  quotients.add("bond_to_grain_ratio", 0, [&](const G& g) {
    return Quotient{ratios[g.id], double(g.coordination)};
  });
  if (extra.shape) addMean("solidity_mean", 0, [](const G& g) { return g.solidity(); });
  if (extra.edgeWeights)
    quotients.add("corrected_grain_diameter_mean", 1, [](const G& g) {
      return Quotient{g.edgeWeight * g.equivalentDiameter, g.edgeWeight};
    });
  return quotients;
}

/// NaN where there is no mean.
double meanOf(const Quotient& sums) {
  return sums.below > 0 ? sums.above / sums.below : std::numeric_limits<double>::quiet_NaN();
}

/// \p values ascending, not empty.
double percentile(const std::vector<double>& values, double share) {
  const double rank = share * double(values.size() - 1);
  const auto below = size_t(rank);
  const size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (rank - double(below)) * (values[above] - values[below]);
}

}  // namespace

void requireReplicates(int replicates) {
  if (replicates < kMinReplicates || replicates > kMaxReplicates)
    throw InvalidInput(fmt::format("a bootstrap of {} replicates: must be from {} to {}",
                                   replicates, kMinReplicates, kMaxReplicates));
}

void setInterval(std::vector<double> values, MeanInterval& interval) {
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  interval.low = percentile(values, kLow);
  interval.high = percentile(values, kHigh);
}

std::vector<MeanInterval> bootstrapMeans(const std::vector<GrainMeasures>& grains,
                                         const std::vector<BondMeasures>& bonds,
                                         const ExtraMeasures& extra, int replicates,
                                         Interrupter* interrupter) {
  requireReplicates(replicates);
  const GrainQuotients quotients = quotientsOf(grains, bonds, extra);
  std::vector<MeanInterval> result = quotients.means();
  if (grains.empty()) return result;
  const size_t n = grains.size();
  std::vector<std::vector<double>> drawn(quotients.count(),
                                         std::vector<double>(size_t(replicates)));
  detail::parallelFor(size_t(replicates), kTogether, interrupter, [&](size_t begin, size_t end) {
    std::vector<size_t> times(n);
    for (size_t r = begin; r < end; ++r) {
      std::fill(times.begin(), times.end(), 0);
      std::mt19937 random(uint32_t(r + 1));
      for (size_t i = 0; i < n; ++i) ++times[size_t(uint64_t(random()) * n >> 32)];
      for (size_t k = 0; k < quotients.count(); ++k) {
        Quotient sums;
        for (size_t i = 0; i < n; ++i) {
          sums.above += double(times[i]) * quotients.at(k, i).above;
          sums.below += double(times[i]) * quotients.at(k, i).below;
        }
        drawn[k][r] = meanOf(sums);
      }
    }
  });
  for (size_t k = 0; k < quotients.count(); ++k) {
    Quotient sums;
    for (size_t i = 0; i < n; ++i) {
      sums.above += quotients.at(k, i).above;
      sums.below += quotients.at(k, i).below;
    }
    if (!(sums.below > 0)) continue;
    std::vector<double>& values = drawn[k];
    values.erase(
        std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
        values.end());
    result[k].mean = meanOf(sums);
    setInterval(std::move(values), result[k]);
  }
  return result;
}

}  // namespace vdb_madf
