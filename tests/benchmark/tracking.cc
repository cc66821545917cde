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
  std::printf("| %s | %zu | %.0f | %.0f | %.0f | %.0f | %.1f | %.2f | %.3f | %.1f |\n",
              options.kind.c_str(), options.count, 100 * options.strain, options.degrees,
              100 * options.noise, 100 * options.changed, options.wave,
              100 * double(score.right) / double(score.all),
              100 * double(score.wrong) / double(score.all), seconds.count());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<size_t> counts;
  for (int n = 1; n < argc; ++n) counts.push_back(std::strtoul(argv[n], nullptr, 10));
  if (counts.empty()) counts = {500, 5000, 50000};
  struct Row {
    double strain, degrees, noise, changed, wave;
  };
  constexpr Row kRows[] = {{0, 10, 0.05, 0.03, 0},   {0.16, 10, 0.05, 0.03, 0},
                           {0.2, 30, 0.05, 0.03, 0}, {0.16, 10, 0.05, 0.03, 1.5},
                           {0.16, 10, 0.1, 0.03, 0}, {0.16, 10, 0.05, 0.15, 0},
                           {0.16, 10, 0.15, 0.1, 0}};
  std::printf(
      "| grains | number | strain %% | turn | noise %% | changed %% | waves | right %% | wrong %% "
      "| "
      "seconds |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const size_t count : counts)
    for (const char* kind : {"balls", "ellipsoids", "sand", "snow"})
      for (const Row& row : kRows) {
        if (count > 10000 && row.noise > 0.05) continue;  // a minute and more
        MovedGrainsOptions options;
        options.kind = kind;
        options.count = count;
        options.strain = row.strain;
        options.degrees = row.degrees;
        options.noise = row.noise;
        options.changed = row.changed;
        options.wave = row.wave;
        printRow(options);
      }
}
