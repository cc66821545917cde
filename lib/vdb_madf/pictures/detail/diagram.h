// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/pictures/detail/canvas.h"
#include "vdb_madf/pictures/detail/plot_axis.h"

namespace vdb_madf::detail {

/// Ink and letters of all plots; units are those of plotFile().
constexpr double kPlotText = 12;
constexpr Rgb kPlotInk{40, 40, 40}, kPlotGrid{225, 227, 230};

/// Okabe & Ito: told apart by color-blind readers, too.
constexpr std::array<Rgb, 7> kPlotColors{{{0, 114, 178},
                                          {213, 94, 0},
                                          {0, 158, 115},
                                          {204, 121, 167},
                                          {230, 159, 0},
                                          {86, 180, 233},
                                          {0, 0, 0}}};

/// The frame of a diagram: where its axes begin and end, on the canvas.
struct DiagramFrame {
  double left = 0, top = 0, width = 0, height = 0;
};

/// Lines at the ticks with their numbers, and the names of both axes: that of y stands above it.
void drawDiagramFrame(Canvas& canvas, const DiagramFrame& frame, const PlotAxis& x,
                      const PlotAxis& y, const std::string& nameOfX, const std::string& nameOfY);

}  // namespace vdb_madf::detail
