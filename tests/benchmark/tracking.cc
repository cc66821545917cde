// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// How many grains are followed rightly through a known motion:
//   vdb_madf_tracking [GRAINS...]     prints a table for each number of grains (500, 5000, 50000)
//   vdb_madf_tracking --labels        prints one of labels that samples/evolve.h moves
//   vdb_madf_tracking --bonds         prints one of their bonds, some of which break
//   vdb_madf_tracking --confidence    prints how many matches of a confidence are right

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/moved_grains.h"
#include "vdb_madf/grids/grid_metadata.h"
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

/// Bonds that seem broken, of those that are decided, and the undecided ones of all, in %, though
/// nothing has happened but roughness.
std::string unloaded(const Int32Grid& before, const Int32Grid& after) {
  TrackOptions options;
  options.motion = MatchOptions{};
  const Tracks tracks = track(before, after, options);
  const BrokenBonds bonds = brokenBonds(tracks, options.sureFaces);
  const auto undecided =
      std::count_if(tracks.bondsBefore.begin(), tracks.bondsBefore.end(),
                    [](const TrackedBond& bond) { return bond.fate == BondFate::undecided; });
  char text[64];
  std::snprintf(text, sizeof text, "%.2f, %.1f",
                100 * double(bonds.broken) / double(bonds.broken + bonds.kept),
                100 * double(undecided) / double(tracks.bondsBefore.size()));
  return text;
}

/// The grains that are found in what is labeled.
Int32Grid::Ptr cutAnew(const Int32Grid& labels) {
  const auto object =
      MaskGrid::create(std::make_shared<MaskTree>(labels.tree(), false, openvdb::TopologyCopy()));
  setDomain(*object, *storedDomain(labels));
  return segment(*object).grain;
}

/// Precision and recall of broken bonds, of those that are followed and of so many faces that this
/// is decided, in %.
std::string loaded(const Int32Grid& before, const EvolvedStep& after) {
  std::map<std::pair<int32_t, int32_t>, EvolvedBondFate> truth;
  for (const EvolvedBond& bond : after.bonds) truth[{bond.first, bond.second}] = bond.fate;
  TrackOptions options;
  options.motion = MatchOptions{};
  double right = 0, said = 0, all = 0;
  for (const TrackedBond& bond : track(before, *after.labels, options).bondsBefore) {
    // What touched by roughness alone is not in the truth.
    const auto known = truth.find({bond.first, bond.second});
    const EvolvedBondFate fate = known == truth.end() ? EvolvedBondFate::parted : known->second;
    if (fate == EvolvedBondFate::gone || bond.fate == BondFate::unmatched ||
        bond.fate == BondFate::outside || bond.faces < options.sureFaces)
      continue;
    const bool isTrue = fate == EvolvedBondFate::broken;
    const bool isSaid = bond.fate == BondFate::detached || bond.fate == BondFate::separated;
    all += isTrue;
    said += isSaid;
    right += isTrue && isSaid;
  }
  char text[64];
  std::snprintf(text, sizeof text, "%.1f, %.1f", 100 * right / said, 100 * right / all);
  return text;
}

void printBonds() {
  initialize();
  std::printf(
      "| grains | bonds | noise | unloaded: broken, undecided %% | cut anew: broken, undecided %% "
      "| "
      "gap 1: precision, recall %% | gap 2: precision, recall %% |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const std::string kind : kKinds) {
    const Int32Grid::Ptr before = labelsOf(kind);
    for (const double noise : {0.5, 1.}) {
      EvolveOptions options;
      options.steps = 2;  // the second scan is as rough, in another way
      options.noise = noise;
      const Evolution still(*before, options);
      const Int32Grid::Ptr first = still.after(1).labels, second = still.after(2).labels;
      std::string row =
          " | " + unloaded(*first, *second) + " | " + unloaded(*cutAnew(*first), *cutAnew(*second));
      options.strain = 0.08;
      options.degrees = 5;
      options.axis = {1, 2, 2};
      options.breaks = 0.1;
      for (const int gap : {1, 2}) {
        options.gap = gap;
        row += " | " + loaded(*first, Evolution(*before, options).after(2));
      }
      std::printf("| %s | %zu | %.1f%s |\n", kind.c_str(), still.after(0).bonds.size(), noise,
                  row.c_str());
      std::fflush(stdout);
    }
  }
}

/// On other seeds than the ones that the formula was fitted to.
void printConfidence() {
  constexpr double kBounds[] = {0, 0.9, 0.92, 0.94, 0.96, 0.98, 0.99, 0.995, 0.999, 0.9999, 1.01};
  constexpr size_t kBins = std::size(kBounds) - 1;
  int64_t all[kBins] = {}, right[kBins] = {};
  double said[kBins] = {};
  for (const char* kind : kKinds)
    for (const double noise : {0.05, 0.1, 0.12, 0.15, 0.2})
      for (const double changed : {0.03, 0.2, 0.3, 0.4})
        for (const unsigned seed : {4u, 5u, 6u}) {
          MovedGrainsOptions options;
          options.kind = kind;
          options.count = 2000;
          options.noise = noise;
          options.changed = changed;
          options.seed = seed;
          const MovedGrains moved = movedGrains(options);
          MatchOptions guess;
          guess.guess = moved.motion;  // at so much noise none is found
          const auto matches = matchGrains(moved.before, moved.after, guess);
          for (size_t n = 0; n < matches->grains.size(); ++n) {
            const FollowedGrain& match = matches->grains[n];
            if (!match.partner) continue;
            size_t bin = 0;
            while (match.confidence >= kBounds[bin + 1]) ++bin;
            const auto truth = moved.partners.find(moved.before.grains[n].grain);
            ++all[bin];
            said[bin] += match.confidence;
            right[bin] += truth != moved.partners.end() && truth->second == match.partner;
          }
        }
  std::printf("| confidence | matches | mean confidence %% | right %% |\n|---|---|---|---|\n");
  for (size_t bin = 0; bin < kBins; ++bin)
    std::printf("| %g to %g | %lld | %.3f | %.3f |\n", std::max(0.88, kBounds[bin]),
                std::min(1., kBounds[bin + 1]), static_cast<long long>(all[bin]),
                100 * said[bin] / double(all[bin]), 100 * double(right[bin]) / double(all[bin]));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && argv[1] == std::string("--labels")) {
    printLabels();
    return 0;
  }
  if (argc > 1 && argv[1] == std::string("--bonds")) {
    printBonds();
    return 0;
  }
  if (argc > 1 && argv[1] == std::string("--confidence")) {
    printConfidence();
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
        const bool isCommon = row.strain == 0.16 && row.wave == 0 && row.changed == 0.03;
        if (count > 100000 && !isCommon) continue;
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
