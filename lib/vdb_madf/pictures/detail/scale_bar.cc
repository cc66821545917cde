// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/scale_bar.h"

#include <array>

namespace vdb_madf::detail {

namespace {

struct Unit {
  const char* name;
  double metres;
};
constexpr std::array<Unit, 4> kUnits{{{"nm", 1e-9}, {"µm", 1e-6}, {"mm", 1e-3}, {"m", 1}}};

}  // namespace

std::optional<ScaleBar> fitScaleBar(double metresPerPixel, double widest) {
  std::optional<ScaleBar> best;
  for (const Unit& unit : kUnits)
    for (const int number : {1, 2, 5, 10, 20, 50, 100, 200, 500}) {
      const double pixels = number * unit.metres / metresPerPixel;
      if (pixels > widest) return best;
      best = ScaleBar{pixels, std::to_string(number) + " " + unit.name};
    }
  return best;
}

}  // namespace vdb_madf::detail
