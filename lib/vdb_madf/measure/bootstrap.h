// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/measure/extra_measures.h"
#include "vdb_madf/measure/measure_bonds.h"
#include "vdb_madf/measure/measure_grains.h"

namespace vdb_madf {

/// Few replicates do not tell where 2.5 % of them lie.
constexpr int kMinReplicates = 100, kMaxReplicates = 100000;

/// @throw InvalidInput if there are fewer or more
void requireReplicates(int replicates);

/// A mean of the sample, and where it lies in 95 % of the samples that grains drawn from it make.
struct MeanInterval {
  std::string name;  ///< letters and underscores, without the unit
  int power = 0;     ///< of a length, as in MeasureColumn
  /// None if there is nothing to take a mean of.
  std::optional<double> mean, low, high;
};

/// Sets `low` and `high` to the percentiles 2.5 and 97.5 of values, interpolated between neighbors
/// of rank (n - 1) q; of no values there are none.
void setInterval(std::vector<double> values, MeanInterval& interval);

/// Percentile bootstrap (Efron 1979): each replicate draws as many grains as there are, with
/// replacement, and takes the means anew; setInterval() takes those of the replicates. In this
/// order:
/// `grain_diameter_mean`, `grain_volume_mean`, `sphericity_mean`, `specific_surface` (sum of free
/// areas over sum of volumes), `mean_coordination`, `bond_to_grain_ratio` (mean over the bonds of
/// the grains drawn: a bond whose two grains are drawn counts twice), with the shape
/// `solidity_mean`, with edge weights `corrected_grain_diameter_mean`. Replicates in which one is
/// undefined, such as those without a bond, do not count for it.
///
/// The numbers are the same on every machine: replicate r, from 1, takes the outputs x of
/// std::mt19937(r), in their order, as grains x * n / 2^32, rounded down.
/// @throw InvalidInput as requireReplicates(); Interrupted.
std::vector<MeanInterval> bootstrapMeans(const std::vector<GrainMeasures>& grains,
                                         const std::vector<BondMeasures>& bonds,
                                         const ExtraMeasures& extra, int replicates,
                                         Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
