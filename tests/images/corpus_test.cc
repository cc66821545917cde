// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <map>

#include "support/compound_files.h"
#include "support/files.h"
#include "support/header_files.h"
#include "support/image_damage.h"
#include "support/images.h"
#include "support/picture_files.h"
#include "support/zarr_files.h"

#include "support/catch.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

// What damage_test.cc does to TIFF, MetaImage and NRRD, done to the formats of one or more
// files: thousands of changed files each, which either read or are refused with one line.

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

const ImageSize kCorpusSize{19, 17, 4};
/// Shared by the files of a format.
const int kMutationsPerFormat = mutationsPerFormat(5000);
/// The files have some kilobytes; a reader's buffers of fixed size and a stray page are allowed.
constexpr uint64_t kCorpusMemory = uint64_t(64) << 20;
/// Of zlib.
constexpr uint64_t kDeflate = 1032;

struct CorpusSample {
  std::string format, path;                  ///< what is opened
  std::map<std::string, std::string> files;  ///< relative path to bytes
  std::string changed;                       ///< the file that is damaged
  size_t headerBytes;                        ///< most mutations hit these
  uint64_t expansion = 1;
  bool sameSize = true;  ///< cut short it is refused, or all samples are read

  uint64_t bytes() const {
    uint64_t sum = 0;
    for (const auto& file : files) sum += file.second.size();
    return sum;
  }
  void write(const ScratchFolder& folder) const {
    for (const auto& [name, content] : files) {
      std::filesystem::create_directories(std::filesystem::path(folder / name).parent_path());
      writeFile(folder / name, content);
    }
  }
};

CorpusSample oneFile(const std::string& format, const std::string& name, const std::string& bytes,
                     size_t headerBytes, uint64_t expansion = 1) {
  return {format, name, {{name, bytes}}, name, headerBytes, expansion, true};
}

void addHeaderFiles(std::vector<CorpusSample>& all) {
  const std::string bytes = randomSamples(SampleType::int16, voxels(kCorpusSize), 1);
  const std::string small = randomSamples(SampleType::uint8, voxels(kCorpusSize), 2);
  std::string labels;
  for (const char c : small) labels += c + std::string(7, '\0');
  const std::string npy =
      npyHeader("{'descr': '<i2', 'fortran_order': False, 'shape': (4, 17, 19), }", 1);
  all.push_back(oneFile("npy", "a.npy", npy + bytes, npy.size()));
  const std::string wide =
      npyHeader("{'descr': '>i8', 'fortran_order': False, 'shape': (4, 17, 19), }", 2);
  all.push_back(oneFile("npy", "a.npy", wide + swapped(labels, 8), wide.size()));
  IsqLayout isq;
  isq.voxels = kCorpusSize;
  isq.micrometres = ImageSize{190, 170, 40};
  isq.blocks = 1;
  all.push_back(oneFile("isq", "a.isq", isqFile(isq, bytes), 80));
  for (const int version : {3, 4}) {
    const CompoundFileBytes txm =
        CompoundWriter(version, 0).write(txmStreams(kCorpusSize, 4, bytes));
    all.push_back(oneFile("txm", "a.txm", txm.bytes, txm.bytes.size()));
  }
  NiftiLayout nifti;
  nifti.dim = {3, 19, 17, 4};
  nifti.type = 4;
  nifti.units = 2;
  nifti.slope = 2;
  all.push_back(oneFile("nifti", "a.nii", niftiFile(nifti, bytes), 352, 2));
  all.push_back(
      oneFile("nifti", "a.nii.gz", deflated(niftiFile(nifti, bytes), 31), 400, 2 * kDeflate));
  for (const std::string version : {"2", "3"}) {
    const auto coded = [&](const std::string& b) { return version == "3" ? deflated(b, 15) : b; };
    const std::string sizes = "X: 19\nY: 17\nZ: 4\n", end = "Version: " + version + "\n.\n";
    const uint64_t expansion = version == "3" ? kDeflate : 1;
    all.push_back(
        oneFile("vol", "a.vol", sizes + "Voxel-Size: 1\n" + end + coded(small), 50, expansion));
    all.push_back(oneFile("longvol", "a.longvol", sizes + "Lvoxel-Size: 8\n" + end + coded(labels),
                          50, expansion));
  }
  const std::string info =
      "! PyHST_SLAVE VOLUME INFO FILE\nNUM_X = 19\nNUM_Y = 17\nNUM_Z = 4\nvoxelSize = 8.5\n"
      "BYTEORDER = HIGHBYTEFIRST\n";
  all.push_back({"pyhst",
                 "a.vol",
                 {{"a.vol", bytes}, {"a.vol.info", info}},
                 "a.vol.info",
                 info.size(),
                 1,
                 false});
  // The type of its samples is told by its size: one of bytes has no shorter one.
  all.push_back(
      {"pyhst", "a.vol", {{"a.vol", small}, {"a.vol.info", info}}, "a.vol", 100, 1, true});
}

void addPictures(std::vector<CorpusSample>& all) {
  const size_t slice = 19 * 17;
  const auto add = [&](const std::string& kind, const auto& picture, uint64_t expansion) {
    const std::string samples = randomSamples(SampleType::uint8, 2 * slice * 4, 3);
    CorpusSample sample{kind, "s", {}, "s/2." + kind, 90, expansion, true};
    for (size_t z = 0; z < 4; ++z)
      sample.files["s/" + std::to_string(z) + "." + kind] =
          picture(samples.substr(2 * z * slice, 2 * slice));
    all.push_back(sample);
  };
  for (const bool interlaced : {false, true})
    for (const int bits : {1, 8, 16})
      add(
          "png",
          [&](std::string s) {
            if (bits == 1)
              for (char& c : s) c &= 1;
            return pngFile({19, 17, bits, 0, interlaced}, s);
          },
          8 * kDeflate);
  add(
      "png",
      [](const std::string& s) {
        std::string pixels;
        for (size_t i = 0; i < slice; ++i) pixels += std::string(3, s[i]);
        return pngFile({19, 17, 8, 2, true}, pixels);
      },
      8 * kDeflate);
  add(
      "bmp",
      [](const std::string& s) {
        return bmpFile({19, 17, 8, false, false, std::string(1024, 'a'), 0, 0}, s.substr(0, slice));
      },
      8);
  add(
      "bmp",
      [](const std::string& s) {
        return bmpFile({19, 17, 1, true, false, "aaaabbbb", 0, 0}, s.substr(0, 3 * 17));
      },
      8);
  CorpusSample log = all.back();
  log.files["s/rec.log"] =
      "[Acquisition]\nImage Pixel Size (um)= 8.4\n[Reconstruction]\nPixel Size (um)=8.5\n";
  log.changed = "s/rec.log";
  log.sameSize = false;
  all.push_back(log);
}

void addZarr(std::vector<CorpusSample>& all) {
  const std::string samples = randomSamples(SampleType::uint16, voxels(kCorpusSize), 6);
  for (const std::string codec : {"", "zlib", "lz4", "zstd", "blosclz"}) {
    const ZarrLayout layout{kCorpusSize, ImageSize{10, 9, 2}, "<u2", 2, codec, "C", ".", "0", 0};
    std::map<std::string, std::string> files;
    for (const auto& [name, bytes] : zarrFiles(layout, samples)) files["z/0/" + name] = bytes;
    files["z/.zattrs"] =
        R"({"multiscales": [{"axes": [{"unit": "micrometer"}, {"unit": "micrometer"},
            {"unit": "micrometer"}], "datasets": [{"path": "0", "coordinateTransformations":
            [{"type": "scale", "scale": [8.5, 8.5, 8.5]}]}]}]})";
    // A chunk that is absent is no damage, so there is little to say of what the array may claim.
    const auto add = [&](const std::string& changed, bool sameSize) {
      const size_t length = files.at(changed).size();
      all.push_back({"zarr", "z", files, changed, length, 4096 * kDeflate, sameSize});
    };
    add("z/0/1.1.0", true);
    add("z/0/.zarray", true);
    if (codec.empty()) add("z/.zattrs", true);
  }
}

void addZarr3(std::vector<CorpusSample>& all) {
  const std::string samples = randomSamples(SampleType::uint16, voxels(kCorpusSize), 7);
  const auto addArray = [&](bool sharded, const std::vector<std::string>& codecs,
                            const std::vector<std::string>& indexCodecs) {
    Zarr3Layout layout{kCorpusSize, ImageSize{10, 9, 2}};
    if (sharded) layout.shard = ImageSize{20, 9, 4};
    layout.type = "uint16";
    layout.bytes = 2;
    layout.codecs = codecs;
    layout.indexCodecs = indexCodecs;
    layout.order = sharded ? "yxz" : "";
    std::map<std::string, std::string> files;
    for (const auto& [name, bytes] : zarr3Files(layout, samples)) files["z/" + name] = bytes;
    const std::string chunk = sharded ? "z/c/0/1/0" : "z/c/1/1/0";
    all.push_back({"zarr3", "z", files, chunk, files.at(chunk).size(), 4096 * kDeflate, true});
    // Of zstd and blosc more may be claimed.
    const std::string about = "z/zarr.json";
    all.push_back({"zarr3", "z", files, about, files.at(about).size(), 4096 * 32768, true});
  };
  addArray(false, {}, {});
  addArray(false, {"blosc", "crc32c"}, {});
  addArray(true, {"zstd"}, {});
  addArray(true, {"gzip"}, {"crc32c"});
}

std::vector<CorpusSample> corpusSamples() {
  std::vector<CorpusSample> all;
  addHeaderFiles(all);
  addPictures(all);
  addZarr(all);
  addZarr3(all);
  return all;
}

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
      writeFile(folder / sample.changed, bytes);
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
    writeFile(path, file.substr(0, 8) + pngChunk("IHDR", header) +
                        pngChunk("IDAT", deflated(rows, 15)) + pngChunk("IEND", ""));
    CAPTURE(i);
    REQUIRE(complaint(path, file.size(), 8 * kDeflate) == "");
  }
}
