// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// A clean object, made a gray scan of 16 bits by blur and noise, comes back by Otsu's threshold.

#include <algorithm>
#include <cmath>
#include <random>

#include "support/catch.h"
#include "support/images.h"
#include "support/memory_image.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/samples/snow.h"
#include "vdb_madf/scans/filtered_image.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/scans/image_object.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/volumes/dense_volume.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// 20000 where there is nothing and 35000 in the object, blurred by 0.6 voxels, with white noise of
/// a tenth of the contrast.
std::vector<uint16_t> grayScan(const MaskGrid& object, const ImageSize& size) {
  std::vector<float> clean(voxels(size));
  DenseLayout layout;
  layout.type = SampleType::float32;
  layout.box = imageBox(size);
  copyToDense(object, clean.data(), layout);
  const auto soft = smoothedImage(imageOf(size, clean), 0.6);
  std::vector<float> values(clean.size());
  soft->read(0, size.z, values.data());
  std::vector<uint16_t> gray;
  std::mt19937 random(1);
  for (const float value : values) {
    double noise = -6;  // twelve uniform numbers: nearly normal, and the same everywhere
    for (int i = 0; i < 12; ++i) noise += double(random()) / 4294967296.0;
    gray.push_back(uint16_t(std::lround(20000 + 15000 * (double(value) + 0.1 * noise))));
  }
  return gray;
}

void checkComesBack(const MaskGrid& clean, const ImageSize& size) {
  const auto gray = grayScan(clean, size);
  GrayOptions options;
  options.automatic = AutomaticThreshold::otsu;
  const auto found = imageObject([&] { return imageOf(size, gray); }, std::nullopt, options).mask;
  MaskTree both(clean.tree());
  both.topologyIntersection(found->tree());
  const auto voxels = double(clean.activeVoxelCount());
  const double wrong =
      voxels + double(found->activeVoxelCount()) - 2 * double(both.activeVoxelCount());
  CAPTURE(wrong / voxels);
  CHECK(wrong < 0.01 * voxels);
  const auto grains = double(segment(clean).counts.grains);
  const auto foundGrains = double(segment(*found).counts.grains);
  CAPTURE(grains, foundGrains);
  CHECK(std::abs(foundGrains - grains) < 0.03 * grains);
}

}  // namespace

TEST_CASE("gray_scan: snow comes back", "[gray_scan]") {
  SnowOptions options;
  options.size = Coord(160);
  options.length = 40;
  const Sample sample = generateSnow(options);
  checkComesBack(*sample.object, {160, 160, 160});
}

TEST_CASE("gray_scan: battery particles come back", "[gray_scan]") {
  const auto path = dataFile("nmc.tif");
  if (!path) {
    WARN("SKIPPED: a gray scan of battery particles: no nmc.tif (VDB_MADF_DATA)");
    return;
  }
  const auto image = openImage(*path);
  const ImageSize size = image->info().size;
  const auto clean = imageObject([&] { return openImage(*path); }, Selection::phase(1)).mask;
  checkComesBack(*clean, size);
}
