// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// labelPanels() of labels in slabs against those of the whole.

#include <string>
#include <vector>

#include "support/catch.h"
#include "support/label_slabs.h"
#include "support/random_volume.h"
#include "support/runs.h"
#include "support/slab_objects.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/pictures/label_panels.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

/// Labels in random blocks of a random volume, some of them not positive.
Int32Grid::Ptr randomLabels(const ObjectVolume& object, Rng& rng) {
  const auto grid = Int32Grid::create(0);
  const int size = rng.between(1, 7), labels = rng.between(1, 40);
  for (int i = 0; i < object.size(); ++i) {
    const Coord p = object.coord(i);
    if (!object[i]) continue;
    const uint32_t block =
        uint32_t((p.x() >> 2) / size * 31 + (p.y() >> 1) / size * 17 + (p.z() >> 1) / size * 7);
    grid->tree().setValueOn(p, 1 + int(block % uint32_t(labels)));
  }
  return grid;
}

void requireSame(const std::vector<PicturePanel>& panels,
                 const std::vector<PicturePanel>& expected) {
  REQUIRE(panels.size() == expected.size());
  for (size_t i = 0; i < panels.size(); ++i) {
    INFO("panel " << i);
    REQUIRE(panels[i].caption == expected[i].caption);
    REQUIRE(panels[i].voxelsPerPixel == expected[i].voxelsPerPixel);
    REQUIRE(panels[i].picture.width == expected[i].picture.width);
    REQUIRE(panels[i].picture.pixels == expected[i].picture.pixels);
  }
}

}  // namespace

TEST_CASE("slab_panels: pictures are those of the whole", "[slab_panels]") {
  size_t several = 0;
  for (uint64_t seed = 1; seed <= 150; ++seed) {
    INFO("seed " << seed);
    Rng rng(seed);
    const Coord size(rng.between(1, 30), rng.between(1, 30), rng.between(1, 50));
    const ObjectVolume object =
        randomVolume(VolumeKind(int(seed) % kVolumeKinds), boxAt(randomOrigin(rng), size), rng);
    const Int32Grid::Ptr labels = randomLabels(object, rng);
    if (rng.chance(0.3))
      labels->setTransform(openvdb::math::Transform::Ptr(new openvdb::math::Transform(
          openvdb::math::MapBase::Ptr(new openvdb::math::ScaleMap(openvdb::Vec3d(1, 1, 2.5))))));
    const CoordBBox box = object.box();
    PanelOptions options;
    options.edge = rng.between(1, 90);
    options.slices = rng.chance(0.8);
    options.view = !options.slices || rng.chance(0.8);
    options.axes = rng.chance(0.5);
    options.direction.azimuth = rng.below(360);
    options.direction.elevation = rng.between(-90, 90);
    options.interfaces = rng.chance(0.3);
    if (rng.chance(0.4)) {
      const Coord p =
          box.min() + Coord(rng.below(size.x()), rng.below(size.y()), rng.below(size.z()));
      options.planes = {{rng.below(3), 0}, {2, p.z()}};
      options.planes[0].index = p[options.planes[0].axis];
    }
    if (rng.chance(0.3))
      for (auto voxel = labels->cbeginValueOn(); voxel; ++voxel)
        if (rng.chance(0.05)) options.select.push_back(*voxel);
    const std::vector<int> cuts = randomCuts(box, rng);
    several += cuts.size() > 2;
    requireSame(labelPanels(inSlabs(labels, cuts), box, options),
                labelPanels(*labels, box, options));
  }
  CHECK(several > 60);
}

TEST_CASE("slab_panels: a grain that is not there, and an interruption", "[slab_panels]") {
  const auto labels = Int32Grid::create(0);
  labels->tree().fill(CoordBBox(Coord(0), Coord(5, 5, 19)), 3);  // tiles in some slabs
  const LabelSlabs slabs = inSlabs(labels, {0, 8, 16, 24});
  const CoordBBox box(Coord(0), Coord(5, 5, 19));
  PanelOptions options;
  options.edge = 30;
  options.select = {4};
  CHECK_THROWS_AS(labelPanels(slabs, box, options), InvalidInput);
  options.select = {};
  StopAtOnce stop;
  CHECK_THROWS_AS(labelPanels(slabs, box, options, &stop), Interrupted);
}
