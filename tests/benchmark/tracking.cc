// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// How many grains are followed rightly through a known motion:
//   vdb_madf_tracking [GRAINS...]     prints a table for each number of grains (500, 5000, 50000)

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "support/moved_grains.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

void printRow(const MovedGrainsOptions& options) {
  const MovedGrains moved = movedGrains(options);
  const auto start = std::chrono::steady_clock::now();
  const auto matches = matchGrains(moved.before, moved.after);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const MatchScore score = matches ? scoreOf(moved, *matches) : MatchScore{1, 0, 0};
  std::printf("| %s | %zu | %.0f | %.0f | %.1f | %.2f | %.3f | %.2f |\n", options.kind.c_str(),
              options.count, 100 * options.strain, options.degrees, options.wave,
              100 * double(score.right) / double(score.all),
              100 * double(score.wrong) / double(score.all), seconds.count());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<size_t> counts;
  for (int n = 1; n < argc; ++n) counts.push_back(std::strtoul(argv[n], nullptr, 10));
  if (counts.empty()) counts = {500, 5000, 50000};
  std::printf("| grains | number | strain %% | turn | waves | right %% | wrong %% | seconds |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (const size_t count : counts)
    for (const char* kind : {"balls", "ellipsoids", "sand", "snow"}) {
      MovedGrainsOptions options;
      options.kind = kind;
      options.count = count;
      for (const auto& [strain, degrees] :
           {std::pair(0., 10.), std::pair(0.08, 10.), std::pair(0.16, 10.), std::pair(0.16, 30.),
            std::pair(0.2, 30.)}) {
        options.strain = strain;
        options.degrees = degrees;
        printRow(options);
      }
      options.strain = 0.16;
      options.degrees = 10;
      options.wave = 1.5;
      if (count >= 5000) printRow(options);
    }
}
