// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// The sample type in which programs expect labels: uint16 if all values of the grid fit, else
/// uint32; int32 if there are negative ones.
SampleType labelType(const Int32Grid& grid);

}  // namespace vdb_madf
