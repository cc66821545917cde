// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/catch.h"
#include "support/files.h"
#include "support/images.h"
#include "support/zarr_files.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

// Zarr version 3; what it shares with version 2 is in zarr_test.cc.

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;
using Codecs = std::vector<std::string>;

namespace {

const ImageSize kZarr3Size{11, 7, 9}, kZarr3Chunk{4, 3, 5}, kZarr3Shard{8, 6, 5};

void write(const std::string& path, const std::map<std::string, std::string>& files) {
  std::filesystem::remove_all(path);
  for (const auto& [name, bytes] : files) {
    std::filesystem::create_directories(std::filesystem::path(path + "/" + name).parent_path());
    writeFile(path + "/" + name, bytes);
  }
}

Zarr3Layout layoutOf(SampleType type) {
  Zarr3Layout layout{kZarr3Size, kZarr3Chunk};
  layout.type = sampleTypeName(type);
  layout.bytes = sampleSize(type);
  return layout;
}

void checkReads(const std::string& path, const std::string& bytes) {
  const auto image = openImage(path);
  CHECK(image->info().size == kZarr3Size);
  CHECK(image->info().format == "zarr");
  for (const int step : {1, 2, 5, 100}) CHECK(readAll(*image, step) == bytes);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t place = text.find(from);
  REQUIRE(place != std::string::npos);
  return text.replace(place, from.size(), to);
}

}  // namespace

TEST_CASE("image_zarr3: every type, byte order and order of axes", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  for (const SampleType type : kSampleTypes)
    for (const std::string order : {"", "zyx", "xyz", "yzx", "xzy"})
      for (const bool bigEndian : {false, true}) {
        if (type != SampleType::uint16 && order == "yzx") continue;
        Zarr3Layout layout = layoutOf(type);
        layout.order = order;
        layout.bigEndian = bigEndian;
        layout.leading = order == "xyz" ? 2 : 0;
        CAPTURE(layout.type, order, bigEndian);
        const std::string bytes = randomSamples(type, voxels(kZarr3Size), 1);
        write(path, zarr3Files(layout, bigEndian ? swapped(bytes, layout.bytes) : bytes));
        CHECK(looksLikeImage(path));
        CHECK(openImage(path)->info().type == type);
        CHECK_FALSE(openImage(path)->info().voxelSize);
        checkReads(path, bytes);
      }
}

TEST_CASE("image_zarr3: one transposition after the other", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  const std::string bytes = randomSamples(SampleType::uint8, voxels(kZarr3Size), 8);
  Zarr3Layout layout = layoutOf(SampleType::uint8);
  layout.order = "yxz";
  auto files = zarr3Files(layout, bytes);
  const auto transposition = [](const std::string& order) {
    return R"({"name": "transpose", "configuration": {"order": )" + order + "}}";
  };
  files["zarr.json"] = replaced(files["zarr.json"], transposition("[1, 2, 0]"),
                                transposition("[1, 0, 2]") + ", " + transposition("[0, 2, 1]"));
  write(path, files);
  checkReads(path, bytes);
}

TEST_CASE("image_zarr3: every codec, in shards or not, and every key", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  const std::string bytes = randomSamples(SampleType::uint16, voxels(kZarr3Size), 2);
  for (const Codecs& codecs :
       {Codecs{}, Codecs{"gzip"}, Codecs{"zstd"}, Codecs{"blosc"}, Codecs{"crc32c"},
        Codecs{"gzip", "crc32c"}, Codecs{"crc32c", "gzip"}, Codecs{"crc32c", "zstd", "crc32c"},
        Codecs{"blosc", "crc32c"}, Codecs{"crc32c", "crc32c"}})
    for (const int sharded : {0, 1, 2, 3}) {
      Zarr3Layout layout = layoutOf(SampleType::uint16);
      layout.codecs = codecs;
      if (sharded > 0) layout.shard = sharded == 3 ? ImageSize{12, 9, 10} : kZarr3Shard;
      layout.indexAtStart = sharded == 2;
      if (sharded == 3) layout.indexCodecs.clear();
      layout.keys = sharded % 2 ? "v2" : "default";
      layout.separator = sharded > 1 ? "." : "/";
      layout.leading = sharded % 2;
      CAPTURE(codecs, sharded);
      write(path, zarr3Files(layout, bytes));
      checkReads(path, bytes);
      layout.bigEndian = true;
      layout.order = "yxz";
      write(path, zarr3Files(layout, swapped(bytes, 2)));
      checkReads(path, bytes);
    }
}

TEST_CASE("image_zarr3: bool, 64-bit labels, and codecs and keys that are named alone",
          "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  Zarr3Layout layout = layoutOf(SampleType::uint8);
  std::string bits = randomSamples(SampleType::uint8, voxels(kZarr3Size), 3);
  for (char& c : bits) c &= 1;
  layout.type = "bool";
  layout.fill = "false";
  write(path, zarr3Files(layout, bits));
  CHECK(openImage(path)->info().type == SampleType::uint8);
  checkReads(path, bits);
  for (const std::string alone :
       {R"("codecs": ["bytes"])", R"("codecs": [{"name": "bytes", "configuration": {}}])"}) {
    const std::string description = zarr3Description(layout);
    writeFile(
        path + "/zarr.json",
        replaced(description,
                 R"("codecs": [{"name": "bytes", "configuration": {"endian": "little"}}])", alone));
    checkReads(path, bits);
  }
  writeFile(path + "/zarr.json",
            replaced(zarr3Description(layout),
                     R"({"name": "default", "configuration": {"separator": "/"}})", "\"default\""));
  checkReads(path, bits);
  layout.keys = "v2";
  layout.separator = ".";
  write(path, zarr3Files(layout, bits));
  writeFile(path + "/zarr.json", replaced(zarr3Description(layout),
                                          R"({"name": "v2", "configuration": {"separator": "."}})",
                                          R"({"name": "v2"})"));
  checkReads(path, bits);

  const std::string labels = randomSamples(SampleType::uint32, voxels(kZarr3Size), 4);
  std::string wide;
  for (size_t i = 0; i < labels.size(); i += 4) wide += labels.substr(i, 4) + std::string(4, '\0');
  Zarr3Layout wideLayout{kZarr3Size, kZarr3Chunk};
  wideLayout.type = "uint64";
  wideLayout.bytes = 8;
  write(path, zarr3Files(wideLayout, wide));
  CHECK(openImage(path)->info().type == SampleType::uint32);
  checkReads(path, labels);
  wide[4] = 1;
  write(path, zarr3Files(wideLayout, wide));
  CHECK_THROWS_WITH(readAll(*openImage(path)), Contains(path) && Contains("beyond 32 bits"));
}

TEST_CASE("image_zarr3: chunks and shards that are not there are the fill value", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  std::string bytes = randomSamples(SampleType::uint8, voxels(kZarr3Size), 5);
  const auto fillBox = [&](const ImageSize& first, const ImageSize& end, char value) {
    std::string filled = bytes;
    for (int z = first.z; z < end.z; ++z)
      for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) filled[size_t((z * 7 + y) * 11 + x)] = value;
    return filled;
  };
  Zarr3Layout layout = layoutOf(SampleType::uint8);
  layout.fill = "7";
  write(path, zarr3Files(layout, bytes));
  std::filesystem::remove(path + "/c/1/0/2");
  checkReads(path, fillBox({8, 0, 5}, {11, 3, 9}, 7));

  layout.shard = kZarr3Shard;
  bytes = fillBox({4, 3, 0}, {8, 6, 5}, 0);  // a chunk that is left out of its shard
  write(path, zarr3Files(layout, bytes));
  std::filesystem::remove(path + "/c/1/1/0");
  bytes = fillBox({4, 3, 0}, {8, 6, 5}, 7);
  checkReads(path, fillBox({0, 6, 5}, {8, 7, 9}, 7));

  for (const std::string fill : {"256", "-1", "0.5", "\"NaN\"", "[]"}) {
    layout.fill = fill;
    write(path, zarr3Files(layout, bytes));
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains("fill value"));
  }
}

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
  const std::string fine = randomSamples(SampleType::uint16, voxels(kZarr3Size), 6);
  std::map<std::string, std::string> files;
  for (const auto& [name, bytes] : zarr3Files(layoutOf(SampleType::uint16), fine))
    files["before/0/" + name] = files["after/0/" + name] = files["lost/0/" + name] = bytes;
  files["zarr.json"] = group(R"("scene": {"coordinateTransformations": []})");
  files["before/zarr.json"] = image(sequence);
  files["after/zarr.json"] = image("{" + scale + ", " + ends + "}");
  files["lost/zarr.json"] = image("{" + scale + R"(, "output": {"name": "nowhere"}})");
  write(path, files);
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
    write(path, files);
    CHECK_THROWS_WITH(openImage(path, {}, "before"), Contains(said));
  }
}

TEST_CASE("image_zarr3: OME-Zarr 0.5 gives scales, voxel sizes and labels", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.ome.zarr";
  const std::string fine = randomSamples(SampleType::uint16, voxels(kZarr3Size), 6);
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
    for (const auto& [name, bytes] : zarr3Files(layoutOf(SampleType::uint16), fine))
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
  write(path, files);
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
  write(path, files);
  CHECK_THROWS_WITH(openImage(path + "/s0"), Contains("'image', 'other'"));
}

TEST_CASE("image_zarr3: what cannot be read says why", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr", samples(voxels(kZarr3Size), 'a');
  Zarr3Layout layout{kZarr3Size, kZarr3Chunk};
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& why) {
    auto files = zarr3Files(layout, samples);
    files["zarr.json"] = replaced(files["zarr.json"], from, to);
    write(path, files);
    CAPTURE(from, to);
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains(why) && !Contains("\n"));
  };
  refused("\"array\"", "\"group\"", "no array itself");
  refused("\"zarr_format\": 3", "\"zarr_format\": 4", "version 3");
  refused("regular", "rectilinear", "regular");
  refused("\"uint8\"", "\"float16\"", "float16");
  refused("\"uint8\"", "{\"name\": \"uint8\"}", "type");
  refused("\"default\"", "\"other\"", "chunk keys");
  refused("\"bytes\"", "\"vlen-utf8\"", "'vlen-utf8'");
  refused("\"codecs\": [", "\"codecs\": [7, ", "codec");
  refused("}}], \"attributes\"", "}}, {\"name\": \"lz4\"}], \"attributes\"", "'lz4'");
  refused("}}], \"attributes\"", "}}, \"gzip\", \"zstd\"], \"attributes\"", "twice");
  refused("}}], \"attributes\"", "}}, \"bytes\"], \"attributes\"", "'bytes'");
  refused("\"attributes\"", "\"new\": {\"must_understand\": true}, \"attributes\"", "'new'");
  refused("\"attributes\"", "\"new\": 1, \"attributes\"", "'new'");
  refused("\"attributes\"", "\"storage_transformers\": [{}], \"attributes\"", "transformers");
  refused("[9, 7, 11]", "[2, 9, 7, 11]", "2 volumes");
  refused("[9, 7, 11]", "[1, 9, 7, 11]", "numbers of axes");
  refused("[9, 7, 11]", "[7, 11]", "choose another array");
  refused("[9, 7, 11]", "[9, 0, 11]", "not within");
  refused("[9, 7, 11]", "[9, 7, -1]", "not within");
  refused("[9, 7, 11]", "[99999, 7777, 1111]", "too few");
  refused("[5, 3, 4]", "[99999, 99999, 99999]", "2 GB");
  layout.type = "uint16";
  layout.bytes = 2;
  layout.size = ImageSize{11, 7, 4};
  refused("\"endian\": \"little\"", "", "byte order");
  layout = {kZarr3Size, kZarr3Chunk};
  layout.order = "xyz";
  for (const std::string order : {"[2, 1]", "[2, 1, 1]", "[3, 1, 0]", "[-1, 1, 0]", "\"F\""})
    refused("[2, 1, 0]", order, "transpose");
  layout.order.clear();
  layout.shard = kZarr3Shard;
  refused("[5, 3, 4]", "[5, 4, 4]", "multiples");
  refused("[5, 3, 4]", "[1, 5, 3, 4]", "numbers of axes");
  refused("\"chunk_shape\": [5, 3, 4]", "\"chunk\": 1", "not that of a volume");
  refused("\"end\"", "\"middle\"", "'\"middle\"'");
  refused("\"index_codecs\": [", "\"index_codecs\": [\"gzip\", ", "'gzip'");
  refused("\"name\": \"bytes\"", "\"name\": \"sharding_indexed\"", "within shards");
  refused("}}], \"attributes\"", "}}, \"gzip\"], \"attributes\"", "besides sharding");
  refused("\"crc32c\"", "\"gzip\"", "index of its shards");

  // Nothing else has to be understood.
  auto files = zarr3Files(layout, samples);
  files["zarr.json"] = replaced(files["zarr.json"], "\"attributes\"",
                                "\"new\": {\"must_understand\": false}, \"attributes\"");
  write(path, files);
  CHECK(readAll(*openImage(path)) == samples);
}

TEST_CASE("image_zarr3: damaged chunks and shards are refused", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr", samples(voxels(kZarr3Size), 'a');
  Zarr3Layout layout{kZarr3Size, kZarr3Chunk};
  for (const Codecs& codecs : {Codecs{}, Codecs{"gzip"}, Codecs{"zstd"}, Codecs{"blosc"},
                               Codecs{"crc32c"}, Codecs{"zstd", "crc32c"}})
    for (const std::string& bytes : {std::string(), std::string("abc"), std::string(30, 'x'),
                                     std::string(59, '\2'), std::string(5000, 'y')}) {
      layout.codecs = codecs;
      write(path, zarr3Files(layout, samples));
      overwriteFile(path + "/c/1/1/1", bytes);
      CAPTURE(codecs, bytes.size());
      CHECK_THROWS_WITH(readAll(*openImage(path)), Contains(path) && Contains("c/1/1/1"));
    }
  layout.codecs = {"crc32c"};
  auto files = zarr3Files(layout, samples);
  files["c/1/1/1"][7] = 'b';
  write(path, files);
  CHECK_THROWS_WITH(readAll(*openImage(path)), Contains("c/1/1/1") && Contains("checksum"));

  // Four chunks, then an index of 64 bytes and its checksum.
  layout.codecs.clear();
  layout.shard = kZarr3Shard;
  const auto damaged = [&](const std::string& shard, const std::string& why) {
    auto changed = zarr3Files(layout, samples);
    changed["c/0/0/0"] = shard;
    write(path, changed);
    CHECK_THROWS_WITH(readAll(*openImage(path)),
                      Contains(path) && Contains("c/0/0/0") && Contains(why));
  };
  const std::string shard = zarr3Files(layout, samples).at("c/0/0/0");
  damaged("", "too short");
  damaged(shard.substr(0, 60), "too short");
  damaged(shard.substr(0, shard.size() - 1), "checksum");
  layout.indexCodecs.clear();
  const std::string bare = zarr3Files(layout, samples).at("c/0/0/0");
  const auto withPlace = [&](uint64_t offset, uint64_t length) {
    std::string place;
    appendNumber(place, offset, false);
    appendNumber(place, length, false);
    return bare.substr(0, bare.size() - 64) + place + bare.substr(bare.size() - 48);
  };
  CHECK(withPlace(0, 60) == bare);
  damaged(withPlace(uint64_t(1) << 40, 60), "beyond its end");
  damaged(withPlace(8, ~uint64_t(0) - 4), "beyond its end");
  damaged(withPlace(bare.size() - 59, 60), "beyond its end");
  damaged(withPlace(0, 59), "59 bytes");
  // A claim of more chunks than there are places for.
  layout.shard = ImageSize{1048576, 1048575, 1048575};
  layout.size = ImageSize{1048576, 2, 2};
  layout.chunk = ImageSize{1, 1, 1};
  write(path, {{"zarr.json", zarr3Description(layout)}, {"c/0/0/0", std::string(4096, '\0')}});
  CHECK_THROWS_WITH(openImage(path), Contains("too short for the index"));
}
