// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

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

namespace {

/// An OME-Zarr image of two scales at `path`; all axes have the unit.
std::string omeAttributes(const std::string& unit, double edge, const std::string& more = "") {
  const auto scale = [](double s) {
    const std::string text = std::to_string(s);
    return "[{\"type\": \"scale\", \"scale\": [1, 1, " + text + ", " + text + ", " + text + "]}]";
  };
  std::string axes = "{\"name\": \"t\", \"type\": \"time\"}, {\"name\": \"c\"}";
  for (const char* name : {"z", "y", "x"})
    axes += std::string(", {\"name\": \"") + name + "\", \"type\": \"space\", \"unit\": \"" + unit +
            "\"}";
  return "{\"multiscales\": [{\"version\": \"0.4\", \"axes\": [" + axes +
         "], \"datasets\": [{\"path\": \"0\", \"coordinateTransformations\": " + scale(edge) +
         "}, {\"path\": \"1\", \"coordinateTransformations\": " + scale(2 * edge) + "}]" + more +
         "}]}";
}

}  // namespace

TEST_CASE("image_zarr: every type, codec, order and separator", "[image_zarr]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  const char* names[] = {"u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"};
  for (const SampleType type : kSampleTypes)
    for (const std::string codec : {"", "blosc", "zlib", "gzip", "zstd", "blosclz"})
      for (const std::string order : {"C", "F"}) {
        if (type != SampleType::uint16 && (order == "F" || (codec != "" && codec != "blosc")))
          continue;
        ZarrLayout layout{kZarrSize,
                          kZarrChunk,
                          "",
                          sampleSize(type),
                          codec,
                          order,
                          order == "F" ? "/" : ".",
                          "0",
                          order == "F" ? 2 : 0};
        layout.type = (layout.bytes == 1 ? "|" : "<") + std::string(names[size_t(type)]);
        CAPTURE(layout.type, codec, order);
        const std::string bytes = randomSamples(type, voxels(kZarrSize), 1);
        writeZarr(path, zarrFiles(layout, bytes));
        CHECK(looksLikeImage(path));
        const auto image = openImage(path);
        CHECK(image->info().size == kZarrSize);
        CHECK(image->info().type == type);
        CHECK(image->info().format == "zarr");
        CHECK_FALSE(image->info().voxelSize);
        for (const int step : {1, 2, 5, 8, 100}) CHECK(readAll(*image, step) == bytes);
        CHECK(readAll(*openImage(path + "/")) == bytes);
        layout.type[0] = '>';
        writeZarr(path, zarrFiles(layout, swapped(bytes, layout.bytes)));
        CHECK(readAll(*openImage(path), 3) == bytes);
      }
}

TEST_CASE("image_zarr: chunks that are not there are the fill value", "[image_zarr]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  for (const std::string order : {"C", "F"})
    for (const auto& [fill, value] :
         {std::pair("7", 7), {"null", 0}, {"0.0", 0}, {"true", 1}, {"255", 255}}) {
      ZarrLayout layout{kZarrSize, kZarrChunk, "|u1", 1, "blosc", order, ".", fill, 0};
      std::string bytes = randomSamples(SampleType::uint8, voxels(kZarrSize), 2);
      writeZarr(path, zarrFiles(layout, bytes));
      std::filesystem::remove(path + "/1.0.2");
      for (int z = 5; z < 9; ++z)
        for (int y = 0; y < 3; ++y)
          for (int x = 8; x < 11; ++x) bytes[size_t((z * 7 + y) * 11 + x)] = char(value);
      CHECK(readAll(*openImage(path), 8) == bytes);
    }
  for (const std::string fill : {"256", "-1", "0.5", "\"NaN\"", "[]", "1e300"}) {
    writeZarr(path, zarrFiles({kZarrSize, kZarrChunk, "|u1", 1, "", "C", ".", fill, 0},
                              std::string(693, 'a')));
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains("fill value"));
  }
  ZarrLayout layout{ImageSize{2, 2, 2}, ImageSize{1, 1, 1}, "<f4", 4, "", "C", ".", "\"NaN\"", 0};
  writeZarr(path, zarrFiles(layout, std::string(32, '\0')));
  std::filesystem::remove(path + "/0.0.1");
  float values[8];
  std::memcpy(values, readAll(*openImage(path)).data(), sizeof values);
  CHECK(std::isnan(values[1]));
  CHECK(values[0] == 0);
  for (const auto& [name, bytes] : zarrFiles(layout, std::string(32, '\0')))
    if (name[0] != '.') std::filesystem::remove(path + "/" + name);
  CHECK_THROWS_WITH(openImage(path), Contains("0 chunks"));
}

TEST_CASE("image_zarr: 64-bit labels", "[image_zarr]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  std::string bytes = randomSamples(SampleType::uint32, voxels(kZarrSize), 3), stored;
  for (size_t i = 0; i < bytes.size(); i += 4) stored += bytes.substr(i, 4) + std::string(4, '\0');
  writeZarr(path, zarrFiles({kZarrSize, kZarrChunk, "<u8", 8, "zlib", "C", ".", "0", 0}, stored));
  CHECK(openImage(path)->info().type == SampleType::uint32);
  CHECK(readAll(*openImage(path), 8) == bytes);
  stored[4] = '\1';
  writeZarr(path, zarrFiles({kZarrSize, kZarrChunk, "<u8", 8, "zlib", "C", ".", "0", 0}, stored));
  CHECK_THROWS_WITH(readAll(*openImage(path)), Contains(path) && Contains("beyond 32 bits"));
}

TEST_CASE("image_zarr: OME-Zarr gives the first scale and its voxel size", "[image_zarr]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.ome.zarr";
  const std::string fine = randomSamples(SampleType::uint16, voxels(kZarrSize), 4);
  const std::string coarse = randomSamples(SampleType::uint16, 8, 5);
  const auto write = [&](const std::string& attributes) {
    std::filesystem::remove_all(path);
    writeZarr(path + "/0",
              zarrFiles({kZarrSize, kZarrChunk, "<u2", 2, "blosc", "C", "/", "0", 2}, fine));
    writeZarr(path + "/1",
              zarrFiles({ImageSize{2, 2, 2}, ImageSize{2, 2, 2}, "<u2", 2, "", "C", "/", "0", 2},
                        coarse));
    writeFile(path + "/.zgroup", "{\"zarr_format\": 2}");
    writeFile(path + "/.zattrs", attributes);
  };
  write(omeAttributes("micrometer", 8.5));
  CHECK(looksLikeImage(path));
  for (const std::string& named : {path, path + "/", path + "/0"}) {
    const auto image = openImage(named);
    CHECK(readAll(*image, 8) == fine);
    REQUIRE(image->info().voxelSize);
    CHECK(image->info().voxelSize->edge() == 8.5e-6);
  }
  const auto second = openImage(path, {}, "1");
  CHECK(second->info().size == ImageSize{2, 2, 2});
  CHECK(second->info().voxelSize->edge() == 17e-6);
  CHECK(readAll(*second) == coarse);
  CHECK_THROWS_WITH(openImage(path, {}, "2"), Contains(path) && Contains("'2'"));

  write(omeAttributes("micrometer", 8.5,
                      ", \"coordinateTransformations\": [{\"type\": \"scale\", \"scale\": "
                      "[1, 1, 2, 2, 2]}]"));
  CHECK(openImage(path)->info().voxelSize->edge() == 17e-6);
  write(omeAttributes("millimeter", 0.25));
  CHECK(openImage(path)->info().voxelSize->edge() == 0.25e-3);
  std::string turned = omeAttributes("micrometer", 8.5);
  for (const auto& [from, to] :
       {std::pair{"\"z\"", "\"?\""}, {"\"x\"", "\"z\""}, {"\"?\"", "\"x\""}})
    turned.replace(turned.find(from), 3, to);
  write(turned);
  CHECK_THROWS_WITH(openImage(path), Contains("its axes are called 'x', 'y', 'z'"));
  write(omeAttributes("micrometer", 8.5));
  writeFile(path + "/0/.zattrs", R"({"_ARRAY_DIMENSIONS": ["x", "y", "z"]})");
  CHECK_THROWS_WITH(openImage(path), Contains("its axes are called 'x', 'y', 'z'"));
  writeFile(path + "/0/.zattrs", R"({"_ARRAY_DIMENSIONS": ["z", "y", "x"]})");
  CHECK_NOTHROW(openImage(path));
  write(omeAttributes("", 8.5));
  CHECK_FALSE(openImage(path)->info().voxelSize);
  write("{}");
  CHECK_THROWS_WITH(openImage(path), Contains("choose one of its arrays") && Contains("'0', '1'"));
  CHECK(openImage(path, {}, "1")->info().size == ImageSize{2, 2, 2});
  write("{\"multiscales\": [{\"datasets\": [{\"path\": \"1\"}]}]}");  // before version 0.4
  CHECK(openImage(path)->info().size == ImageSize{2, 2, 2});
  CHECK_FALSE(openImage(path)->info().voxelSize);
  std::string uneven = omeAttributes("micrometer", 8.5);
  uneven.replace(uneven.find("8.5"), 3, "9.5");
  write(uneven);
  CHECK(openImage(path)->info().voxelSize->edges() ==
        std::array<double, 3>{8.5e-6, 8.5e-6, 9.5e-6});
}

TEST_CASE("image_zarr: what cannot be read says why", "[image_zarr]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr", samples(voxels(kZarrSize), 'a');
  const ZarrLayout good{kZarrSize, kZarrChunk, "|u1", 1, "", "C", ".", "0", 0};
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& why) {
    writeZarr(path, zarrFiles(good, samples));
    std::string text = zarrDescription(good);
    const size_t place = text.find(from);
    REQUIRE(place != std::string::npos);
    writeFile(path + "/.zarray", text.replace(place, from.size(), to));
    CAPTURE(from, to);
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains(why));
  };
  refused("null", "{\"id\": \"bz2\"}", "'bz2'");
  refused("\"filters\": null", "\"filters\": [{\"id\": \"delta\"}]", "filters");
  refused("|u1", "<f2", "<f2");
  refused("\"|u1\"", "[[\"a\", \"|u1\"]]", "type");
  refused("[9, 7, 11]", "[2, 9, 7, 11]", "2 volumes");
  refused("[9, 7, 11]", "[1, 9, 7, 11]", "numbers of axes");
  refused("[9, 7, 11]", "[7, 11]", "choose another array");
  refused("[9, 7, 11]", "[9, 0, 11]", "not within");
  refused("[9, 7, 11]", "[9, 7, 1e9]", "not within");
  refused("[9, 7, 11]", "[9, 7, -1]", "not within");
  refused("[9, 7, 11]", "[9, 7, 18446744073709551615]", "not within");
  refused("[9, 7, 11]", "[99999, 7777, 1111]", "too few");
  refused("[5, 3, 4]", "[99999, 99999, 99999]", "2 GB");
  refused("\"zarr_format\": 2", "\"zarr_format\": 3", "version 2");
  refused("{", "[", "JSON");
  for (const std::string codec : {"", "zlib", "blosc"}) {
    ZarrLayout layout = good;
    layout.codec = codec;
    for (const std::string& bytes : {std::string(), std::string(30, 'x'), std::string(59, '\2')}) {
      writeZarr(path, zarrFiles(layout, samples));
      writeFile(path + "/1.1.1", bytes);
      CAPTURE(codec, bytes);
      CHECK_THROWS_WITH(readAll(*openImage(path)), Contains(path) && Contains("1.1.1"));
    }
    ZarrLayout larger = layout;
    larger.chunk = ImageSize{4, 3, 6};
    writeZarr(path, zarrFiles(layout, samples));
    writeFile(path + "/.zarray", zarrDescription(larger));
    CHECK_THROWS_AS(readAll(*openImage(path)), IoError);
  }
  writeFile(folder / "a.npy", "x");
  CHECK_THROWS_WITH(openImage(folder / "a.npy", {}, "0"), Contains("no datasets"));
}
