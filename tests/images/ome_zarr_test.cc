// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What a group of OME-Zarr in version 3 says of its arrays; in version 2: zarr_test.cc.

#include <map>
#include <string>
#include <utility>

#include "support/catch.h"
#include "support/files.h"
#include "support/images.h"
#include "support/zarr_files.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

TEST_CASE("image_zarr3: the voxel size of OME-Zarr 0.6 is that of the coordinate system of a scale",
          "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "scene.zarr";
  const auto axes = [](const std::string& name, const std::string& unit) {
    std::string all;
    for (const char* axis : {"z", "y", "x"})
      all += std::string(all.empty() ? "" : ", ") + "{\"name\": \"" + axis +
             "\", \"type\": \"space\", \"unit\": \"" + unit + "\"}";
    return "{\"name\": \"" + name + "\", \"axes\": [" + all + "]}";
  };
  const auto group = [](const std::string& attributes) {
    return R"({"zarr_format": 3, "node_type": "group", "attributes": {"ome": {"version": "0.6", )" +
           attributes + "}}}";
  };
  const std::string scale = R"("type": "scale", "scale": [8.5, 8.5, 8.5])",
                    ends = R"("input": {"path": "0"}, "output": {"name": "physical"})",
                    sequence = R"({"type": "sequence", "transformations": [{)" + scale +
                               R"(}, {"type": "translation", "translation": [1, 2, 3]}], )" + ends +
                               "}";
  const auto image = [&](const std::string& transformation) {
    return group(R"("multiscales": [{"coordinateSystems": [)" + axes("turned", "meter") + ", " +
                 axes("physical", "micrometer") + R"(], "datasets": [{"path": "0", )" +
                 R"("coordinateTransformations": [)" + transformation + R"(]}], )" +
                 R"("coordinateTransformations": [{"type": "scale", "scale": [2, 2, 2], )" +
                 R"("input": {"name": "physical"}, "output": {"name": "turned"}}]}])");
  };
  const std::string fine = randomSamples(SampleType::uint16, voxels(kZarrSize), 6);
  std::map<std::string, std::string> files;
  for (const auto& [name, bytes] : zarr3Files(zarr3Layout(SampleType::uint16), fine))
    files["before/0/" + name] = files["after/0/" + name] = files["lost/0/" + name] = bytes;
  files["zarr.json"] = group(R"("scene": {"coordinateTransformations": []})");
  files["before/zarr.json"] = image(sequence);
  files["after/zarr.json"] = image("{" + scale + ", " + ends + "}");
  files["lost/zarr.json"] = image("{" + scale + R"(, "output": {"name": "nowhere"}})");
  writeZarr(path, files);
  for (const std::string dataset : {"before", "after"}) {
    const auto opened = openImage(path, {}, dataset);
    CHECK(readAll(*opened, 8) == fine);
    REQUIRE(opened->info().voxelSize);
    CHECK(opened->info().voxelSize->edge() == 8.5e-6);
  }
  CHECK_FALSE(openImage(path, {}, "lost")->info().voxelSize);
  CHECK_THROWS_WITH(openImage(path), Contains("name one of a group in it"));
  const auto nested = [](int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += R"([{"type": "sequence", "transformations": )";
    text += "[]";
    for (int i = 0; i < count; ++i) text += "}]";
    return text;
  };
  for (const auto& [steps, said] : {std::pair{std::string("3"), "scales cannot be read"},
                                    {nested(1), "scales cannot be read"},
                                    {nested(50000), "too deep"}}) {
    files["before/zarr.json"] =
        image(R"({"type": "sequence", "transformations": )" + steps + ", " + ends + "}");
    writeZarr(path, files);
    CHECK_THROWS_WITH(openImage(path, {}, "before"), Contains(said));
  }
}

TEST_CASE("image_zarr3: OME-Zarr 0.5 gives scales, voxel sizes and labels", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.ome.zarr";
  const std::string fine = randomSamples(SampleType::uint16, voxels(kZarrSize), 6);
  const auto group = [](const std::string& attributes) {
    return R"({"zarr_format": 3, "node_type": "group", "attributes": )" + attributes + "}";
  };
  const auto multiscales = [](const std::string& array, double edge) {
    std::string axes;
    for (const char* name : {"z", "y", "x"})
      axes += std::string(axes.empty() ? "" : ", ") + "{\"name\": \"" + name +
              "\", \"type\": \"space\", \"unit\": \"micrometer\"}";
    const std::string e = std::to_string(edge);
    return R"("multiscales": [{"axes": [)" + axes + R"(], "datasets": [{"path": ")" + array +
           R"(", "coordinateTransformations": [{"type": "scale", "scale": [)" + e + ", " + e +
           ", " + e + "]}]}]}]";
  };
  std::map<std::string, std::string> files;
  for (const std::string array : {"s0/image", "labels/grain/0"})
    for (const auto& [name, bytes] : zarr3Files(zarr3Layout(SampleType::uint16), fine))
      files[array + "/" + name] = bytes;
  files["zarr.json"] =
      group("{\"ome\": {\"version\": \"0.5\", " + multiscales("s0/image", 8.5) + "}}");
  files["s0/zarr.json"] = files["labels/zarr.json"] = group("{}");
  // What is said of each label may be long, and is not kept.
  std::string properties = "[";
  for (int i = 1; i < 100000; ++i)
    properties += (i > 1 ? ", " : "") + std::string("{\"label-value\": ") + std::to_string(i) +
                  ", \"rgba\": [1, 2, 3, 255], \"multiscales\": [[]]}";
  files["labels/grain/zarr.json"] = group("{\"ome\": {\"image-label\": {\"colors\": " + properties +
                                          "]}, " + multiscales("0", 17) + "}}");
  REQUIRE(files["labels/grain/zarr.json"].size() > size_t(1) << 22);
  writeZarr(path, files);
  for (const std::string& named : {path, path + "/", path + "/s0/image"}) {
    const auto image = openImage(named);
    CHECK(readAll(*image, 8) == fine);
    REQUIRE(image->info().voxelSize);
    CHECK(image->info().voxelSize->edge() == 8.5e-6);
  }
  for (const std::string dataset : {"labels/grain", "labels/grain/0", "/labels/grain/"}) {
    const auto image = openImage(path, {}, dataset);
    CHECK(readAll(*image, 8) == fine);
    REQUIRE(image->info().voxelSize);
    CHECK(image->info().voxelSize->edge() == 17e-6);
  }
  CHECK(openImage(path + "/labels/grain")->info().voxelSize->edge() == 17e-6);
  CHECK_THROWS_WITH(openImage(path, {}, "labels/other"), Contains("'labels/other'"));
  CHECK_THROWS_WITH(openImage(path + "/labels"), Contains("no array itself"));
  files["s0/other/zarr.json"] = files["s0/image/zarr.json"];
  files["s0/other/c/0/0/0"] = files["s0/image/c/0/0/0"];
  writeZarr(path, files);
  CHECK_THROWS_WITH(openImage(path + "/s0"), Contains("'image', 'other'"));
}
