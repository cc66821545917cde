// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "support/compound_files.h"
#include "support/files.h"
#include "support/header_files.h"
#include "support/images.h"
#include "support/picture_files.h"
#include "support/zarr_files.h"

// Small files of every format but HDF5, which tests damage and tests/fuzz begins with.

namespace vdb_madf::test {

const ImageSize kCorpusSize{19, 17, 4};
/// What a header may make us allocate, as a multiple of the file: Deflate's and LZW's expansion,
/// and eight slices at a time.
constexpr uint64_t kMaxExpansion = 8 * 4096;
/// How many bytes zlib may make of one.
constexpr uint64_t kDeflate = 1032;

/// A small file of TIFF, MetaImage or NRRD.
struct SampleFile {
  std::string name, bytes;
  /// Beside the file, for detached headers.
  std::string dataName, data;
  size_t headerBytes;  ///< most mutations hit these
};

inline std::string tiffBytes(const ScratchFolder& folder, const ImageSize& size, SampleType type,
                             const TiffLayout& layout) {
  const std::string path = folder / "sample.tif";
  const size_t row = layout.bits == 1 ? size_t(size.x + 7) / 8 : size_t(size.x);
  std::string bytes = randomSamples(type, row * size_t(size.y) * size_t(size.z), 21);
  writeTiff(path, size, type, bytes, layout);
  return readFile(path);
}

inline std::vector<SampleFile> sampleFiles(const ScratchFolder& folder,
                                           const ImageSize& size = kCorpusSize) {
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
        const std::string bytes = tiffBytes(folder, size, SampleType::uint16, layout);
        all.push_back({"a.tif", bytes, "", "", bytes.size()});
      }
  for (const int compression :
       {COMPRESSION_CCITTRLE, COMPRESSION_CCITTFAX3, COMPRESSION_CCITTFAX4}) {
    TiffLayout layout;
    layout.bits = 1;
    layout.compression = compression;
    const std::string bytes = tiffBytes(folder, size, SampleType::uint8, layout);
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

/// A small volume of another format, of one or more files.
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

inline CorpusSample oneFile(const std::string& format, const std::string& name,
                            const std::string& bytes, size_t headerBytes, uint64_t expansion = 1) {
  return {format, name, {{name, bytes}}, name, headerBytes, expansion, true};
}

inline void addHeaderFiles(std::vector<CorpusSample>& all) {
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

inline void addPictures(std::vector<CorpusSample>& all) {
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

inline void addZarr(std::vector<CorpusSample>& all) {
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

inline void addZarr3(std::vector<CorpusSample>& all) {
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
    // A header may claim more of zstd and blosc.
    const std::string about = "z/zarr.json";
    all.push_back({"zarr3", "z", files, about, files.at(about).size(), 4096 * 32768, true});
  };
  addArray(false, {}, {});
  addArray(false, {"blosc", "crc32c"}, {});
  addArray(true, {"zstd"}, {});
  addArray(true, {"gzip"}, {"crc32c"});
}

inline std::vector<CorpusSample> corpusSamples() {
  std::vector<CorpusSample> all;
  addHeaderFiles(all);
  addPictures(all);
  addZarr(all);
  addZarr3(all);
  return all;
}

}  // namespace vdb_madf::test
