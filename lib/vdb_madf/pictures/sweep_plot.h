// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/method/parameter_sweep.h"

namespace vdb_madf {

/// The text of an SVG file, of three diagrams against theta: number of grains and median size (logarithmic axes), and
/// share of grains below `smallVoxels`. A line for each gamma (color), merge mode (dashes)
/// and delta (width);
/// rows in the order of parameterSweep(). Values of 0 have no place on a logarithmic axis and are left out.
std::string sweepPlot(const std::vector<SweepRow>& rows, int64_t smallVoxels);

}  // namespace vdb_madf
