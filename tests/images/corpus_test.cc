// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>

#include "support/catch.h"
#include "support/files.h"
#include "support/image_corpus.h"
#include "support/image_damage.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

// What damage_test.cc does to TIFF, MetaImage and NRRD, done to the formats of one or more
// files: thousands of changed files each, which either read or are refused with one line.

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Shared by the files of a format.
const int kMutationsPerFormat = mutationsPerFormat(5000);
/// The files have some kilobytes; a reader's buffers of fixed size and a stray page are allowed.
constexpr uint64_t kCorpusMemory = uint64_t(64) << 20;

}  // namespace

TEST_CASE("image_corpus: the samples are sound", "[image_corpus]") {
  for (const CorpusSample& sample : corpusSamples()) {
    const ScratchFolder folder;
    sample.write(folder);
    CAPTURE(sample.format);
    CHECK(openImage(folder / sample.path)->info().size == kCorpusSize);
    CHECK(sample.format.find(openImage(folder / sample.path)->info().format) == 0);
    CHECK(complaint(folder / sample.path, sample.bytes(), sample.expansion) == "");
  }
}

TEST_CASE("image_corpus: files cut short are refused with one line that names them, or read whole",
          "[image_corpus]") {
  const ScratchFolder other;
  CapturedStderr output(other / "stderr");
  for (const CorpusSample& sample : corpusSamples()) {
    const ScratchFolder folder;
    sample.write(folder);
    const MemoryLimit limit(kCorpusMemory);
    const std::string path = folder / sample.path, file = folder / sample.changed;
    CAPTURE(sample.format, sample.changed);
    if (sample.sameSize) {
      REQUIRE(complaintOfCuts(path, file, sample.headerBytes, sample.expansion) == "");
      continue;
    }
    for (size_t length = sample.files.at(sample.changed).size(); length-- > 0;) {
      std::filesystem::resize_file(file, length);
      CAPTURE(length);
      REQUIRE(complaint(path, sample.bytes(), sample.expansion) == "");
    }
  }
  CHECK(output.text() == "");
}

TEST_CASE("image_corpus: changed files read or are refused with one line that names them",
          "[image_corpus]") {
  const ScratchFolder other;
  CapturedStderr output(other / "stderr");
  unsigned seed = 1000;
  const std::vector<CorpusSample> all = corpusSamples();
  for (const CorpusSample& sample : all) {
    const auto files = std::count_if(all.begin(), all.end(), [&](const CorpusSample& another) {
      return another.format == sample.format;
    });
    const ScratchFolder folder;
    sample.write(folder);
    const MemoryLimit limit(kCorpusMemory);
    const std::string& whole = sample.files.at(sample.changed);
    for (int i = 0; i < kMutationsPerFormat / files; ++i) {
      const std::string bytes = mutated(whole, sample.headerBytes, ++seed);
      overwriteFile(folder / sample.changed, bytes);
      const std::string wrong =
          complaint(folder / sample.path, sample.bytes() + bytes.size(), sample.expansion);
      if (wrong.empty()) continue;
      CAPTURE(sample.format, seed, wrong);
      REQUIRE(wrong.empty());
    }
  }
  CHECK(output.text() == "");
}

TEST_CASE("image_corpus: PNG of sound checksums and unsound content", "[image_corpus]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.png", samples = randomSamples(SampleType::uint8, 19 * 17, 4);
  const std::string file = pngFile({19, 17, 8, 0, true}, samples);
  const size_t first = 8 + 8;  // of the header's 13 bytes, behind signature, length and kind
  const MemoryLimit limit(kCorpusMemory);
  std::mt19937 random(5);
  for (int i = 0; i < kMutationsPerFormat; ++i) {
    std::string header = file.substr(first, 13), rows;
    for (unsigned k = random() % 3; k > 0; --k) header[random() % 13] = char(random() % 20);
    if (random() % 4 == 0) header[random() % 8] = char(random());
    for (unsigned k = random() % 500; k > 0; --k) rows += char(random() % 6);
    overwriteFile(path, file.substr(0, 8) + pngChunk("IHDR", header) +
                            pngChunk("IDAT", deflated(rows, 15)) + pngChunk("IEND", ""));
    CAPTURE(i);
    REQUIRE(complaint(path, file.size(), 8 * kDeflate) == "");
  }
}
