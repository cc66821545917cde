// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>

#include "support/files.h"
#include "support/full_disk.h"
#include "support/image_damage.h"
#include "support/images.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

#ifndef VDB_MADF_HDF5

TEST_CASE("image_hdf5: a build without the library says so", "[image_hdf5]") {
  WARN("SKIPPED: reading HDF5: built without libhdf5-dev");
  const ScratchFolder folder;
  writeFile(folder / "a.dat", "\x89HDF\r\n\x1a\n" + std::string(100, 'a'));
  CHECK_THROWS_WITH(openImage(folder / "a.dat"), Contains("a.dat") && Contains("libhdf5"));
  ImageInfo info;
  info.size = ImageSize{2, 2, 2};
  CHECK_THROWS_WITH(createImage(folder / "b.h5", info), Contains("b.h5") && Contains("libhdf5"));
  CHECK_THROWS_AS(checkImagePlace(folder / "b.h5"), IoError);
  CHECK(folder.fileCount() == 1);
}

#else

#include "support/catch.h"
#include "support/hdf5_files.h"

namespace {

const ImageSize kHdf5Size{11, 7, 9};
const std::vector<hsize_t> kHdf5Shape{9, 7, 11};

struct Types {
  hid_t little, big, memory;
};

Types typesOf(SampleType type) {
  switch (type) {
    case SampleType::uint8:
      return {H5T_STD_U8LE, H5T_STD_U8BE, H5T_NATIVE_UINT8};
    case SampleType::int8:
      return {H5T_STD_I8LE, H5T_STD_I8BE, H5T_NATIVE_INT8};
    case SampleType::uint16:
      return {H5T_STD_U16LE, H5T_STD_U16BE, H5T_NATIVE_UINT16};
    case SampleType::int16:
      return {H5T_STD_I16LE, H5T_STD_I16BE, H5T_NATIVE_INT16};
    case SampleType::uint32:
      return {H5T_STD_U32LE, H5T_STD_U32BE, H5T_NATIVE_UINT32};
    case SampleType::int32:
      return {H5T_STD_I32LE, H5T_STD_I32BE, H5T_NATIVE_INT32};
    case SampleType::float32:
      return {H5T_IEEE_F32LE, H5T_IEEE_F32BE, H5T_NATIVE_FLOAT};
    case SampleType::float64:
      break;
  }
  return {H5T_IEEE_F64LE, H5T_IEEE_F64BE, H5T_NATIVE_DOUBLE};
}

void writeHdf5(const std::string& path, const std::string& name, const Hdf5Layout& layout,
               const void* samples) {
  const hid_t file = newHdf5(path);
  addHdf5(file, name, layout, samples);
  H5Fclose(file);
}

}  // namespace

TEST_CASE("image_hdf5: every type, byte order and layout", "[image_hdf5]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.h5";
  for (const SampleType type : kSampleTypes)
    for (const bool bigEndian : {false, true})
      for (const int kind : {0, 1, 2, 3}) {
        CAPTURE(sampleTypeName(type), bigEndian, kind);
        const std::string bytes = randomSamples(type, voxels(kHdf5Size), 1);
        const Types types = typesOf(type);
        Hdf5Layout layout{kHdf5Shape,   {}, bigEndian ? types.big : types.little,
                          types.memory, 0,  {}};
        if (kind > 0) layout.chunk = {5, 3, 4};
        if (kind > 1) layout.deflate = 3;
        if (kind > 2) {
          layout.shape.insert(layout.shape.begin(), 2, 1);
          layout.chunk.insert(layout.chunk.begin(), 2, 1);
        }
        writeHdf5(path, "entry/data/volume", layout, bytes.data());
        CHECK(looksLikeImage(path));
        const auto image = openImage(path);
        CHECK(image->info().size == kHdf5Size);
        CHECK(image->info().type == type);
        CHECK(image->info().format == "hdf5");
        CHECK_FALSE(image->info().voxelSize);
        for (const int step : {1, 2, 8, 100}) CHECK(readAll(*image, step) == bytes);
        CHECK(readAll(*openImage(path, {}, "/entry/data/volume")) == bytes);
      }
}

TEST_CASE("image_hdf5: half floats are floats", "[image_hdf5]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.h5";
  const hid_t half = H5Tcopy(H5T_IEEE_F32LE);
  H5Tset_fields(half, 15, 10, 5, 0, 10);
  H5Tset_size(half, 2);
  H5Tset_ebias(half, 15);
  std::vector<float> values;
  for (size_t i = 0; i < voxels(kHdf5Size); ++i) values.push_back(float(i) / 4 - 50);
  writeHdf5(path, "x", {kHdf5Shape, {}, half, H5T_NATIVE_FLOAT, 0, {}}, values.data());
  H5Tclose(half);
  const auto image = openImage(path);
  CHECK(image->info().type == SampleType::float32);
  const std::string bytes = readAll(*image, 2);
  REQUIRE(bytes.size() == 4 * values.size());
  CHECK(std::memcmp(bytes.data(), values.data(), bytes.size()) == 0);
}

TEST_CASE("image_hdf5: axes that are called otherwise than z, y, x are refused", "[image_hdf5]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.h5";
  const std::string bytes = randomSamples(SampleType::uint8, voxels(kHdf5Size), 1);
  for (const auto& [axes, isFine] :
       {std::pair<std::array<const char*, 3>, bool>{{"z", "y", "x"}, true},
        {{"x", "y", "z"}, false},
        {{nullptr, nullptr, "time"}, true},
        {{"Y", nullptr, nullptr}, false}}) {
    const hid_t file = newHdf5(path);
    addHdf5(file, "d", {kHdf5Shape, {}, H5T_STD_U8LE, H5T_NATIVE_UINT8, 0, {}}, bytes.data());
    const hid_t dataset = H5Dopen2(file, "d", H5P_DEFAULT), text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, H5T_VARIABLE);
    const hsize_t count = 3;
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t labels =
        H5Acreate2(dataset, "DIMENSION_LABELS", text, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(labels, text, axes.data());
    H5Aclose(labels);
    H5Sclose(space);
    H5Tclose(text);
    H5Dclose(dataset);
    H5Fclose(file);
    if (isFine)
      CHECK(readAll(*openImage(path)) == bytes);
    else
      CHECK_THROWS_WITH(openImage(path), Contains("its axes are called"));
  }
}

TEST_CASE("image_hdf5: 64-bit labels and h5py's bool", "[image_hdf5]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.h5";
  std::vector<int64_t> labels;
  for (int i = 0; i < int(voxels(kHdf5Size)); ++i) labels.push_back(i % 7 ? i * 1000003 : -i);
  const Hdf5Layout wide{kHdf5Shape, {}, H5T_STD_I64BE, H5T_NATIVE_INT64, 0, {}};
  writeHdf5(path, "labels", wide, labels.data());
  CHECK(openImage(path)->info().type == SampleType::int32);
  const std::string bytes = readAll(*openImage(path), 2);
  for (size_t i = 0; i < labels.size(); ++i) {
    int32_t label;
    std::memcpy(&label, &bytes[4 * i], 4);
    REQUIRE(label == labels[i]);
  }
  labels[400] = int64_t(1) << 33;
  writeHdf5(path, "labels", wide, labels.data());
  CHECK_THROWS_WITH(readAll(*openImage(path)), Contains(path) && Contains("beyond 32 bits"));

  const hid_t flag = H5Tenum_create(H5T_NATIVE_INT8);
  for (const int8_t value : {0, 1}) H5Tenum_insert(flag, value ? "TRUE" : "FALSE", &value);
  std::string flags;
  for (size_t i = 0; i < voxels(kHdf5Size); ++i) flags += char(i % 3 == 0);
  writeHdf5(path, "mask", {kHdf5Shape, {}, flag, flag, 0, {}}, flags.data());
  CHECK(openImage(path)->info().type == SampleType::int8);
  CHECK(readAll(*openImage(path), 2) == flags);
  H5Tclose(flag);
}

TEST_CASE("image_hdf5: the dataset is the only volume, or is named", "[image_hdf5]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.h5";
  const std::string bytes = randomSamples(SampleType::uint8, voxels(kHdf5Size), 2);
  const Hdf5Layout volume{kHdf5Shape, {}, H5T_STD_U8LE, H5T_NATIVE_UINT8, 0, {8.5, 8.5, 8.5}};
  hid_t file = newHdf5(path);
  addHdf5(file, "g/curve", {{693}, {}, H5T_STD_U8LE, H5T_NATIVE_UINT8, 0, {}}, bytes.data());
  addHdf5(file, "g/v", volume, bytes.data());
  H5Fclose(file);
  CHECK(readAll(*openImage(path)) == bytes);
  CHECK(openImage(path)->info().voxelSize->edge() == 8.5e-6);
  CHECK_THROWS_WITH(openImage(path, {}, "g/curve"), Contains(path) && Contains("1 dimensions"));
  CHECK_THROWS_WITH(openImage(path, {}, "g/w"), Contains(path) && Contains("'g/w'"));
  CHECK_THROWS_WITH(openImage(path, {}, "g"), Contains(path) && Contains("'g'"));

  file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  addHdf5(file, "second", volume, bytes.data());
  H5Fclose(file);
  CHECK_THROWS_WITH(openImage(path),
                    Contains("choose one of its datasets") && Contains("'g/v', 'second'"));
  // (The hint comes from another process.)
  CHECK_THROWS_MATCHES(openImage(path), IoError,
                       vdb_madf::test::Predicate<IoError>(
                           [](const IoError& error) { return error.hint() == Hint::dataset; }));
  CHECK(readAll(*openImage(path, {}, "second")) == bytes);

  const auto refused = [&](const Hdf5Layout& layout, const std::string& why, const void* samples) {
    writeHdf5(path, "d", layout, samples);
    CHECK_THROWS_WITH(openImage(path, {}, "d"), Contains(path) && Contains(why));
  };
  Hdf5Layout other = volume;
  other.elementSize = {9, 1.2, 8.5};  // z, y, x
  writeHdf5(path, "d", other, bytes.data());
  CHECK(openImage(path, {}, "d")->info().voxelSize->edges() ==
        std::array<double, 3>{8.5e-6, 1.2e-6, 9e-6});
  other.elementSize = {8.5};
  refused(other, "element_size_um", bytes.data());
  other = volume;
  other.shape = {3, 3, 7, 11};
  refused(other, "3 volumes", bytes.data());
  other.shape = {1 << 20, 1 << 20, 1 << 20};
  other.chunk = {1, 1, 16};
  refused(other, "too few", nullptr);
  other = volume;
  other.type = other.memory = H5T_C_S1;
  refused(other, "no integers", bytes.data());
  writeHdf5(path, "curve", {{693}, {}, H5T_STD_U8LE, H5T_NATIVE_UINT8, 0, {}}, bytes.data());
  CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains("no dataset"));
}

TEST_CASE("image_hdf5: several links to one dataset count once", "[image_hdf5]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.h5";
  const std::string bytes = randomSamples(SampleType::uint8, voxels(kHdf5Size), 4);
  const Hdf5Layout volume{kHdf5Shape, {}, H5T_STD_U8LE, H5T_NATIVE_UINT8, 0, {}};
  const auto write = [&](double x, double y, const std::string& unit) {
    const hid_t file = newHdf5(path);
    addHdf5(file, "entry/instrument/detector/data", volume, bytes.data());
    addHdf5(file, "entry/data/other", {{2}, {}, H5T_STD_U8LE, H5T_NATIVE_UINT8, 0, {}}, "ab");
    H5Lcreate_soft("/entry/instrument/detector/data", file, "entry/data/data", H5P_DEFAULT,
                   H5P_DEFAULT);
    H5Lcreate_hard(file, "entry/instrument/detector/data", file, "entry/data/again", H5P_DEFAULT,
                   H5P_DEFAULT);
    addHdf5Length(file, "entry/instrument/detector/x_pixel_size", x, unit);
    addHdf5Length(file, "entry/instrument/detector/y_pixel_size", y, unit);
    H5Fclose(file);
  };
  write(2.5, 2.5, "um");
  CHECK(readAll(*openImage(path)) == bytes);
  // NeXus' size of a pixel is that of the detector, by whatever name its data are read.
  for (const std::string name : {"", "entry/data/data", "/entry/instrument/detector/data"})
    CHECK(openImage(path, {}, name)->info().voxelSize->edge() == 2.5e-6);
  write(2.5, 2.5, "");
  CHECK_FALSE(openImage(path)->info().voxelSize);
  write(2.5, 5, "mm");
  CHECK(openImage(path)->info().voxelSize->edges() == std::array<double, 3>{2.5e-3, 5e-3, 2.5e-3});
}

TEST_CASE("image_hdf5: samples in other files are read, or said to be missing", "[image_hdf5]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.h5", part = folder / "part.h5";
  const std::string bytes = randomSamples(SampleType::uint8, voxels(kHdf5Size), 5);
  const Hdf5Layout volume{kHdf5Shape, {}, H5T_STD_U8LE, H5T_NATIVE_UINT8, 0, {}};
  writeHdf5(part, "g/v", volume, bytes.data());

  hid_t file = newHdf5(path);
  H5Lcreate_external("part.h5", "g/v", file, "linked", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(file);
  auto image = openImage(path);
  CHECK(readAll(*image) == bytes);
  CHECK(std::count(image->files().begin(), image->files().end(), part) == 1);
  image.reset();  // it locks its files
  file = newHdf5(path);
  H5Lcreate_external("part.h5", "g", file, "group", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(file);
  CHECK(readAll(*openImage(path, {}, "group/v")) == bytes);
  CHECK_THROWS_WITH(openImage(path), Contains("'group' is a group of another file"));
  file = newHdf5(path);
  H5Lcreate_external("none.h5", "g/v", file, "linked", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(file);
  for (const std::string name : {"", "linked"})
    CHECK_THROWS_WITH(openImage(path, {}, name),
                      Contains("'linked' is a link to another file, 'none.h5'"));

  // Two halves along z, of two files.
  const size_t half = 4 * 7 * 11;
  const auto piece = [&](const std::string& name, hsize_t slices, const std::string& samples) {
    writeHdf5(folder / name, "d",
              {{slices, 7, 11}, {3, 4, 5}, H5T_STD_U8LE, H5T_NATIVE_UINT8, 3, {}}, samples.data());
  };
  const auto virtualOf = [&](const std::string& first, const std::string& second) {
    file = newHdf5(path);
    addVirtualHdf5(file, "v", kHdf5Shape, {{first, 0, 4}, {second, 4, 5}});
    H5Fclose(file);
    return readAll(*openImage(path), 2);
  };
  piece("first.h5", 4, bytes.substr(0, half));
  piece("second.h5", 5, bytes.substr(half));
  CHECK(virtualOf("first.h5", "second.h5") == bytes);
  image = openImage(path);
  for (const std::string name : {"first.h5", "second.h5"})
    CHECK(std::count(image->files().begin(), image->files().end(), folder / name) == 1);
  image.reset();
  CHECK_THROWS_WITH(virtualOf("first.h5", "none.h5"), Contains("virtual") && Contains("none.h5"));
  CHECK_THROWS_WITH(virtualOf("first.h5", "part.h5"), Contains("'d' of the file 'part.h5'"));
  CHECK_THROWS_WITH(virtualOf("first.h5", "first.h5"), Contains("of another size"));
  CHECK_THROWS_WITH(virtualOf("first.h5", "a%%b.h5"), Contains("any number of files"));
  writeFile(folder / "text.h5", "no HDF5");
  CHECK_THROWS_WITH(virtualOf("first.h5", "text.h5"), Contains("text.h5") && Contains("damaged"));

  file = newHdf5(path);
  addHdf5External(file, "d", kHdf5Shape, "samples.bin");
  H5Fclose(file);
  CHECK_THROWS_WITH(openImage(path), Contains("raw files") && Contains("h5repack"));
}

TEST_CASE("image_hdf5: a file is written in compressed chunks, however slices come",
          "[image_hdf5]") {
  const ScratchFolder folder;
  ImageInfo info;
  info.size = ImageSize{150, 131, 21};
  info.type = SampleType::int32;
  info.voxelSize = VoxelSize({0.5e-6, 0.7e-6, 1.2e-6});
  std::string bytes(voxels(info.size) * 4, '\0');
  for (size_t i = 0; i < bytes.size(); i += 4) bytes[i] = char(i / 4096);
  const size_t slice = bytes.size() / 21;
  const auto write = [&](const std::string& name, int step) {
    const auto writer = createImage(folder / name, info);
    for (int z = 0; z < 21; z += step)
      writer->write(std::min(step, 21 - z), bytes.data() + slice * size_t(z));
    writer->finish();
    return readFile(folder / name);
  };
  const std::string whole = write("a.h5", 8);
  CHECK(whole.size() < bytes.size() / 20);
  for (const int step : {1, 5, 8, 21}) CHECK(write("b.h5", step) == whole);
  const auto image = openImage(folder / "a.h5", {}, "data");
  CHECK(readAll(*image, 4) == bytes);
  CHECK(image->info().voxelSize->edges() == info.voxelSize->edges());

  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
              dataset = H5Dopen2(file, "data", H5P_DEFAULT),
              attribute = H5Aopen(dataset, "element_size_um", H5P_DEFAULT),
              creation = H5Dget_create_plist(dataset);
  double edges[3];
  H5Aread(attribute, H5T_NATIVE_DOUBLE, edges);
  CHECK((edges[0] == 1.2 && edges[1] == 0.7 && edges[2] == 0.5));
  hsize_t chunk[3];
#if H5_VERSION_GE(1, 12, 0)
  H5O_info2_t times;
  H5Oget_info3(dataset, &times, H5O_INFO_TIME);
#else
  H5O_info_t times;
  H5Oget_info2(dataset, &times, H5O_INFO_TIME);
#endif
  CHECK(times.ctime == 0);  // or the same samples had other bytes a second later
  CHECK(H5Pget_chunk(creation, 3, chunk) == 3);
  CHECK((chunk[0] == 8 && chunk[1] == 128 && chunk[2] == 128));
  H5Pclose(creation);
  H5Aclose(attribute);
  H5Dclose(dataset);
  H5Fclose(file);
}

TEST_CASE("image_hdf5: on a full disk nothing is left, and later files are whole", "[image_hdf5]") {
  const ScratchFolder folder, other;
  ImageInfo info;
  info.size = ImageSize{100, 100, 40};
  const std::string bytes = randomSamples(info.type, voxels(info.size), 1);
  const auto write = [&] {
    const auto writer = createImage(folder / "a.h5", info);
    writer->write(40, bytes.data());
    writer->finish();
  };
  write();
  const size_t size = readFile(folder / "a.h5").size();
  std::filesystem::remove(folder / "a.h5");
  for (const size_t room : {size_t(0), size_t(100), size_t(5000), size / 2, size - 1}) {
    CAPTURE(room);
    {
      const FullDisk disk(room);
      CapturedStderr output(other / "stderr");
      CHECK_THROWS_WITH(write(), Contains("cannot write") && Contains("a.h5"));
      CHECK(output.text() == "");
    }
    CHECK(folder.fileCount() == 0);
  }
  write();
  CHECK(readAll(*openImage(folder / "a.h5")) == bytes);
}

TEST_CASE("image_hdf5: damaged files read or are refused with one line", "[image_hdf5]") {
  const ScratchFolder folder;
  const ScratchFolder other;
  CapturedStderr output(other / "stderr");
  const std::string path = folder / "a.h5";
  const std::string bytes = randomSamples(SampleType::uint16, voxels(kHdf5Size), 3);
  unsigned seed = 1;
  for (const bool chunked : {false, true}) {
    Hdf5Layout layout{kHdf5Shape, {}, H5T_STD_U16BE, H5T_NATIVE_UINT16, 0, {2, 2, 2}};
    if (chunked) {
      layout.chunk = {5, 3, 4};
      layout.deflate = 1;
    }
    writeHdf5(path, "v", layout, bytes.data());
    const std::string whole = readFile(path);
    const MemoryLimit limit(uint64_t(512) << 20);
    // A process is made for each, which takes most of the time.
    for (int i = 0; i < mutationsPerFormat(600) / 2; ++i) {
      overwriteFile(path, mutated(whole, whole.size(), ++seed));
      CAPTURE(chunked, seed);
      REQUIRE(complaint(path, 2 * whole.size(), 1 << 16) == "");
    }
    writeFile(path, whole);
    REQUIRE(complaintOfCuts(path, path, 2048, 1 << 16, 41) == "");
  }
  CHECK(output.text() == "");
}

#endif
