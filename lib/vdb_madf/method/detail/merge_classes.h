// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/method/merge.h"

namespace vdb_madf::detail {

/// The classes of the angle and neck tests, those without a voxel of the object included: of each
/// node the smallest node of its class. Any mode but MergeMode::score.
std::vector<uint32_t> mergedClasses(const ManifoldGraph& graph, const MergeOptions& options);

}  // namespace vdb_madf::detail
