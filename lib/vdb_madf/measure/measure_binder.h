// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>

#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

/// Sets Measurements::binder. Areas are estimated as those of bonds are. Memory: a copy of the
/// labels with the binder, eight bytes for each voxel of the binder, and what VoronoiCells takes.
/// @param binder its voxels, on those of the labels; grains have theirs all the same
/// @param options what the labels were measured with
/// @param measured what measure() says of these labels
/// @throw InvalidInput, one line, if one of the domains is unknown or that of the labels is not
///   within that of the binder, there are too many bridges to number, or as measure() with cells;
///   Interrupted.
void measureBinder(const Int32Grid& labels, const MaskGrid& binder, const MeasureOptions& options,
                   Measurements& measured, Interrupter* interrupter = nullptr);

/// A note if a map has no binder outside of the grains, else empty.
/// @param value of the binder in the map
std::string noteOn(const Binder& binder, int64_t value);

}  // namespace vdb_madf
