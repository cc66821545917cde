// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/measure/measure.h"
#include "vdb_madf/pictures/plot_type.h"

namespace vdb_madf {

/// The bytes of a file with histograms of grains (diameter by number and by volume, sphericity,
/// coordination) and of bonds (radius), and roses of the directions of bonds and grains.
///
/// Grains at a face of the domain are left out of sizes, shapes and axes. Directions are axial (n
/// and -n are one), so the roses are symmetric; their radius is the density of directions against
/// an isotropic sample, which is 1, the dashed circle. Bonds count by their area, grains by their
/// volume, as in the fabric tensors.
/// @param title before the numbers of grains and bonds; UTF-8, may be empty
/// @param unit of lengths, as TableUnit takes it
std::string measuresPlot(const Measurements& measurements, const std::string& title,
                         PlotType type = PlotType::svg, const std::string& unit = "");

}  // namespace vdb_madf
