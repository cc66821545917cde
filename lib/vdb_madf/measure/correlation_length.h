// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <optional>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf {

/// How far X resembles itself along x, y and z, in voxels. With f the share of object in the domain
/// and S(r) the share of pairs of voxels r apart along the axis, both in the domain, that are both
/// object: the least r at which (S(r) - f^2) / (f - f^2) falls to 1/e (linear between whole r); for
/// an exponential correlation, its length. None if it does not up to half the domain's box, or to
/// where a region has no such pairs, or f is 0 or 1.
///
/// \p domain must hold X. From masks by words; memory per leaf, and per row of a region.
/// @throw Interrupted
std::array<std::optional<double>, 3> correlationLengths(const LeafIndex& index,
                                                        const Domain& domain,
                                                        Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
