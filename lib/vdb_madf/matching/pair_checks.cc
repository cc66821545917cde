// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/pair_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

namespace vdb_madf {

namespace {

std::string domainText(const Domain& domain) {
  std::ostringstream text;
  text << domain.box().min() << " to " << domain.box().max();
  if (!domain.isBox())
    text << " (region, " << int64_t(domain.voxelCount()) << " of "
         << int64_t(Domain(domain.box()).voxelCount()) << " voxels of the box)";
  return text.str();
}

/// The share of a grid's box that is domain.
double shareOfBox(const Int32Grid& labels) {
  const auto domain = storedDomain(labels);
  if (!domain || domain->isBox()) return 1;
  return double(domain->voxelCount()) / double(Domain(domain->box()).voxelCount());
}

/// Voxels, and the share of them that unrelated samples would have in common, of those of the side
/// that has fewer.
struct Chance {
  double common, byChance;

  Chance(const Tracks& tracks, const Int32Grid& before, const Int32Grid& after) {
    CoordBBox box = boxOf(before);
    box.translate(tracks.shift);
    box.intersect(boxOf(after));
    const double voxels =
        double(Domain(box).voxelCount()) * std::min(shareOfBox(before), shareOfBox(after));
    const auto [fewer, more] = std::minmax(tracks.voxelsBefore, tracks.voxelsAfter);
    common = double(tracks.commonVoxels) / double(fewer);
    byChance = double(more) / voxels;
  }
  bool hardlyExceeded() const {
    constexpr double kHardly = 0.2;  // of what lies between chance and all
    return byChance < 1 && (common - byChance) / (1 - byChance) < kHardly;
  }
};

std::string placeText(const openvdb::Vec3d& place) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis)
    text += (axis > 0 ? ", " : "") + detail::fixedDecimal(place[axis], 1);
  return text;
}

std::string percent(double share) {
  return detail::fixedDecimal(100 * share, 1) + " %";
}

}  // namespace

void checkSameVoxels(const Int32Grid& first, const Int32Grid& second, const PairNames& names) {
  constexpr double kTolerance = 1e-3;  // as for the spacings of an image
  const auto a = storedVoxelSize(first), b = storedVoxelSize(second);
  if (!a || !b) return;
  std::array<double, 3> ratios;
  for (size_t axis = 0; axis < 3; ++axis) ratios[axis] = b->edges()[axis] / a->edges()[axis];
  if (std::all_of(ratios.begin(), ratios.end(),
                  [](double ratio) { return std::abs(ratio - 1) <= kTolerance; }))
    return;
  std::ostringstream text;
  text.precision(4);
  text << names.second << ": its voxels are " << ratios[0];
  if (!a->isCube() || !b->isCube()) text << ", " << ratios[1] << ", " << ratios[2];
  text << " times as long as those of " << names.first << ": give labels of the same voxels";
  throw InvalidInput(text.str());
}

void checkAnyCommon(const Comparison& comparison, const PairNames& names) {
  if (comparison.commonVoxels == 0 && comparison.truthGrains + comparison.testGrains > 0)
    throw InvalidInput(names.second + ": no voxel is labeled both here and in " + names.first +
                       ", so there is nothing to compare: give labels of the same sample");
}

void checkAnyCommon(const Tracks& tracks, const PairNames& names) {
  if (tracks.motion) return;
  if (tracks.commonVoxels == 0 && !tracks.before.empty() && !tracks.after.empty())
    throw InvalidInput(names.second + ": no labeled voxel comes to lie on one of " + names.first +
                       ": give labels of the same sample, or how far it moved (" + names.shift +
                       ", " + names.maxShift + ")");
}

std::vector<std::string> notesOn(const Comparison& comparison, const Int32Grid& truth,
                                 const Int32Grid& test) {
  std::vector<std::string> notes;
  const int64_t others = comparison.truthOnlyVoxels + comparison.testOnlyVoxels;
  if (others > 0)
    notes.push_back(
        "the grids differ in topology: " +
        percent(double(comparison.commonVoxels) / double(comparison.commonVoxels + others)) +
        " of the labeled voxels are labeled in both, and all but grains and their "
        "unions is compared over these alone");
  const auto a = storedDomain(truth), b = storedDomain(test);
  if (a && b && *a != *b)
    notes.push_back("the domains differ: " + domainText(*a) + " and " + domainText(*b) +
                    "; voxels of equal index are compared");
  const openvdb::Vec3d apart = test.worldToIndex(truth.indexToWorld(openvdb::Vec3d(0)));
  const double most = std::max({std::abs(apart.x()), std::abs(apart.y()), std::abs(apart.z())});
  if (storedVoxelSize(truth) && storedVoxelSize(test) && most > 0.5)
    notes.push_back("their places in the world differ by " + placeText(apart) +
                    " voxels; voxels of equal index are compared");
  return notes;
}

std::vector<std::string> notesOn(const Tracks& tracks, const Int32Grid& before,
                                 const Int32Grid& after, const TrackOptions& options,
                                 const PairNames& names) {
  std::vector<std::string> notes;
  if (tracks.motion) {
    int64_t kept = 0, lost = 0, keptVoxels = 0, lostVoxels = 0;
    for (const TrackedGrain& grain : tracks.before) {
      const bool isLost = grain.fate == GrainFate::lost;
      if (!isLost && grain.fate != GrainFate::kept) continue;
      (isLost ? lost : kept) += 1;
      (isLost ? lostVoxels : keptVoxels) += grain.voxels;
    }
    if (lostVoxels > keptVoxels)  // many may be lost that are but specks
      notes.push_back(names.second + ": only " + std::to_string(kept) + " of " +
                      std::to_string(kept + lost) + " grains of " + names.first +
                      " are followed: give scans between them, or a guess of the motion");
    return notes;
  }
  const int most = options.maxShift;
  const Coord shift = tracks.shift;
  const int largest = std::max({std::abs(shift.x()), std::abs(shift.y()), std::abs(shift.z())});
  if (!options.shift && most > 0 && largest == most)
    notes.push_back(names.second + ": the shift is the largest that is looked for: try " +
                    std::to_string(std::min(2 * most, kMaxShift)) + " (" + names.maxShift + ")");
  if (tracks.commonVoxels == 0) return notes;
  const Chance chance(tracks, before, after);
  if (chance.hardlyExceeded())
    notes.push_back(names.second + ": has " + percent(chance.common) +
                    " of the labeled voxels in common with " + names.first +
                    ", hardly more than the " + percent(chance.byChance) +
                    " of unrelated samples: give labels of the same sample, or how far it moved (" +
                    names.shift + ", " + names.maxShift + ")");
  return notes;
}

}  // namespace vdb_madf
