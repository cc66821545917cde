// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The members of an MPI job: this program is run by mpiexec. All members make the same cases.
//
// The random comparison reads from the environment VDB_MADF_CASES (how many) and VDB_MADF_SEED (the
// first).

#include "vdb_madf/mpi/mpi_team.h"

#include <string>
#include <vector>

#include "support/catch.h"
#include "support/random_case.h"
#include "support/runs.h"
#include "support/slab_objects.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/slabs/deal_slabs.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

MpiTeam& world() {
  static MpiTeam team(nullptr, nullptr);
  return team;
}

/// Bytes that tell from whom to whom they go.
Bytes letter(int from, int to, size_t size) {
  Bytes bytes(size);
  for (size_t i = 0; i < size; ++i) bytes[i] = char(i * 7 + size_t(from) * 31 + size_t(to) * 5);
  return bytes;
}

int64_t sumOf(int64_t value) {
  std::vector<int64_t> values{value};
  world().sum(values);
  return values[0];
}

}  // namespace

TEST_CASE("mpi: there are several members", "[mpi]") {
  CHECK(world().count() > 1);
  CHECK(sumOf(1) == world().count());
}

TEST_CASE("mpi: messages arrive whole, at the next exchange", "[mpi]") {
  Team& team = world();
  for (const size_t size : {0u, 1u, 1000u, 3000000u}) {
    MemoryScratch scratch;
    for (int to = 0; to < team.count(); ++to)
      for (const char* name : {"a", "another piece"})
        team.send(to, name + std::to_string(team.member()),
                  letter(team.member(), to, size + size_t(to)), scratch);
    team.exchange(scratch);
    for (int from = 0; from < team.count(); ++from)
      for (const char* name : {"a", "another piece"}) {
        REQUIRE(scratch.has(name + std::to_string(from)));
        REQUIRE(scratch.read(name + std::to_string(from)) ==
                letter(from, team.member(), size + size_t(team.member())));
      }
    MemoryScratch empty;
    team.exchange(empty);
    CHECK_FALSE(empty.has("a0"));
  }
}

TEST_CASE("mpi: votes and words are those of all", "[mpi]") {
  Team& team = world();
  const int n = team.count(), r = team.member();
  std::vector<int64_t> sums{r, 1, int64_t(r) << 40}, maxima{r, -r, int64_t(r) << 40};
  team.sum(sums);
  team.max(maxima);
  CHECK(sums == std::vector<int64_t>{n * (n - 1) / 2, n, int64_t(n * (n - 1) / 2) << 40});
  CHECK(maxima == std::vector<int64_t>{n - 1, 0, int64_t(n - 1) << 40});
  Bytes word = r == 0 ? letter(0, 0, 100000) : Bytes(3, 'x');
  team.broadcast(word);
  CHECK(word == letter(0, 0, 100000));
}

TEST_CASE("mpi: each member puts the labels of the whole in its slabs", "[mpi]") {
  Team& team = world();
  const uint64_t first = fromEnvironment("VDB_MADF_SEED", 1) + 200000;
  const uint64_t cases = fromEnvironment("VDB_MADF_CASES", 500);
  int64_t put = 0;
  for (uint64_t seed = first; seed < first + cases; ++seed) {
    Rng rng(seed);
    RandomCase c =
        randomCase(seed, Coord(rng.between(1, 12), rng.between(1, 12), rng.between(16, 60)));
    if (rng.chance(0.3)) drawRegion(c);
    const MaskGrid::Ptr mask = maskOf(c);
    SegmentOptions options = optionsOf(c);
    options.domain = domainOf(c);
    options.keepDistance = options.keepPower = options.keepManifold = options.keepBalls = false;
    if (!options.weights) options.weights = VoxelWeights{};
    Segmentation whole;
    try {
      whole = segment(*mask, options);
    } catch (const InvalidInput&) {
      continue;  // all members alike
    }
    SlabLimits limits;
    limits.height = rng.chance(0.5) ? 8 : 0;
    limits.leastHeight = options.tidy;
    MemoryScratch scratch;
    SlabDealer dealer(team, SlabCosts({}), scratch);
    for (const auto& [z, layer] : layersOf(*mask))  // each has read some
      if ((z >> 3 & 0xff) % team.count() == team.member()) dealer.add(layer);
    dealer.finish(limits, whole.fillHoles, whole.domain);
    const SlabObject object =
        storedSlabs(scratch, openvdb::gridConstPtrCast<MaskGrid>(mask->copyGridWithNewTree()));
    int64_t different = 0;
    const SlabSegmentation result =
        segmentSlabs(object, options, scratch, team, [&](size_t slab, const SlabGrids& grids) {
          ++put;
          const Int32Grid::Ptr part = whole.grain->deepCopy();
          const CoordBBox inside(Coord(INT32_MIN, INT32_MIN, object.cuts[slab]),
                                 Coord(INT32_MAX, INT32_MAX, object.cuts[slab + 1] - 1));
          for (auto voxel = part->beginValueOn(); voxel; ++voxel)
            if (!inside.isInside(voxel.getCoord())) {
              voxel.setValue(0);
              voxel.setValueOff();
            }
          different += !areSame(*part, *grids.grain);
        });
    different += result.counts.grains != whole.counts.grains;
    if (team.member() == 0) different += result.grainVoxels != whole.grainVoxels;
    INFO(describe(c));
    REQUIRE(sumOf(different) == 0);
  }
  CHECK((cases < 100 || put > 0));
}
