// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/method/merge.h"

namespace vdb_madf::detail {

/// The classes of the tests of merge_rule.h, those without a voxel of the object included: of each
/// node the smallest node of its class.
std::vector<uint32_t> mergedClasses(const ManifoldGraph& graph, const MergeOptions& options);

}  // namespace vdb_madf::detail
