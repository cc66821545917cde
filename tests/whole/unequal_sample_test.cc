// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Bodies of known truth have the same grains, volumes and areas, be they sampled by cubes or by
// voxels three times as long along an axis.

#include <array>

#include "support/catch.h"
#include "vdb_madf/matching/compare.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/samples/particles.h"
#include "vdb_madf/samples/sintered.h"
#include "vdb_madf/samples/spheres.h"
#include "vdb_madf/segmentation/segment.h"

namespace {

using namespace vdb_madf;

VoxelSize thrice(int axis) {
  std::array<double, 3> edges{1e-6, 1e-6, 1e-6};
  edges[size_t(axis)] = 3e-6;
  return VoxelSize(edges);
}

/// All true grains are found, and at most so many others.
template <typename Options, typename Generate>
void requireSameGrains(Options options, int64_t grains, int64_t others, const Generate& generate) {
  const Segmentation ofCubes = segment(*generate(options).object);
  CHECK(ofCubes.counts.grains == grains);
  const SampleMeasures cubes = measure(ofCubes).sample;
  for (int axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    options.voxelSize = thrice(axis);
    const Sample sample = generate(options);
    const Segmentation found = segment(*sample.object);
    const Comparison agreement = compare(*sample.truth, *found.grain);
    CHECK(agreement.truthGrains == grains);
    CHECK(agreement.foundGrains == grains);
    CHECK(agreement.testGrains <= grains + others);
    CHECK(agreement.misclassifiedPercent < 2);
    const SampleMeasures measured = measure(found).sample;
    CHECK(measured.objectVolume == Approx(cubes.objectVolume).epsilon(0.01));
    CHECK(measured.freeArea == Approx(cubes.freeArea).epsilon(0.05));
  }
}

}  // namespace

TEST_CASE("unequal_sample: balls", "[unequal_sample]") {
  SphereOptions options;
  options.size = Coord(120);
  options.count = 20;
  options.minRadius = 14;
  options.maxRadius = 20;
  options.overlap = 0.03;
  requireSameGrains(options, 20, 0, [](const auto& o) { return generateSpheres(o); });
}

TEST_CASE("unequal_sample: sintered balls", "[unequal_sample]") {
  SinteredOptions options;
  options.size = Coord(108);
  options.count = 20;
  requireSameGrains(options, 20, 0, [](const auto& o) { return generateSintered(o); });
}

TEST_CASE("unequal_sample: ellipsoids", "[unequal_sample]") {
  ParticleOptions options;
  options.size = Coord(108);
  options.count = 12;
  options.minRadius = 14;
  options.maxRadius = 20;
  // One that lies askew may come apart in two.
  requireSameGrains(options, 12, 1, [](const auto& o) { return generateParticles(o); });
}
