// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>

#include "vdb_madf/grids/domain.h"

namespace vdb_madf::detail {

/// What a scan shows: its domain, whose voxels p lie at p + shift; everything, if it is unknown.
struct Shown {
  std::optional<Domain> domain;
  Coord shift;
};

/// The labels of voxels p at p + shift, as far as a scan shows that; without metadata and tiles.
/// @throw Interrupted
Int32Grid::Ptr movedLabels(const Int32Grid& labels, const Coord& shift, const Shown& shown,
                           Interrupter* interrupter);

}  // namespace vdb_madf::detail
