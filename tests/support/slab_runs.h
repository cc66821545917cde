// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "support/catch.h"
#include "support/command_runs.h"

// What the tests of slabs by the command share.

namespace vdb_madf::test {

/// 12 leaf nodes high.
inline const std::string kTall = "generate sintered --dims 40x33x93 --count 40 --radius 4:9 ";

/// Requires that the folder out.slabs holds what one.vdb does.
inline void requireSame(const Bench& bench) {
  bench.mustRun("convert out.slabs back.vdb -q");
  REQUIRE(bench.bytes("back.vdb") == bench.bytes("one.vdb"));
}

}  // namespace vdb_madf::test
