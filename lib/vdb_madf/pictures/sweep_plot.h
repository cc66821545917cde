// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/pictures/plot_type.h"
#include "vdb_madf/segmentation/parameter_sweep.h"

namespace vdb_madf {

/// The bytes of a file with three diagrams against theta, or against strictness (all rows by score,
/// or none): number of grains and median size (logarithmic axes), and share of grains below
/// `smallVoxels`. A line for each gamma (color), merge mode (dashes) and delta (width); rows in the
/// order of parameterSweep(). Values of 0 have no place on a logarithmic axis and are left out.
std::string sweepPlot(const std::vector<SweepRow>& rows, int64_t smallVoxels,
                      PlotType type = PlotType::svg);

}  // namespace vdb_madf
