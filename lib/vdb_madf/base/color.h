// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace vdb_madf {

using Rgb = std::array<uint8_t, 3>;  ///< sRGB

/// The inverse of the sRGB transfer function (IEC 61966-2-1): 0 to 1.
inline float linearChannel(uint8_t channel) {
  const double c = channel / 255.0;
  return float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

}  // namespace vdb_madf
