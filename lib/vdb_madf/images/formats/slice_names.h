// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

namespace vdb_madf::detail {

/// What the names of a folder's slices say of its gaps, one line each that names the folder:
/// numbers that are left out, a step above 1 between all, numbers that are there twice, and names
/// of several kinds.
///
/// The number that counts is the first one that differs within names of a kind (equal but for their
/// numbers). Its step is that between most neighbors, so that every second slice is no gap; where
/// no step is that of at least half of them (times of day, say) nothing is said of gaps.
/// @param paths in the order of the slices
std::vector<std::string> numberingNotes(const std::string& folder,
                                        const std::vector<std::string>& paths);

}  // namespace vdb_madf::detail
