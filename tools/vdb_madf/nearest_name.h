// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>
#include <vector>

namespace vdb_madf::tools {

/// The name that was most likely meant: one that begins with what was given, else the one that
/// takes the fewest single letters put in, left out, replaced or exchanged with the next, at most
/// a third of what was given. (A tie: the first.)
std::optional<std::string> nearestName(const std::string& given,
                                       const std::vector<std::string>& names);

}  // namespace vdb_madf::tools
