// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

// Catch2, version 2 or 3, whichever is installed. What they call differently has one name here.

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
#else
#include <catch2/catch.hpp>
#endif

#include <string>

#if CATCH_VERSION_MAJOR >= 3
using Catch::Approx;  // as version 2 has it
#endif

namespace vdb_madf::test {

using Catch::Matchers::Equals;
using Catch::Matchers::Predicate;
using Catch::Matchers::StartsWith;

/// Matches a text that has `part` in it.
inline auto Contains(const std::string& part) {
#if CATCH_VERSION_MAJOR >= 3
  return Catch::Matchers::ContainsSubstring(part);
#else
  return Catch::Matchers::Contains(part);
#endif
}

}  // namespace vdb_madf::test
