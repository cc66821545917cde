// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>

#include "support/catch.h"
#include "support/files.h"
#include "support/image_damage.h"
#include "support/images.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/open_image.h"

// Files that are cut short or changed at random: each either reads or is refused with one line that
// names it. Most valuable in a build with sanitizers.

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

const ImageSize kDamagedSize{19, 17, 4};
/// Of files that are cut at every byte.
const ImageSize kCutSize{5, 4, 3};
constexpr int kMutationsPerFile = 1500;
/// What a header may make us allocate, as a multiple of the file: Deflate's and LZW's expansion,
/// and eight slices at a time.
constexpr uint64_t kMaxExpansion = 8 * 4096;
/// The files have some kilobytes; a reader's buffers of fixed size and a stray page are allowed.
constexpr uint64_t kDamageMemory = uint64_t(64) << 20;

struct SampleFile {
  std::string name, bytes;
  /// Beside the file, for detached headers.
  std::string dataName, data;
  size_t headerBytes;  ///< most mutations hit these
};

std::string tiff(const ScratchFolder& folder, const ImageSize& size, SampleType type,
                 const TiffLayout& layout) {
  const std::string path = folder / "sample.tif";
  const size_t row = layout.bits == 1 ? size_t(size.x + 7) / 8 : size_t(size.x);
  std::string bytes = randomSamples(type, row * size_t(size.y) * size_t(size.z), 21);
  writeTiff(path, size, type, bytes, layout);
  return readFile(path);
}

std::vector<SampleFile> sampleFiles(const ScratchFolder& folder,
                                    const ImageSize& size = kDamagedSize) {
  std::vector<SampleFile> all;
  for (const int compression :
       {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS})
    for (const std::string mode : {"wl", "wb8"})
      for (const uint32_t tile : {0u, 16u}) {
        TiffLayout layout;
        layout.mode = mode;
        layout.compression = compression;
        layout.tile = tile;
        layout.rowsPerStrip = 8;
        layout.description =
            "ImageJ=1.5\nimages=" + std::to_string(size.z) + "\nunit=um\nspacing=2\n";
        layout.resolution = 0.5;
        const std::string bytes = tiff(folder, size, SampleType::uint16, layout);
        all.push_back({"a.tif", bytes, "", "", bytes.size()});
      }
  for (const int compression :
       {COMPRESSION_CCITTRLE, COMPRESSION_CCITTFAX3, COMPRESSION_CCITTFAX4}) {
    TiffLayout layout;
    layout.bits = 1;
    layout.compression = compression;
    const std::string bytes = tiff(folder, size, SampleType::uint8, layout);
    all.push_back({"a.tif", bytes, "", "", bytes.size()});
  }
  const std::string voxelBytes = randomSamples(SampleType::int16, voxels(size), 22);
  const std::string sizes =
      std::to_string(size.x) + " " + std::to_string(size.y) + " " + std::to_string(size.z) + "\n";
  const std::string meta =
      "ObjectType = Image\nNDims = 3\nBinaryDataByteOrderMSB = False\nDimSize = " + sizes +
      "ElementSpacing = 0.01 0.01 0.01\nElementType = MET_SHORT\n";
  const std::string nrrd = "NRRD0004\ntype: short\ndimension: 3\nsizes: " + sizes +
                           "endian: little\nspacings: 2 2 2\n"
                           "units: \"um\" \"um\" \"um\"\nencoding: ";
  const auto add = [&](const std::string& name, const std::string& header,
                       const std::string& data) {
    all.push_back({name, header + data, "", "", header.size() + 8});
  };
  add("a.mha", meta + "ElementDataFile = LOCAL\n", voxelBytes);
  add("a.mha", meta + "CompressedData = True\nElementDataFile = LOCAL\n", deflated(voxelBytes, 15));
  all.push_back({"a.mhd", meta + "HeaderSize = 7\nElementDataFile = b.raw\n", "b.raw",
                 "header\n" + voxelBytes, meta.size()});
  add("a.nrrd", nrrd + "raw\n\n", voxelBytes);
  add("a.nrrd", nrrd + "gzip\nbyte skip: 2\n\n", deflated("xx" + voxelBytes, 31));
  all.push_back({"a.nhdr", nrrd + "raw\nline skip: 1\nbyte skip: 3\ndata file: b.raw\n", "b.raw",
                 "header\n...." + voxelBytes.substr(1), nrrd.size()});
  return all;
}

}  // namespace

TEST_CASE("image_file: the samples of the damage tests are sound", "[image_file]") {
  const ScratchFolder folder;
  for (const SampleFile& sample : sampleFiles(folder)) {
    writeFile(folder / sample.name, sample.bytes);
    if (!sample.dataName.empty()) writeFile(folder / sample.dataName, sample.data);
    CHECK(openImage(folder / sample.name)->info().size == kDamagedSize);
    const std::string samples = readAll(*openImage(folder / sample.name));
    CHECK(samples.find_first_not_of('\0') != std::string::npos);
  }
}

TEST_CASE("image_file: files cut short are refused with one line that names them, or read whole",
          "[image_file]") {
  const ScratchFolder folder;
  const ScratchFolder other;
  CapturedStderr output(other / "stderr");
  for (const SampleFile& sample : sampleFiles(folder, kCutSize)) {
    const std::string path = folder / sample.name;
    std::vector<std::string> files{sample.name};
    if (!sample.dataName.empty()) files.push_back(sample.dataName);
    for (const std::string& file : files) {
      writeFile(path, sample.bytes);
      if (!sample.dataName.empty()) writeFile(folder / sample.dataName, sample.data);
      CAPTURE(sample.name, file);
      REQUIRE(complaintOfCuts(path, folder / file, sample.headerBytes, kMaxExpansion) == "");
    }
  }
  CHECK(output.text() == "");
}

TEST_CASE("image_file: mutated files read or are refused with one line that names them",
          "[image_file]") {
  const ScratchFolder folder;
  const ScratchFolder other;
  CapturedStderr output(other / "stderr");
  unsigned seed = 1000;
  const std::vector<SampleFile> all = sampleFiles(folder);
  for (const SampleFile& sample : all) {
    const std::string path = folder / sample.name;
    const auto files = std::count_if(all.begin(), all.end(), [&](const SampleFile& another) {
      return another.name.substr(0, 3) == sample.name.substr(0, 3);  // of the format
    });
    if (!sample.dataName.empty()) writeFile(folder / sample.dataName, sample.data);
    const int mutations = mutationsPerFormat(kMutationsPerFile * int(files)) / int(files);
    const MemoryLimit limit(kDamageMemory);
    for (int i = 0; i < mutations; ++i) {
      const std::string bytes = mutated(sample.bytes, sample.headerBytes, ++seed);
      writeFile(path, bytes);
      const std::string wrong = complaint(path, bytes.size() + sample.data.size(), kMaxExpansion);
      if (wrong.empty()) continue;
      CAPTURE(sample.name, seed, wrong);
      REQUIRE(wrong.empty());
    }
  }
  CHECK(output.text() == "");
}

TEST_CASE("image_file: missing, empty and meaningless files", "[image_file]") {
  const ScratchFolder folder;
  std::mt19937 random(3);
  std::string noise;
  for (int i = 0; i < 5000; ++i) noise.push_back(char(random()));
  for (const std::string ending : {"tif", "mhd", "mha", "nrrd", "nhdr", "raw", "dat"}) {
    const std::string path = folder / ("a." + ending);
    CAPTURE(path);
    CHECK_THROWS_AS(openImage(folder / "none/b.tif"), IoError);
    CHECK_THROWS_AS(openImage(folder / ("b." + ending)), IoError);
    for (const std::string& content : {std::string(), std::string(1, '\0'), noise}) {
      writeFile(path, content);
      CHECK_THROWS_AS(openImage(path), IoError);
      CHECK(complaint(path, 100, kMaxExpansion) == "");
    }
  }
  CHECK_THROWS_AS(openImage("/dev/null"), IoError);
}

TEST_CASE("image_file: TIFF pages in a circle end", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.tif";
  TiffLayout layout;
  layout.mode = "wl";
  writeTiff(path, kDamagedSize, SampleType::uint8,
            randomSamples(SampleType::uint8, voxels(kDamagedSize), 1), layout);
  std::string bytes = readFile(path);
  const auto word = [&](size_t place, size_t count) {
    uint32_t value = 0;
    std::memcpy(&value, &bytes[place], count);
    return value;
  };
  const uint32_t first = word(4, 4);
  uint32_t directory = first, link = 0;
  while (directory) {
    link = directory + 2 + 12 * word(directory, 2);
    directory = word(link, 4);
  }
  std::memcpy(&bytes[link], &first, 4);
  writeFile(path, bytes);
  CHECK_THROWS_AS(openImage(path), IoError);
}
