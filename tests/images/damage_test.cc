// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>

#include "support/catch.h"
#include "support/files.h"
#include "support/image_corpus.h"
#include "support/image_damage.h"
#include "support/images.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/open_image.h"

// Files that are cut short or changed at random: each either reads or is refused with one line that
// names it. Most valuable in a build with sanitizers.

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Of files that are cut at every byte.
const ImageSize kCutSize{5, 4, 3};
constexpr int kMutationsPerFile = 1500;
/// The files have some kilobytes; a reader's buffers of fixed size and a stray page are allowed.
constexpr uint64_t kDamageMemory = uint64_t(64) << 20;

}  // namespace

TEST_CASE("image_file: the samples of the damage tests are sound", "[image_file]") {
  const ScratchFolder folder;
  for (const SampleFile& sample : sampleFiles(folder)) {
    writeFile(folder / sample.name, sample.bytes);
    if (!sample.dataName.empty()) writeFile(folder / sample.dataName, sample.data);
    CHECK(openImage(folder / sample.name)->info().size == kCorpusSize);
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
      overwriteFile(path, bytes);
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
  writeTiff(path, kCorpusSize, SampleType::uint8,
            randomSamples(SampleType::uint8, voxels(kCorpusSize), 1), layout);
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
