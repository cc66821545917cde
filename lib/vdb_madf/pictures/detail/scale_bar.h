// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>

namespace vdb_madf::detail {

struct ScaleBar {
  double pixels = 0;
  std::string text;  ///< "200 µm"
};

/// The longest bar of 1, 2 or 5 times a power of ten (meters) that is not longer than `widest`
/// pixels; none if even a nanometer is.
std::optional<ScaleBar> fitScaleBar(double metresPerPixel, double widest);

}  // namespace vdb_madf::detail
