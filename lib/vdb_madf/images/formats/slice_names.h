// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

namespace vdb_madf::detail {

/// What the names of a folder's slices say of its gaps, one line each that names the folder:
/// numbers that are left out, a step above 1 between all, numbers that are there twice, an order by
/// several numbers, and names of several kinds.
///
/// The number that counts is the first one that differs within names of a kind (equal but for their
/// numbers). Its step is that between most neighbors, so that every second slice is no gap; where
/// no step is that of at least half of them (times of day, say) nothing is said of gaps. Slices may
/// be out of order if a number behind goes back where the one that counts goes on, and several
/// slices share that one, or the other tells all of them apart within a smaller range.
/// @param paths in the order of the slices, numbers as whole ones
/// @throw IoError, one line, where that is no order: of names with and without a minus before a
///   number, and of decimals with unequal digits
std::vector<std::string> numberingNotes(const std::string& folder,
                                        const std::vector<std::string>& paths);

}  // namespace vdb_madf::detail
