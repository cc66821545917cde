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

const ImageSize kZarr3Shard{8, 6, 5};

void checkReads(const std::string& path, const std::string& bytes) {
  const auto image = openImage(path);
  CHECK(image->info().size == kZarrSize);
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
        Zarr3Layout layout = zarr3Layout(type);
        layout.order = order;
        layout.bigEndian = bigEndian;
        layout.leading = order == "xyz" ? 2 : 0;
        CAPTURE(layout.type, order, bigEndian);
        const std::string bytes = randomSamples(type, voxels(kZarrSize), 1);
        writeZarr(path, zarr3Files(layout, bigEndian ? swapped(bytes, layout.bytes) : bytes));
        CHECK(looksLikeImage(path));
        CHECK(openImage(path)->info().type == type);
        CHECK_FALSE(openImage(path)->info().voxelSize);
        checkReads(path, bytes);
      }
}

TEST_CASE("image_zarr3: one transposition after the other", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  const std::string bytes = randomSamples(SampleType::uint8, voxels(kZarrSize), 8);
  Zarr3Layout layout = zarr3Layout(SampleType::uint8);
  layout.order = "yxz";
  auto files = zarr3Files(layout, bytes);
  const auto transposition = [](const std::string& order) {
    return R"({"name": "transpose", "configuration": {"order": )" + order + "}}";
  };
  files["zarr.json"] = replaced(files["zarr.json"], transposition("[1, 2, 0]"),
                                transposition("[1, 0, 2]") + ", " + transposition("[0, 2, 1]"));
  writeZarr(path, files);
  checkReads(path, bytes);
}

TEST_CASE("image_zarr3: every codec, in shards or not, and every key", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  const std::string bytes = randomSamples(SampleType::uint16, voxels(kZarrSize), 2);
  for (const Codecs& codecs :
       {Codecs{}, Codecs{"gzip"}, Codecs{"zstd"}, Codecs{"blosc"}, Codecs{"crc32c"},
        Codecs{"gzip", "crc32c"}, Codecs{"crc32c", "gzip"}, Codecs{"crc32c", "zstd", "crc32c"},
        Codecs{"blosc", "crc32c"}, Codecs{"crc32c", "crc32c"}})
    for (const int sharded : {0, 1, 2, 3}) {
      Zarr3Layout layout = zarr3Layout(SampleType::uint16);
      layout.codecs = codecs;
      if (sharded > 0) layout.shard = sharded == 3 ? ImageSize{12, 9, 10} : kZarr3Shard;
      layout.indexAtStart = sharded == 2;
      if (sharded == 3) layout.indexCodecs.clear();
      layout.keys = sharded % 2 ? "v2" : "default";
      layout.separator = sharded > 1 ? "." : "/";
      layout.leading = sharded % 2;
      CAPTURE(codecs, sharded);
      writeZarr(path, zarr3Files(layout, bytes));
      checkReads(path, bytes);
      layout.bigEndian = true;
      layout.order = "yxz";
      writeZarr(path, zarr3Files(layout, swapped(bytes, 2)));
      checkReads(path, bytes);
    }
}

TEST_CASE("image_zarr3: bool, 64-bit labels, and codecs and keys that are named alone",
          "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  Zarr3Layout layout = zarr3Layout(SampleType::uint8);
  std::string bits = randomSamples(SampleType::uint8, voxels(kZarrSize), 3);
  for (char& c : bits) c &= 1;
  layout.type = "bool";
  layout.fill = "false";
  writeZarr(path, zarr3Files(layout, bits));
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
  writeZarr(path, zarr3Files(layout, bits));
  writeFile(path + "/zarr.json", replaced(zarr3Description(layout),
                                          R"({"name": "v2", "configuration": {"separator": "."}})",
                                          R"({"name": "v2"})"));
  checkReads(path, bits);

  const std::string labels = randomSamples(SampleType::uint32, voxels(kZarrSize), 4);
  std::string wide;
  for (size_t i = 0; i < labels.size(); i += 4) wide += labels.substr(i, 4) + std::string(4, '\0');
  Zarr3Layout wideLayout{kZarrSize, kZarrChunk};
  wideLayout.type = "uint64";
  wideLayout.bytes = 8;
  writeZarr(path, zarr3Files(wideLayout, wide));
  CHECK(openImage(path)->info().type == SampleType::uint32);
  checkReads(path, labels);
  wide[4] = 1;
  writeZarr(path, zarr3Files(wideLayout, wide));
  CHECK_THROWS_WITH(readAll(*openImage(path)), Contains(path) && Contains("beyond 32 bits"));
}

TEST_CASE("image_zarr3: chunks and shards that are not there are the fill value", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  std::string bytes = randomSamples(SampleType::uint8, voxels(kZarrSize), 5);
  const auto fillBox = [&](const ImageSize& first, const ImageSize& end, char value) {
    std::string filled = bytes;
    for (int z = first.z; z < end.z; ++z)
      for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) filled[size_t((z * 7 + y) * 11 + x)] = value;
    return filled;
  };
  Zarr3Layout layout = zarr3Layout(SampleType::uint8);
  layout.fill = "7";
  writeZarr(path, zarr3Files(layout, bytes));
  std::filesystem::remove(path + "/c/1/0/2");
  checkReads(path, fillBox({8, 0, 5}, {11, 3, 9}, 7));

  layout.shard = kZarr3Shard;
  bytes = fillBox({4, 3, 0}, {8, 6, 5}, 0);  // a chunk that is left out of its shard
  writeZarr(path, zarr3Files(layout, bytes));
  std::filesystem::remove(path + "/c/1/1/0");
  bytes = fillBox({4, 3, 0}, {8, 6, 5}, 7);
  checkReads(path, fillBox({0, 6, 5}, {8, 7, 9}, 7));

  for (const std::string fill : {"256", "-1", "0.5", "\"NaN\"", "[]"}) {
    layout.fill = fill;
    writeZarr(path, zarr3Files(layout, bytes));
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains("fill value"));
  }
}

TEST_CASE("image_zarr3: what cannot be read says why", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr", samples(voxels(kZarrSize), 'a');
  Zarr3Layout layout{kZarrSize, kZarrChunk};
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& why) {
    auto files = zarr3Files(layout, samples);
    files["zarr.json"] = replaced(files["zarr.json"], from, to);
    writeZarr(path, files);
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
  refused("\"attributes\"", "\"dimension_names\": [\"x\", \"y\", \"z\"], \"attributes\"",
          "its axes are called 'x', 'y', 'z'");
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
  layout = {kZarrSize, kZarrChunk};
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
  writeZarr(path, files);
  CHECK(readAll(*openImage(path)) == samples);
}

TEST_CASE("image_zarr3: damaged chunks and shards are refused", "[image_zarr3]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr", samples(voxels(kZarrSize), 'a');
  Zarr3Layout layout{kZarrSize, kZarrChunk};
  for (const Codecs& codecs : {Codecs{}, Codecs{"gzip"}, Codecs{"zstd"}, Codecs{"blosc"},
                               Codecs{"crc32c"}, Codecs{"zstd", "crc32c"}})
    for (const std::string& bytes : {std::string(), std::string("abc"), std::string(30, 'x'),
                                     std::string(59, '\2'), std::string(5000, 'y')}) {
      layout.codecs = codecs;
      writeZarr(path, zarr3Files(layout, samples));
      overwriteFile(path + "/c/1/1/1", bytes);
      CAPTURE(codecs, bytes.size());
      CHECK_THROWS_WITH(readAll(*openImage(path)), Contains(path) && Contains("c/1/1/1"));
    }
  layout.codecs = {"crc32c"};
  auto files = zarr3Files(layout, samples);
  files["c/1/1/1"][7] = 'b';
  writeZarr(path, files);
  CHECK_THROWS_WITH(readAll(*openImage(path)), Contains("c/1/1/1") && Contains("checksum"));

  // Four chunks, then an index of 64 bytes and its checksum.
  layout.codecs.clear();
  layout.shard = kZarr3Shard;
  const auto damaged = [&](const std::string& shard, const std::string& why) {
    auto changed = zarr3Files(layout, samples);
    changed["c/0/0/0"] = shard;
    writeZarr(path, changed);
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
  writeZarr(path, {{"zarr.json", zarr3Description(layout)}, {"c/0/0/0", std::string(4096, '\0')}});
  CHECK_THROWS_WITH(openImage(path), Contains("too short for the index"));
}
