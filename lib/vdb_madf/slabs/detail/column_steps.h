// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/detail/slab_faces.h"

namespace vdb_madf::detail {

/// What a slab's upper neighbor needs to know of the columns below their cut (above: its lower one of
/// those above theirs). The slab's own face on the other side must be known: columns that are object
/// from cut to cut go on there.
ColumnSteps columnSteps(const LeafIndex& index, const Obstacles& obstacles, const SlabFaces& faces,
                        bool above);

}  // namespace vdb_madf::detail
