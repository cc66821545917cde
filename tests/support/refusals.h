// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/program.h"

/// What is asked of the command when it refuses.
namespace vdb_madf::test {

inline constexpr int kFailed = 1, kWrongUsage = 2, kInterrupted = 130;

/// An exit code, nothing on stdout, and one line on stderr that says all of this.
inline void checkRefusal(const Outcome& outcome, int code, const std::vector<std::string>& says) {
  CHECK(outcome.exitCode == code);
  CHECK(outcome.out == "");
  CHECK(outcome.err.find("vdb_madf: error: ") == 0);
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  CHECK((outcome.err.empty() ? ' ' : outcome.err.back()) == '\n');
  for (const std::string& text : says) {
    CAPTURE(text);
    CHECK_THAT(outcome.err, vdb_madf::test::Contains(text));
  }
}

/// The program refuses, names what is wrong, and leaves the folder as it was.
inline void refuses(const Bench& bench, int code, const std::string& arguments,
                    const std::vector<std::string>& says = {}, const RunOptions& options = {}) {
  INFO("vdb_madf " << arguments);
  const auto before = bench.names();
  checkRefusal(bench.run(arguments, options), code, says);
  CHECK(bench.names() == before);
}

}  // namespace vdb_madf::test
