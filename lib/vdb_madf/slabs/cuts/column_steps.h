// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/detail/slab_faces.h"

namespace vdb_madf::detail {

/// The steps of a column (ColumnSteps) that is object from cut to cut of the slab.
constexpr uint32_t kThrough = ~uint32_t(0);

/// What a slab's upper neighbor needs to know of the columns below their cut (above: its lower one
/// of those above theirs), as far as the slab alone can tell: kThrough where it does not.
ColumnSteps columnSteps(const LeafIndex& index, const Obstacles& obstacles, const SlabFaces& faces,
                        bool above);

/// Tells the same where the steps beyond the slab's other cut are known, too.
ColumnSteps passOn(const ColumnSteps& own, const ColumnSteps& beyond, int height);

}  // namespace vdb_madf::detail
