// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <tbb/global_control.h>

#include <set>
#include <vector>

#include "support/balls.h"
#include "support/catch.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/samples/detail/random.h"
#include "vdb_madf/samples/sample.h"

/// What the tests of all generators ask of a sample.
namespace vdb_madf::test {

/// The bits of object and truth, whatever the trees hold as tiles.
inline uint64_t hash(const Sample& sample) {
  uint64_t state = 0;
  const CoordBBox box = storedDomain(*sample.object)->box();
  const auto object = sample.object->getConstAccessor();
  for (auto p = box.begin(); p; ++p) {
    const int32_t label = sample.truth ? sample.truth->tree().getValue(*p) : 0;
    state = detail::mixBits(state ^ (uint64_t(uint32_t(label)) << 1 | object.isValueOn(*p)));
  }
  return state;
}

inline double solidFraction(const Sample& sample) {
  return double(sample.object->activeVoxelCount()) /
         double(storedDomain(*sample.object)->voxelCount());
}

inline std::set<int32_t> labelsOf(const Int32Grid& grid) {
  std::set<int32_t> labels;
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) labels.insert(*voxel);
  return labels;
}

inline void requireTruth(const Sample& sample, const std::vector<detail::Ball>& balls) {
  REQUIRE(sample.truth);
  CHECK(sample.truth->tree().hasSameTopology(sample.object->tree()));
  size_t wrong = 0;
  for (auto voxel = sample.truth->cbeginValueOn(); voxel; ++voxel)
    wrong += *voxel != brute::nearest(balls, voxel.getCoord());
  CHECK(wrong == 0);
  const auto labels = labelsOf(*sample.truth);
  CHECK(labels.size() == balls.size());
  CHECK(*labels.begin() == 1);
}

/// generate() gives the same bits with one thread and with two.
template <typename Generate>
void requireSameForAnyThreads(const Generate& generate) {
  const auto hashWith = [&](size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return hash(generate());
  };
  CHECK(hashWith(1) == hashWith(2));
}

/// generate(interrupter) stops at the first poll, and at the second.
template <typename Generate>
void requireStops(const Generate& generate) {
  for (const int polls : {0, 1}) {
    StopAfter stop(polls);
    CHECK_THROWS_AS(generate(&stop), Interrupted);
  }
}

inline void requireInsideDomain(const Sample& sample) {
  CHECK(storedDomain(*sample.object)->box().isInside(sample.object->evalActiveVoxelBoundingBox()));
}

/// generate(seed): three seeds, three samples.
template <typename Generate>
void requireSeedsDiffer(const Generate& generate) {
  CHECK(std::set<uint64_t>{hash(generate(1)), hash(generate(2)), hash(generate(3))}.size() == 3);
}

}  // namespace vdb_madf::test
