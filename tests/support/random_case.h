// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <optional>
#include <string>

#include "support/dense_volume.h"
#include "support/oracle.h"
#include "support/random_volume.h"
#include "vdb_madf/segmentation/segment.h"

namespace vdb_madf::test {

/// One run of segment(): everything that may decide its result, and what must not.
struct RandomCase {
  uint64_t seed = 0;
  VolumeKind kind = VolumeKind::empty;
  ObjectVolume object;
  std::optional<CoordBBox> domain;
  std::optional<ObjectVolume> region;  ///< the voxels of the domain, if it is not its whole box
  bool domainInMetadata = false;       ///< of the mask; else in the options
  Tiles tiles = Tiles::none;
  int threads = 1;
  SegmentOptions options;  ///< without the domain
};

/// Boundary x adjacency x mode x threads, which the seed runs through in turn: no combination is
/// left to chance.
constexpr int kCombinations = 3 * 2 * 4 * 3;

/// The case of a seed; all else is drawn at random. `size`: of the volume, random if absent.
RandomCase randomCase(uint64_t seed, const std::optional<Coord>& size = {});

/// Makes the domain of a case a region, if it has one: part of a box around the object, which loses
/// what lies outside of it.
void drawRegion(RandomCase& c);

/// The domain, for either side.
std::optional<Domain> domainOf(const RandomCase& c);
std::optional<OracleDomain> oracleDomainOf(const RandomCase& c);

/// The mask with or without tiles, and with its domain if that is where it goes.
MaskGrid::Ptr maskOf(const RandomCase& c);
/// The options with the domain if that is where it goes, keeping all grids.
SegmentOptions optionsOf(const RandomCase& c);

/// What it takes to see it: seed, options, domain, and the picture of a small volume.
std::string describe(const RandomCase& c);

/// A smaller case that still fails: drops slices and voxels and simplifies options for as long as
/// `fails` says so, for at most `tries` calls.
RandomCase shrink(RandomCase failing, const std::function<bool(const RandomCase&)>& fails,
                  int tries = 3000);

}  // namespace vdb_madf::test
