// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/segment_slabs.h"

namespace vdb_madf::detail {

/// @throw InvalidInput if options or cuts are none that slabs can have
void checkSlabOptions(const SlabObject& object, const SegmentOptions& options);

}  // namespace vdb_madf::detail
