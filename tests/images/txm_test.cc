// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/catch.h"
#include "support/compound_files.h"
#include "support/files.h"
#include "support/image_damage.h"
#include "support/images.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

const ImageSize kTxmSize{70, 64, 5};  // slices of uint8 are large streams, in several sectors

CompoundFileBytes txm(const std::map<std::string, std::string>& streams, int version = 3,
                      unsigned seed = 0) {
  return CompoundWriter(version, seed).write(streams);
}

/// Without the path.
std::string refusal(const std::string& path) {
  try {
    readAll(*openImage(path));
  } catch (const IoError& error) {
    const std::string text = error.what();
    REQUIRE(text.compare(0, path.size() + 2, path + ": ") == 0);
    return text.substr(path.size() + 2);
  }
  return "none";
}

}  // namespace

TEST_CASE("image_txm: every type, version and order of sectors", "[image_txm]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.txm";
  const std::map<SampleType, int32_t> types = {
      {SampleType::int8, 2},     {SampleType::uint8, 3},   {SampleType::int16, 4},
      {SampleType::uint16, 5},   {SampleType::int32, 6},   {SampleType::uint32, 7},
      {SampleType::float32, 10}, {SampleType::float64, 11}};
  for (const auto& [type, number] : types)
    for (const ImageSize& size : {ImageSize{5, 3, 2}, kTxmSize})
      for (const int version : {3, 4})
        for (const unsigned seed : {0u, 7u}) {
          CAPTURE(sampleTypeName(type), size, version, seed);
          const std::string bytes = randomSamples(type, voxels(size), 1);
          writeFile(path, txm(txmStreams(size, number, bytes), version, seed).bytes);
          CHECK(looksLikeImage(path));
          const auto image = openImage(path);
          CHECK(image->info().size == size);
          CHECK(image->info().type == type);
          CHECK(image->info().format == "txm");
          CHECK(image->info().voxelSize->edge() == 2.0493e-6);
          CHECK(image->notes().empty());
          for (const int step : {1, 2, 100}) CHECK(readAll(*image, step) == bytes);
          std::string last(bytes.size() / size_t(size.z), '\0');
          image->read(size.z - 2, 1, last.data());  // any slice, also again
          CHECK(last == bytes.substr(last.size() * size_t(size.z - 2), last.size()));
        }
}

TEST_CASE("image_txm: slices in several storages, and a table of sectors too large for the header",
          "[image_txm]") {
  const ScratchFolder folder;
  const ImageSize size{180, 160, 250};
  const std::string bytes = randomSamples(SampleType::uint8, voxels(size), 2);
  const CompoundFileBytes file = txm(txmStreams(size, 3, bytes), 3, 3);
  REQUIRE(file.get(72) > 0);
  REQUIRE(file.table.size() > 109);
  writeFile(folder / "a.txm", file.bytes);
  CHECK((readAll(*openImage(folder / "a.txm")) == bytes));
}

TEST_CASE("image_txm: what is no scan, or lacks a part, is refused with what is wrong",
          "[image_txm]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.txm";
  const auto good = txmStreams(kTxmSize, 3, randomSamples(SampleType::uint8, voxels(kTxmSize), 1));
  const auto refused = [&](const std::string& stream, const std::string& content) {
    auto streams = good;
    if (content.empty())
      streams.erase(stream);
    else
      streams[stream] = content;
    writeFile(path, txm(streams).bytes);
    return refusal(path);
  };
  CHECK(
      refused("ImageInfo/ImageWidth", "") ==
      "has no stream ImageInfo/ImageWidth: it is damaged, or a compound file that is no TXM scan");
  CHECK(refused("ImageData1/Image3", "") == "has no stream ImageData1/Image3: slices are missing");
  CHECK(refused("ImageData1/Image3", std::string(4479, 'a')) ==
        "the stream ImageData1/Image3 has 4479 bytes, and a slice 4480");
  CHECK_THAT(refused("ImageInfo/DataType", bytesOf(int32_t(9))), Contains("of type 9"));
  CHECK_THAT(refused("ImageInfo/ImageHeight", bytesOf(int32_t(0))), Contains("is not within"));
  CHECK_THAT(refused("ImageInfo/ImageHeight", bytesOf(int32_t(-1))), Contains("is not within"));
  CHECK_THAT(refused("ImageInfo/NoOfImages", bytesOf(int32_t(1 << 20))), Contains("too small"));
  CHECK_THAT(refused("ImageInfo/PixelSize", bytesOf(-1.f)), Contains("spacing"));
  CHECK_THAT(refused("ImageInfo/PixelSize", "ab"), Contains("PixelSize is too short"));
  CHECK_THROWS_WITH(openImage(path, {}, "d"), Contains("no datasets"));

  auto streams = good;
  streams.erase("ImageInfo/PixelSize");
  streams["ImageInfo/AcquisitionMode"] = bytesOf(int32_t(0));
  writeFile(path, txm(streams).bytes);
  CHECK_FALSE(openImage(path)->info().voxelSize);
  REQUIRE(openImage(path)->notes().size() == 1);
  CHECK_THAT(openImage(path)->notes()[0], Contains(path) && Contains("projections"));
}

TEST_CASE("image_txm: chains and trees that lead astray end in one line", "[image_txm]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.txm", slice = "ImageData1/Image2";
  const ImageSize size{70, 64, 20};
  const CompoundFileBytes good =
      txm(txmStreams(size, 3, randomSamples(SampleType::uint8, voxels(size), 1)), 3, 5);
  REQUIRE(good.table.size() > 1);
  const auto refused = [&](const auto& change) {
    CompoundFileBytes file = good;
    change(file);
    writeFile(path, file.bytes);
    const std::string text = refusal(path), begin = "is damaged or cut short: ";
    CHECK(text.compare(0, begin.size(), begin) == 0);
    return text.substr(std::min(begin.size(), text.size()));
  };
  using File = CompoundFileBytes;
  const auto link = [](File& file, uint32_t sector, uint32_t to) {
    file.put(file.placeOfLink(sector), to);
  };
  CHECK(refused([&](File& f) { link(f, f.first[slice], f.first[slice]); }) ==
        "a chain of sectors runs in a circle");
  CHECK(refused([&](File& f) { link(f, f.first[slice], 0xfffffffe); }) ==
        "a chain of sectors ends too early");
  CHECK(refused([&](File& f) { link(f, f.first[slice], 0x7fffffff); }) ==
        "a chain of sectors ends too early");
  CHECK(refused([&](File& f) { link(f, f.first[""], f.first[""]); }) ==
        "a chain of sectors has no end");
  CHECK(refused([&](File& f) { link(f, f.first[""], 0xffffffff); }) ==
        "a chain of sectors leads nowhere");
  CHECK(refused([&](File& f) { f.put(f.entry[slice] + 120, 0x7fffffff); }) ==
        "the stream imagedata1/image2 is larger than the file");
  CHECK(refused([&](File& f) { f.put(f.entry[""] + 120, 0x7fffffff); }) ==
        "a stream is larger than the file");
  CHECK(refused([&](File& f) { f.put(f.entry["ImageData1/Image11"] + 68, 0); }) ==
        "its directory is no tree");
  CHECK(refused([&](File& f) {
          for (const char* name : {"ImageData1/Image1", "ImageData1/Image3"})
            f.put(f.entry[name] + 68, 1000000);
        }) == "its directory is no tree");
  CHECK(refused([&](File& f) { f.put(f.entry[""] + 76, 0xffffff); }) == "its directory is no tree");
  CHECK(refused([&](File& f) { f.bytes[f.entry[""] + 66] = 1; }) == "its directory has no root");
  CHECK(refused([&](File& f) { f.put(76, 0x7fffffff); }) == "a sector lies beyond the end");
  CHECK(refused([&](File& f) { f.put(76, f.get(80)); }) == "its table of sectors has a part twice");
  CHECK(refused([&](File& f) { f.put(28, 0x000bfffe); }) ==
        "the header of a compound file makes no sense");
  CHECK(refused([&](File& f) { f.bytes.resize(300); }) ==
        "the header of a compound file is not whole");

  // Slices of 960 bytes are small streams.
  CompoundFileBytes small =
      txm(txmStreams({30, 32, 4}, 3, randomSamples(SampleType::uint8, 30 * 32 * 4, 1)));
  small.put(64, 0);
  writeFile(path, small.bytes);
  CHECK(refusal(path) == "is damaged or cut short: a small stream is not in its table");
}

TEST_CASE("image_txm: large slices, changed at random, read or are refused", "[image_txm]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.txm";
  const std::string samples = randomSamples(SampleType::uint8, voxels(kTxmSize), 1);
  const MemoryLimit limit(uint64_t(64) << 20);
  unsigned seed = 1;
  for (const int version : {3, 4}) {
    const CompoundFileBytes file = txm(txmStreams(kTxmSize, 3, samples), version, 9);
    for (int i = 0; i < mutationsPerFormat(2000) / 2; ++i) {
      std::string bytes = file.bytes;
      // One of two changes is in the header, the directory or the table of sectors.
      std::mt19937 random(++seed);
      const size_t begins[] = {0, file.place(file.first.at("")), file.place(file.table[0])};
      for (unsigned k = random() % 4; k > 0; --k) {
        const size_t place = begins[random() % 3] + random() % 512;
        bytes[place] = char(random() % 3 ? random() % 64 : random());
      }
      if (random() % 2) bytes = mutated(bytes, bytes.size(), seed);
      overwriteFile(path, bytes);
      CAPTURE(version, seed);
      REQUIRE(complaint(path, bytes.size(), 1) == "");
    }
  }
}
