// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/catch.h"
#include "support/files.h"
#include "support/header_files.h"
#include "support/images.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

// Volumes in one piece behind a header: npy, NRRD as we write it, ISQ, NIfTI, vol, longvol, PyHST.
// All samples differ at random, so that an exchange of two axes shows.

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

const ImageSize kHeaderSize{5, 4, 3};

std::string wide(const std::string& bytes, SampleType type) {
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 4) {
    out += bytes.substr(i, 4);
    out += std::string(4, type == SampleType::int32 && bytes[i + 3] < 0 ? '\xff' : '\0');
  }
  return out;
}

}  // namespace

TEST_CASE("image_headers: npy of every type, byte order and version", "[image_headers]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.npy";
  const char* names[] = {"u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"};
  for (const SampleType type : kSampleTypes)
    for (const int version : {1, 2, 3}) {
      const std::string bytes = randomSamples(type, voxels(kHeaderSize), 1),
                        name = names[size_t(type)];
      CAPTURE(name, version);
      const std::string little = sampleSize(type) == 1 ? "|" : "<";
      writeFile(path, npyFile(little + name, "(3, 4, 5)", bytes, version));
      CHECK(looksLikeImage(path));
      const auto image = openImage(path);
      CHECK(image->info().size == kHeaderSize);
      CHECK(image->info().type == type);
      CHECK(image->info().format == "npy");
      CHECK_FALSE(image->info().voxelSize);
      CHECK(readAll(*image, 2) == bytes);
      writeFile(path, npyFile(">" + name, "(3, 4, 5)", swapped(bytes, sampleSize(type)), version));
      CHECK(readAll(*openImage(path)) == bytes);
    }
  const std::string flags = std::string("\1\0\1\1", 4) + std::string(56, '\0');
  writeFile(path, npyFile("|b1", "(3, 4, 5)", flags));
  CHECK(readAll(*openImage(path)) == flags);
}

TEST_CASE("image_headers: 64-bit labels are read as far as 32 bits go", "[image_headers]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.npy";
  for (const SampleType type : {SampleType::int32, SampleType::uint32}) {
    const std::string kind = type == SampleType::int32 ? "i8" : "u8";
    const std::string bytes = randomSamples(type, voxels(kHeaderSize), 2);
    std::string stored = wide(bytes, type);
    writeFile(path, npyFile("<" + kind, "(3, 4, 5)", stored));
    const auto image = openImage(path);
    CHECK(image->info().type == type);
    CHECK(readAll(*image, 2) == bytes);
    CHECK(readAll(*image, 1) == bytes);
    writeFile(path, npyFile(">" + kind, "(3, 4, 5)", swapped(stored, 8)));
    CHECK(readAll(*openImage(path)) == bytes);
    stored[8 * 20 + 5] = '\1';  // the first voxel of slice 1
    stored[8 * 20 + 7] = '\0';
    writeFile(path, npyFile("<" + kind, "(3, 4, 5)", stored));
    const auto broken = openImage(path);
    std::string slice(20 * 4, '\0');
    CHECK_NOTHROW(broken->read(0, 1, slice.data()));
    CHECK_THROWS_WITH(broken->read(1, 1, slice.data()),
                      Contains(path) && Contains("beyond 32 bits"));
  }
}

TEST_CASE("image_headers: npy that is no volume says why", "[image_headers]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.npy", bytes(60, 'a');
  const auto refused = [&](const std::string& file, const std::string& why) {
    writeFile(path, file);
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains(why));
  };
  refused(npyFile("|u1", "(3, 4, 5)", bytes, 1, "True"), "ascontiguousarray");
  refused(npyFile("|u1", "(60,)", bytes), "1 dimensions");
  refused(npyFile("|u1", "(1, 3, 4, 5)", bytes), "4 dimensions");
  refused(npyFile("|u1", "()", bytes), "0 dimensions");
  refused(npyFile("|u1", "(3, 4, 6)", bytes), "72");
  refused(npyFile("|u1", "(3, 4, 5)", bytes + "x"), "61");
  refused(npyFile("|u1", "(3, -4, -5)", bytes), "size");
  refused(npyFile("|u1", "(3, 4, 4294967301)", bytes), "size");
  refused(npyFile("|u1", "(3, 4, 5.0)", bytes), "shape");
  refused(npyFile("<f2", "(3, 4, 5)", bytes + bytes), "float32");
  refused(npyFile("<c8", "(3, 4, 5)", bytes), "'<c8'");
  refused(npyFile("|S1", "(3, 4, 5)", bytes), "'|S1'");
  refused(npyFile("|u1", "(3, 4, 5)", bytes, 4), "version 4");
  refused("\x93NUMPY\1", "not a whole");
  refused("\x93NUMPY\1\1\xff\xff{'descr'", "cut short");
  refused(npyHeader("[('a', '<u2')]", 1) + bytes, "cannot be read");
  refused(npyHeader("{'descr': '|u1', 'shape': (3, 4, 5), }", 1) + bytes, "lacks fortran_order");
}

TEST_CASE("image_headers: NRRD says size, type, spacing and unit", "[image_headers]") {
  const ScratchFolder folder;
  ImageInfo info;
  info.size = kHeaderSize;
  info.type = SampleType::uint16;
  info.voxelSize = VoxelSize{8.5e-6};
  const std::string bytes = randomSamples(info.type, voxels(kHeaderSize), 3);
  const auto writer = createImage(folder / "a.nrrd", info);
  writer->write(3, bytes.data());
  writer->finish();
  CHECK(readFile(folder / "a.nrrd") ==
        "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 5 4 3\nspacings: 0.0085 0.0085 0.0085\n"
        "units: \"mm\" \"mm\" \"mm\"\nendian: little\nencoding: raw\n\n" +
            bytes);
  CHECK_THROWS_AS(createImage(folder / "a.nhdr", info), InvalidInput);
}

TEST_CASE("image_headers: ISQ", "[image_headers]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.isq";
  const std::string bytes = randomSamples(SampleType::int16, voxels(kHeaderSize), 4);
  for (const int blocks : {0, 3})
    for (const size_t padding : {size_t(0), size_t(392), size_t(511)}) {
      IsqLayout layout;
      layout.voxels = kHeaderSize;
      layout.micrometres = ImageSize{50, 40, 30};
      layout.blocks = blocks;
      writeFile(path, isqFile(layout, bytes) + std::string(padding, '\0'));
      const auto image = openImage(path);
      CHECK(image->info().size == kHeaderSize);
      CHECK(image->info().type == SampleType::int16);
      CHECK(image->info().format == "isq");
      CHECK(image->info().voxelSize->edge() == 1e-5);
      CHECK(readAll(*image, 2) == bytes);
    }
  const auto edge = [&](const ImageSize& micrometres) {
    IsqLayout layout;
    layout.voxels = kHeaderSize;
    layout.micrometres = micrometres;
    writeFile(path, isqFile(layout, bytes));
    return openImage(path)->info().voxelSize->edge();
  };
  IsqLayout layout;
  layout.voxels = kHeaderSize;
  CHECK(edge(ImageSize{52, 41, 31}) == 10.4 / 1e6);  // 10.4 um, each side rounded
  layout.micrometres = ImageSize{50, 40, 60};
  writeFile(path, isqFile(layout, bytes));
  CHECK(openImage(path)->info().voxelSize->edges() == std::array<double, 3>{1e-5, 1e-5, 2e-5});
  CHECK_THROWS_WITH(edge(ImageSize{50, 0, 30}), Contains("spacing"));
  layout.micrometres = ImageSize{50, 40, 30};
  const auto refused = [&](const std::string& file, const std::string& why) {
    writeFile(path, file);
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains(why));
  };
  refused(isqFile(layout, bytes.substr(1)), "119 bytes");
  refused(isqFile(layout, bytes + std::string(512, '\0')), "632 bytes");
  refused(isqFile(layout, bytes).substr(0, 300), "not a whole");
  layout.type = 9;
  refused(isqFile(layout, bytes), "projections");
  layout.type = 3;
  layout.blocks = -1;
  const std::string damaged = isqFile(layout, bytes);
  refused(damaged, "block -1");
  layout.blocks = 0x7fffffff;
  refused(damaged.substr(0, 508) + "\xff\xff\xff\x7f" + bytes, "begin at");
}

TEST_CASE("image_headers: NIfTI-1, plain and compressed, in either byte order", "[image_headers]") {
  const ScratchFolder folder;
  const int codes[] = {2, 256, 512, 4, 768, 8, 16, 64};
  for (const SampleType type : kSampleTypes)
    for (const bool bigEndian : {false, true})
      for (const bool compressed : {false, true}) {
        CAPTURE(sampleTypeName(type), bigEndian, compressed);
        NiftiLayout layout;
        layout.dim = {3, 5, 4, 3};
        layout.type = codes[size_t(type)];
        layout.edge = {0.0085f, 0.0085f, 0.0085f};
        layout.units = 2 + 8;  // mm, s
        layout.bigEndian = bigEndian;
        layout.offset = 368;
        const std::string bytes = randomSamples(type, voxels(kHeaderSize), 5);
        std::string file = niftiFile(layout, bigEndian ? swapped(bytes, sampleSize(type)) : bytes);
        if (compressed) file = deflated(file, 31);
        const std::string path = folder / (compressed ? "a.nii.gz" : "a.nii");
        writeFile(path, file);
        CHECK(looksLikeImage(path));
        const auto image = openImage(path);
        CHECK(image->info().size == kHeaderSize);
        CHECK(image->info().type == type);
        CHECK(image->info().format == "nifti");
        CHECK(image->info().voxelSize->edge() == 8.5e-6);
        CHECK(readAll(*image, 1) == bytes);
        CHECK(readAll(*image, 2) == bytes);
        writeFile(folder / "b.dat", file);  // by content
        CHECK(readAll(*openImage(folder / "b.dat")) == bytes);
      }
}

TEST_CASE("image_headers: NIfTI-1 applies slope and unit, and says what it cannot read",
          "[image_headers]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.nii";
  const std::string bytes = randomSamples(SampleType::int16, voxels(kHeaderSize), 6);
  NiftiLayout layout;
  layout.dim = {3, 5, 4, 3};
  layout.type = 4;
  const auto open = [&](const std::string& samples) {
    writeFile(path, niftiFile(layout, samples));
    return openImage(path);
  };
  for (const std::pair<float, float>& none : {std::pair(0.f, 7.f), {1.f, 0.f}}) {
    layout.slope = none.first;
    layout.intercept = none.second;
    CHECK(open(bytes)->info().type == SampleType::int16);
  }
  layout.slope = 0.5f;
  layout.intercept = -2;
  const auto scaled = open(bytes);
  CHECK(scaled->info().type == SampleType::float32);
  const std::string values = readAll(*scaled, 2);
  for (size_t i = 0; i < voxels(kHeaderSize); ++i) {
    int16_t stored;
    float value;
    std::memcpy(&stored, &bytes[2 * i], 2);
    std::memcpy(&value, &values[4 * i], 4);
    REQUIRE(value == float(stored) / 2 - 2);
  }
  // Ids above 2^24 stay apart.
  layout.slope = 1;
  layout.intercept = -1;
  layout.type = 8;
  const std::array<int32_t, 2> ids{20000000, 20000002};
  std::string large(4 * voxels(kHeaderSize), '\0');
  std::memcpy(large.data(), ids.data(), sizeof ids);
  const std::string apart = readAll(*open(large), 2);
  REQUIRE(apart.size() == 8 * voxels(kHeaderSize));
  std::array<double, 2> found{};
  std::memcpy(found.data(), apart.data(), sizeof found);
  CHECK(found == std::array<double, 2>{19999999, 20000001});
  layout.type = 4;
  layout.slope = 0;
  layout.edge = {3, 3, 3};
  for (const auto& [units, metres] : {std::pair(0, 0.0), {1, 3.0}, {2, 3e-3}, {3, 3e-6}}) {
    layout.units = units;
    const auto size = open(bytes)->info().voxelSize;
    CHECK((size ? size->edge() : 0) == metres);
  }
  layout.edge = {0.5f, 0.7f, 1.2f};
  CHECK(open(bytes)->info().voxelSize->edges() == std::array<double, 3>{0.5e-6, 0.7e-6, 1.2e-6});
  layout.units = 0;
  CHECK(open(bytes)->info().proportions == std::array<double, 3>{0.5, 0.7, 1.2});
  layout.units = 3;
  layout.edge = {-3, 3, 3};  // a mirrored axis
  CHECK(open(bytes)->info().voxelSize->edge() == 3e-6);
  const auto refused = [&](const NiftiLayout& changed, const std::string& why) {
    writeFile(path, niftiFile(changed, bytes));
    INFO(why);
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains(why));
  };
  const auto with = [&](const auto& change) {
    NiftiLayout changed = layout;
    change(changed);
    return changed;
  };
  refused(with([](auto& l) { l.edge = {3, 3, 0}; }), "unusable");
  refused(with([](auto& l) { l.dim = {4, 5, 4, 3, 2}; }), "2 volumes");
  refused(with([](auto& l) { l.dim = {2, 5, 12}; }), "2 dimensions");
  refused(with([](auto& l) { l.dim = {3, 5, 4, -3}; }), "size");
  refused(with([](auto& l) { l.dim = {3, 5, 4, 4}; }), "160");
  refused(with([](auto& l) { l.type = 128; }), "data type 128");
  refused(with([](auto& l) { l.magic = "ni1"; }), "without data");
  for (const float offset : {0.f, 351.f, 352.5f, 1e9f, -1e30f})
    refused(with([&](auto& l) { l.statedOffset = offset; }), "begin at");
  layout.dim = {5, 5, 4, 3, 1, 1};
  CHECK(readAll(*open(bytes)) == bytes);
  layout.type = 1024;
  const std::string labels = randomSamples(SampleType::int32, voxels(kHeaderSize), 7);
  CHECK(readAll(*open(wide(labels, SampleType::int32)), 2) == labels);
  writeFile(path, deflated("something else that is compressed", 31));
  CHECK_THROWS_AS(openImage(path), IoError);
}

TEST_CASE("image_headers: DGtal's vol and longvol, versions 2 and 3", "[image_headers]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.vol";
  const std::string bytes = randomSamples(SampleType::uint8, voxels(kHeaderSize), 8);
  const std::string labels = randomSamples(SampleType::uint32, voxels(kHeaderSize), 9);
  for (const int version : {2, 3}) {
    CAPTURE(version);
    const auto coded = [&](const std::string& b) { return version == 3 ? deflated(b, 15) : b; };
    writeFile(path, dgtalHeader("Voxel-Size: 1", version) + coded(bytes));
    CHECK(openImage(path)->info().size == kHeaderSize);
    CHECK(openImage(path)->info().format == "vol");
    CHECK_FALSE(openImage(path)->info().voxelSize);
    CHECK(readAll(*openImage(path), 2) == bytes);
    writeFile(path,
              dgtalHeader("Lvoxel-Size: 4", version) + coded(wide(labels, SampleType::uint32)));
    CHECK(openImage(path)->info().type == SampleType::uint32);
    CHECK(openImage(path)->info().format == "longvol");
    CHECK(readAll(*openImage(path), 2) == labels);
  }
  writeFile(path, dgtalHeader("Lvoxel-Size: 4", 2) + labels);  // of 32 bits
  CHECK(readAll(*openImage(path)) == labels);
  const auto refused = [&](const std::string& file, const std::string& why) {
    writeFile(path, file);
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains(why));
  };
  const std::string header = dgtalHeader("Voxel-Size: 1", 2);
  refused(header + bytes + "x", "61 bytes");
  refused(header + bytes.substr(1), "59 bytes");
  refused(dgtalHeader("Voxel-Size: 2", 2) + bytes + bytes, "2 bytes");
  refused(dgtalHeader("Voxel-Size: 1", 4) + bytes, "version 4");
  refused(dgtalHeader("Voxel-Size: 1", 0) + bytes, "version 1");
  refused("X: 5\nY: 4\nVoxel-Size: 1\nVersion: 2\n.\n" + bytes, "lacks Z");
  refused("X: 5\nY: 4\nZ: 3 3\nVoxel-Size: 1\nVersion: 2\n.\n" + bytes, "Z");
  refused("X: 5\nY: 4\nZ: 3\nVoxel-Size: 1\nVersion: 2\n" + bytes, "");
  refused("X: 5\nnothing\nZ: 3\nVoxel-Size: 1\nVersion: 2\n.\n" + bytes, "'nothing'");
}

TEST_CASE("image_headers: PyHST's vol with its info file", "[image_headers]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.vol", infoPath = folder / "a.vol.info";
  const std::string size = "! PyHST_SLAVE VOLUME INFO FILE\nNUM_X =  5\nNUM_Y = 4\nNUM_Z = 3\n";
  for (const SampleType type : {SampleType::uint8, SampleType::uint16, SampleType::float32}) {
    const std::string bytes = randomSamples(type, voxels(kHeaderSize), 10);
    for (const bool bigEndian : {false, true}) {
      CAPTURE(sampleTypeName(type), bigEndian);
      writeFile(path, bigEndian ? swapped(bytes, sampleSize(type)) : bytes);
      writeFile(infoPath, size + "voxelSize = 8.5\nBYTEORDER = " +
                              (bigEndian ? "HIGHBYTEFIRST" : "LOWBYTEFIRST") +
                              "\nValMin = -1\nValMax = 2\n");
      for (const std::string& named : {path, infoPath}) {
        CHECK(looksLikeImage(named));
        const auto image = openImage(named);
        CHECK(image->info().size == kHeaderSize);
        CHECK(image->info().type == type);
        CHECK(image->info().format == "pyhst");
        CHECK(image->info().voxelSize->edge() == 8.5e-6);
        CHECK(readAll(*image, 2) == bytes);
        CHECK(std::count(image->files().begin(), image->files().end(), path) > 0);
        CHECK(std::count(image->files().begin(), image->files().end(), infoPath) > 0);
      }
    }
  }
  const std::string bytes = randomSamples(SampleType::int32, voxels(kHeaderSize), 11);
  writeFile(path, bytes);
  writeFile(infoPath, size + "DATA_TYPE = int32\n");
  CHECK(openImage(path)->info().type == SampleType::int32);
  CHECK_FALSE(openImage(path)->info().voxelSize);
  const auto refused = [&](const std::string& header, const std::string& why) {
    writeFile(infoPath, header);
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains(why));
  };
  refused(size + "DATA_TYPE = float16\n", "float16");
  refused(size + "DATA_TYPE = int16\n", "240");
  refused(size + "voxelSize = much\n", "much");
  refused(size + "voxelSize = -3\n", "spacing");
  refused(size + "BYTEORDER = ANY\n", "ANY");
  refused(size + "words\n", "words");
  refused("! PyHST\nNUM_X = 5\nNUM_Y = 4\n", "NUM_Z");
  refused("! PyHST\nNUM_X = 5\nNUM_Y = 4\nNUM_Z = 2\n", "240");
  refused("! PyHST\nNUM_X = 5\nNUM_Y = 4\nNUM_Z = 3e9\n", "NUM_Z");
  refused(size + std::string(20000, ' '), "too long");
  std::filesystem::remove(infoPath);
  CHECK_THROWS_WITH(openImage(path), Contains("a.vol.info"));
}
