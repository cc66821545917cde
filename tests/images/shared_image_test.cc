// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/shared_image.h"

#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/files.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/open_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

ImageInfo smallInfo() {
  ImageInfo info;
  info.size = {5, 4, 9};
  info.type = SampleType::uint16;
  info.voxelSize = VoxelSize(8e-6);
  return info;
}

/// 20 a slice.
std::vector<uint16_t> sliceSamples() {
  std::vector<uint16_t> values(5 * 4 * 9);
  std::iota(values.begin(), values.end(), uint16_t(1000));
  return values;
}

}  // namespace

TEST_CASE("shared_image: parts, in any order, make the file of one writer", "[shared_image]") {
  const ImageInfo info = smallInfo();
  for (const std::string ending : {"raw", "npy", "nrrd", "mha", "mhd"}) {
    INFO(ending);
    const ScratchFolder folder;
    const auto write = [&](const std::string& name, const auto& fill) {
      std::filesystem::create_directory(folder / name);
      const std::string path = folder / (name + "/a." + ending);
      const auto image = createImage(path, info, {1, 2, 3});
      fill(*image, path);
      image->finish();
      const auto last = ending == "mhd" ? readFile(folder / (name + "/a.raw")) : std::string();
      return readFile(path) + last;
    };
    const std::string whole = write("whole", [&](ImageWriter& image, const std::string&) {
      image.write(9, sliceSamples().data());
    });
    const auto shared = write("parts", [&](ImageWriter& image, const std::string& path) {
      const auto place = image.share();
      REQUIRE(place);
      const auto high = joinImage(path, *place, info, 6), low = joinImage(path, *place, info, 0);
      high->write(3, sliceSamples().data() + 120);
      low->write(1, sliceSamples().data());
      low->write(5, sliceSamples().data() + 20);
      CHECK_THROWS_AS(high->write(1, sliceSamples().data()), InvalidInput);
      high->finish();
      low->finish();
      CHECK_FALSE(std::filesystem::exists(path));
    });
    CHECK(shared == whole);
    CHECK(folder.fileCount() == 2);
  }
}

TEST_CASE("shared_image: what is not finished leaves nothing", "[shared_image]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.mha";
  {
    const auto image = createImage(path, smallInfo());
    const auto place = image->share();
    REQUIRE(place);
    const auto part = joinImage(path, *place, smallInfo(), 2);
    part->write(2, sliceSamples().data());
    part->finish();
    CHECK(folder.fileCount() == 1);
    SharedImage unseen = *place;
    unseen.temporary += "-elsewhere";
    CHECK_THROWS_WITH(
        joinImage(path, unseen, smallInfo(), 0),
        vdb_madf::test::Contains("a.mha") && vdb_madf::test::Contains("is not seen here"));
  }
  CHECK(folder.fileCount() == 0);
}

TEST_CASE("shared_image: formats whose slices come in order are not shared", "[shared_image]") {
  const ScratchFolder folder;
  CHECK_FALSE(createImage(folder / "a.tif", smallInfo())->share());
  if (readsHdf5()) CHECK_FALSE(createImage(folder / "a.h5", smallInfo())->share());
  CHECK(folder.fileCount() == 0);
}
