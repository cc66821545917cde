// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// How many grains are followed rightly through a known motion:
//   vdb_madf_tracking [GRAINS...]     prints a table for each number of grains (500, 5000, 50000)
//   vdb_madf_tracking --labels        prints one of labels that samples/evolve.h moves

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "support/moved_grains.h"
#include "vdb_madf/matching/track.h"
#include "vdb_madf/samples/evolve.h"
#include "vdb_madf/samples/particles.h"
#include "vdb_madf/samples/snow.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/segmentation/segment.h"

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

constexpr const char* kKinds[] = {"balls", "ellipsoids", "sand", "snow"};

/// Particles, or the grains of snow as they are found.
Int32Grid::Ptr labelsOf(const std::string& kind) {
  if (kind == "snow") {
    SnowOptions snow;
    snow.size = Coord(190);
    snow.length = 20;
    return segment(*generateSnow(snow).object).grain;
  }
  ParticleOptions particles;
  particles.shape = kind == "balls"        ? ParticleShape::balls
                    : kind == "ellipsoids" ? ParticleShape::ellipsoids
                                           : ParticleShape::polyhedra;
  particles.count = 1000;
  particles.size = Coord(165);
  particles.minRadius = kind == "balls" ? 8 : 6.5;
  particles.maxRadius = kind == "balls" ? 8 : 9;
  return generateParticles(particles).truth;
}

/// Of those that are wholly there after, and of all.
std::string shares(const Int32Grid& before, const EvolvedStep& after) {
  TrackOptions options;
  options.motion = MatchOptions{};
  int64_t all = 0, right = 0, wrong = 0;
  const Tracks tracks = track(before, *after.labels, options);
  for (size_t n = 0; n < tracks.before.size(); ++n) {
    const TrackedGrain& grain = tracks.before[n];
    const bool isKept = after.grains[n].fate == EvolvedFate::kept;
    all += isKept;
    right += isKept && grain.partner == grain.grain;
    wrong += grain.partner != 0 && grain.partner != grain.grain;
  }
  char text[64];
  std::snprintf(text, sizeof text, "%.2f, %.2f", 100 * double(right) / double(all),
                100 * double(wrong) / double(all));
  return text;
}

void printLabels() {
  initialize();
  std::printf(
      "| grains | number | turn | strain 0: right, wrong %% | 8 %% | 16 %% |\n"
      "|---|---|---|---|---|---|\n");
  for (const std::string kind : kKinds) {
    const Int32Grid::Ptr before = labelsOf(kind);
    for (const double degrees : {0., 5., 10.}) {
      std::string row;
      size_t number = 0;
      for (const double strain : {0., 0.08, 0.16}) {
        EvolveOptions options;
        options.steps = 1;
        options.strain = strain;
        options.degrees = degrees;
        options.axis = {1, 2, 2};
        options.drift = {5.3, -3.7, 2.1};
        options.rigidGrains = kind != "snow";
        options.vanish = 0.03;
        options.noise = 0.5;
        const EvolvedStep after = Evolution(*before, options).after(1);
        row += " | " + shares(*before, after);
        number = after.grains.size();
      }
      std::printf("| %s | %zu | %.0f%s |\n", kind.c_str(), number, degrees, row.c_str());
      std::fflush(stdout);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && argv[1] == std::string("--labels")) {
    printLabels();
    return 0;
  }
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
    for (const char* kind : kKinds)
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
