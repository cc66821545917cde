// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>

namespace vdb_madf {

using Rgb = std::array<uint8_t, 3>;  ///< sRGB

}  // namespace vdb_madf
