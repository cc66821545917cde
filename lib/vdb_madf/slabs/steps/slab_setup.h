// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/steps/slab_work.h"

namespace vdb_madf::detail {

/// What comes before the first sweep: counts of the object, boundary, cavities, weights. The same
/// at all members. @throw as segmentSlabs()
void setUpSlabs(SlabWork& work, SlabSegmentation& result);

}  // namespace vdb_madf::detail
