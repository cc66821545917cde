// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <optional>
#include <string>

namespace vdb_madf {

/// How many of the unit make a meter: "um", "micron", "µm" in its many spellings, "mm" ... Nothing
/// for a word that is no unit of length.
std::optional<double> unitsPerMetre(const std::string& unit);

/// A length as a decimal in another unit, such that the decimal / unitsPerMetre gives back `metres`
/// to the last bit (or nearly, where no double does).
std::string lengthIn(double unitsPerMetre, double metres);
std::array<std::string, 3> lengthsIn(double unitsPerMetre, const std::array<double, 3>& metres);

}  // namespace vdb_madf
