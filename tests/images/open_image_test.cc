// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/open_image.h"
#include "support/catch.h"
#include "support/files.h"
#include "support/images.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

const ImageSize kSmallSize{5, 4, 3};

std::string metaHeader(const std::string& type, const std::string& more,
                       const std::string& dataFile) {
  return "ObjectType = Image\nNDims = 3\nDimSize = 5 4 3\nElementType = " + type + "\n" + more +
         "ElementDataFile = " + dataFile + "\n";
}

std::string nrrdHeader(const std::string& type, const std::string& more) {
  return "NRRD0004\n# a comment\ntype: " + type + "\ndimension: 3\nsizes: 5 4 3\n" + more;
}

std::string samplesOf(const std::string& path) {
  return readAll(*openImage(path));
}

const char* metaName(SampleType type) {
  const char* names[] = {"MET_UCHAR", "MET_CHAR", "MET_USHORT", "MET_SHORT",
                         "MET_UINT",  "MET_INT",  "MET_FLOAT",  "MET_DOUBLE"};
  return names[size_t(type)];
}

const char* nrrdName(SampleType type) {
  const char* names[] = {"uchar",        "signed char", "unsigned short", "short",
                         "unsigned int", "int",         "float",          "double"};
  return names[size_t(type)];
}

/// And those of HDF5, where it was there when this was built.
std::vector<std::string> withHdf5(std::vector<std::string> endings, const std::string& ending) {
  if (readsHdf5())
    endings.push_back(ending);
  else
    WARN("SKIPPED: writing HDF5: built without libhdf5-dev");
  return endings;
}

}  // namespace

TEST_CASE("image_file: sample types have names and sizes", "[image_file]") {
  for (const SampleType type : kSampleTypes)
    CHECK(sampleTypeFromName(sampleTypeName(type)) == type);
  CHECK(sampleTypeName(SampleType::float32) == "float32");
  CHECK(sampleSize(SampleType::uint16) == 2);
  CHECK(sampleSize(SampleType::float64) == 8);
  CHECK_FALSE(sampleTypeFromName("uint7"));
}

TEST_CASE("image_file: what createImage writes, openImage reads", "[image_file]") {
  const ScratchFolder folder;
  const auto endings = withHdf5({"mhd", "raw", "mha", "tif", "TIFF", "nrrd", "npy"}, "h5");
  for (const std::string& ending : endings)
    for (const SampleType type : kSampleTypes)
      for (const ImageSize& size : {ImageSize{1, 1, 1}, kSmallSize, ImageSize{17, 1, 9}})
        for (const double metres : {0.0, 8.5e-6, 3.3e-8, 1.0 / 3e5, 0.05}) {
          if (metres > 0 && type != SampleType::uint16) continue;
          CAPTURE(ending, sampleTypeName(type), size, metres);
          const std::string path = folder / ("image." + ending);
          const std::string bytes = randomSamples(type, voxels(size), 1);
          ImageInfo info;
          info.size = size;
          info.type = type;
          if (metres > 0) info.voxelSize = VoxelSize{metres};
          const auto writer = createImage(path, info);
          const size_t slice = bytes.size() / size_t(size.z);
          writer->write(1, bytes.data());
          writer->write(size.z - 1, bytes.data() + slice);
          writer->finish();

          std::optional<RawLayout> raw;
          if (ending == "raw") raw = RawLayout{size, type, false};
          CHECK(looksLikeImage(path));
          const auto image = openImage(path, raw);
          CHECK(image->info().size == size);
          CHECK(image->info().type == type);
          CHECK(image->path() == path);
          CHECK(readAll(*image) == bytes);
          if (!raw && ending != "npy") {
            REQUIRE(bool(image->info().voxelSize) == (metres > 0));
            if (metres > 0) CHECK(image->info().voxelSize->edge() == metres);
          }
        }
  CHECK(folder.fileCount() == endings.size());  // the data of the .mhd are a .raw
}

TEST_CASE("image_file: unequal edges come back, to the last bit where they are decimals",
          "[image_file]") {
  const ScratchFolder folder;
  const std::string bytes = randomSamples(SampleType::uint8, voxels(kSmallSize), 1);
  ImageInfo info;
  info.size = kSmallSize;
  for (const std::string& ending : withHdf5({"mhd", "mha", "tif", "nrrd"}, "hdf5"))
    for (const std::array<double, 3>& edges : {std::array<double, 3>{0.5e-6, 0.5e-6, 1.2e-6},
                                               {1.2e-6, 0.7e-6, 0.5e-6},
                                               {33e-9, 33e-9, 5e-9},
                                               {123 / 1e6, 85.7 / 1e6, 3141.59 / 1e6},
                                               {0.05, 0.02, 0.3}}) {
      CAPTURE(ending, edges[0], edges[1], edges[2]);
      info.voxelSize = VoxelSize(edges);
      const auto writer = createImage(folder / ("a." + ending), info);
      writer->write(kSmallSize.z, bytes.data());
      writer->finish();
      CHECK(openImage(folder / ("a." + ending))->info().voxelSize->edges() == edges);
    }
}

TEST_CASE("image_file: a writer takes exactly its slices, or leaves nothing", "[image_file]") {
  const ScratchFolder folder;
  ImageInfo info;
  info.size = ImageSize{2, 2, 2};
  const std::string bytes(100, 'x');
  for (const std::string& ending :
       withHdf5({".raw", ".mhd", ".mha", ".tif", ".nrrd", ".npy"}, ".h5")) {
    {
      const auto writer = createImage(folder / ("a" + ending), info);
      writer->write(1, bytes.data());
      CHECK_THROWS_AS(writer->finish(), InvalidInput);
    }
    {
      const auto writer = createImage(folder / ("a" + ending), info);
      CHECK_THROWS_AS(writer->write(3, bytes.data()), InvalidInput);
    }
    CHECK(folder.fileCount() == 0);
    CHECK_THROWS_AS(createImage(folder / ("none/a" + ending), info), IoError);
    CHECK(isImageEnding("a" + ending));
  }
  CHECK_THROWS_AS(createImage(folder / "a.png", info), InvalidInput);
  CHECK_FALSE(isImageEnding("a.vdb"));
}

TEST_CASE("image_file: raw files in either byte order", "[image_file]") {
  const ScratchFolder folder;
  for (const SampleType type : kSampleTypes) {
    const std::string bytes = randomSamples(type, voxels(kSmallSize), 2);
    writeFile(folder / "a.bin", swapped(bytes, sampleSize(type)));
    const auto image = openImage(folder / "a.bin", RawLayout{kSmallSize, type, true});
    CHECK(readAll(*image, 2) == bytes);
    CHECK(image->info().format == "raw");
    CHECK_FALSE(image->info().voxelSize);
    std::string last(bytes.size() / 3, '\0');
    image->read(2, 1, last.data());  // any slice, also again
    CHECK(last == bytes.substr(2 * last.size()));
    CHECK_THROWS_AS(image->read(2, 2, last.data()), InvalidInput);
    CHECK_THROWS_AS(image->read(-1, 1, last.data()), InvalidInput);
  }
}

TEST_CASE("image_file: a raw file of the wrong size is refused with both numbers", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.raw";
  writeFile(path, std::string(120, '\0'));
  CHECK_THROWS_WITH(openImage(path, RawLayout{kSmallSize, SampleType::uint8, false}),
                    Contains(path) && Contains("120") && Contains("60") && Contains("2 bytes"));
  CHECK_THROWS_WITH(openImage(path, RawLayout{ImageSize{5, 5, 3}, SampleType::uint8, false}),
                    Contains("120") && Contains("75") && Contains("5 x 5 x 3"));
  CHECK_THROWS_AS(openImage(path, RawLayout{ImageSize{0, 5, 3}, SampleType::uint8, false}),
                  IoError);
  CHECK_THROWS_AS(
      openImage(path, RawLayout{ImageSize{1 << 20, 1 << 20, 1 << 20}, SampleType::float64, false}),
      IoError);
  CHECK_THROWS_WITH(openImage(path), Contains("size"));
}

TEST_CASE("image_file: MetaImage in all its forms", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.mhd";
  for (const SampleType type : kSampleTypes) {
    CAPTURE(sampleTypeName(type));
    const std::string bytes = randomSamples(type, voxels(kSmallSize), 3);
    const std::string foreign = swapped(bytes, sampleSize(type));
    const std::string name = metaName(type);

    writeFile(path, metaHeader(name, "", "LOCAL") + bytes);
    CHECK(samplesOf(path) == bytes);
    CHECK_FALSE(openImage(path)->info().voxelSize);
    writeFile(path, metaHeader(name, "ElementByteOrderMSB = True\n", "LOCAL") + foreign);
    CHECK(samplesOf(path) == bytes);
    writeFile(path, metaHeader(name, "BinaryDataByteOrderMSB = true\n", "b.zraw"));
    writeFile(folder / "b.zraw", foreign);
    CHECK(samplesOf(path) == bytes);
    writeFile(folder / "b.zraw", "12345" + foreign);
    CHECK_THROWS_WITH(samplesOf(path), Contains(path) && Contains("header"));
    writeFile(path, metaHeader(name, "BinaryDataByteOrderMSB = true\nHeaderSize = 5\n", "b.zraw"));
    CHECK(samplesOf(path) == bytes);
    writeFile(path, metaHeader(name, "BinaryDataByteOrderMSB = true\nHeaderSize = -1\n", "b.zraw"));
    CHECK(samplesOf(path) == bytes);
    writeFile(path, metaHeader(name, "CompressedData = True\n", "LOCAL") + deflated(bytes, 15));
    CHECK(samplesOf(path) == bytes);
    writeFile(path,
              metaHeader(name, "CompressedData = True\n", "LOCAL") + deflated(bytes + "x", 15));
    CHECK_THROWS_WITH(samplesOf(path), Contains("more data"));
  }
}

TEST_CASE("image_file: MetaImage spacing is millimeters unless it is 1", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.mha";
  const auto spacing = [&](const std::string& line) {
    writeFile(path, metaHeader("MET_UCHAR", line + "\n", "LOCAL") + std::string(60, 'a'));
    return openImage(path)->info().voxelSize;
  };
  CHECK(spacing("ElementSpacing = 0.0085 0.0085 0.0085")->edge() == 8.5e-6);
  CHECK(spacing("ElementSize = 2 2 2")->edge() == 2e-3);
  CHECK(spacing("ElementSpacing = 0.01 0.010005 0.01")->edge() == 1e-5);
  CHECK_FALSE(spacing("ElementSpacing = 1 1.0 1"));
  CHECK(spacing("ElementSpacing = 1 1 2")->edges() == std::array<double, 3>{1e-3, 1e-3, 2e-3});
  CHECK_THROWS_AS(spacing("ElementSpacing = 1 1 0"), IoError);
  CHECK_THROWS_AS(spacing("ElementSpacing = 0 0 0"), IoError);
  CHECK_THROWS_AS(spacing("ElementSpacing = nan nan nan"), IoError);
  CHECK_THROWS_AS(spacing("ElementSpacing = 1e-300 1e-300 1e-300"), IoError);
  CHECK_THROWS_AS(spacing("ElementSpacing = 1 1"), IoError);
  CHECK_THROWS_AS(spacing("ElementNumberOfChannels = 3"), IoError);
  CHECK_THROWS_AS(spacing("BinaryData = False"), IoError);
  CHECK_THROWS_AS(spacing("NDims = 2"), IoError);
  CHECK_THROWS_AS(spacing("ElementType = MET_LONG"), IoError);
  CHECK_THROWS_AS(spacing("DimSize = 5 4"), IoError);
  CHECK_THROWS_AS(spacing("DimSize = 1048576 1048576 1048576"), IoError);
  CHECK_THROWS_AS(spacing("DimSize = 5 4 18446744073709551617"), IoError);
  CHECK_THROWS_AS(spacing("no equals sign"), IoError);
}

TEST_CASE("image_file: MetaImage data that are elsewhere", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.mhd";
  for (const std::string name : {"missing.raw", "LIST", "slice%03d.raw 1 9 1"}) {
    writeFile(path, metaHeader("MET_UCHAR", "", name));
    CHECK_THROWS_WITH(openImage(path), Contains(path));
  }
}

TEST_CASE("image_file: NRRD in all its forms", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.nrrd", detached = folder / "a.nhdr";
  for (const SampleType type : kSampleTypes) {
    CAPTURE(sampleTypeName(type));
    const std::string bytes = randomSamples(type, voxels(kSmallSize), 4);
    const std::string foreign = swapped(bytes, sampleSize(type));
    const std::string name = nrrdName(type), little = "endian: little\n", big = "endian: big\n";

    writeFile(path, nrrdHeader(name, little + "encoding: raw\nkey:=value\n\n") + bytes);
    CHECK(samplesOf(path) == bytes);
    writeFile(path, nrrdHeader(name, big + "Encoding: RAW\r\n\r\n") + foreign);
    CHECK(samplesOf(path) == bytes);
    writeFile(path, nrrdHeader(name, big + "encoding: gzip\n\n") + deflated(foreign, 31));
    CHECK(samplesOf(path) == bytes);
    const size_t middle = bytes.size() / 2;
    writeFile(path, nrrdHeader(name, little + "encoding: gz\n\n") +
                        deflated(bytes.substr(0, middle), 31) + deflated(bytes.substr(middle), 31));
    CHECK(samplesOf(path) == bytes);

    writeFile(folder / "b.dat", "one\ntwo\n---" + bytes);
    writeFile(detached, nrrdHeader(name, little + "encoding: raw\nline skip: 2\nbyte skip: 3\n"
                                                  "data file: b.dat\n"));
    CHECK(samplesOf(detached) == bytes);
    writeFile(detached, nrrdHeader(name, little + "encoding: raw\nbyteskip: -1\n"
                                                  "datafile: b.dat\n"));
    CHECK(samplesOf(detached) == bytes);
    writeFile(folder / "b.dat", "one\n" + deflated("---" + bytes, 31));
    writeFile(detached, nrrdHeader(name, little + "encoding: gzip\nlineskip: 1\nbyte skip: 3\n"
                                                  "data file: b.dat\n"));
    const auto image = openImage(detached);
    CHECK(readAll(*image, 1) == bytes);
    CHECK(readAll(*image, 2) == bytes);  // from the start again
    CHECK(image->info().format == "nrrd");
  }
}

TEST_CASE("image_file: NRRD spacing needs a unit", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.nrrd";
  const auto spacing = [&](const std::string& lines) {
    writeFile(path, nrrdHeader("uchar", "encoding: raw\n" + lines + "\n\n") + std::string(60, 'a'));
    return openImage(path)->info().voxelSize;
  };
  CHECK_FALSE(spacing("spacings: 0.5 0.5 0.5"));
  CHECK_FALSE(spacing("spacings: nan nan nan"));
  CHECK(spacing("spacings: 8.5 8.5 8.5\nunits: \"um\" \"um\" \"um\"")->edge() == 8.5e-6);
  CHECK(spacing("space directions: (2,0,0) (0,-2,0) (0,0,2)\nspace units: \"mm\" \"mm\" \"mm\"")
            ->edge() == 2e-3);
  CHECK(spacing("space directions: (0,3,0) (0,0,3) (3,0,0)\nspace units: \"nm\" \"nm\" \"nm\"")
            ->edge() == 3e-9);
  CHECK(spacing("spacings: 0.5 1.2 3\nunits: \"um\" \"um\" \"um\"")->edges() ==
        std::array<double, 3>{0.5e-6, 1.2e-6, 3e-6});
  CHECK(spacing("space directions: (0,3,0) (0,0,4) (5,0,0)\nspace units: \"mm\" \"mm\" \"mm\"")
            ->edges() == std::array<double, 3>{3e-3, 4e-3, 5e-3});
  CHECK_FALSE(spacing("spacings: 1 1 2"));
  CHECK(openImage(path)->info().proportions == std::array<double, 3>{1, 1, 2});
  CHECK_FALSE(spacing("space directions: (3,0,0) (0,4,0) (0,0,5)"));
  CHECK(openImage(path)->info().proportions == std::array<double, 3>{3, 4, 5});
  CHECK_FALSE(spacing("spacings: 2 2 2"));
  CHECK_FALSE(openImage(path)->info().proportions);
  CHECK_THROWS_AS(spacing("spacings: 1 1 0"), IoError);
  CHECK_THROWS_AS(spacing("spacings: 1 1 inf"), IoError);
  CHECK_THROWS_AS(spacing("spacings: 1 1 -2"), IoError);
  CHECK_THROWS_AS(spacing("spacings: 1 1 1\nunits: \"mm\" \"mm\" \"um\""), IoError);
  CHECK_THROWS_AS(spacing("space directions: (1,0,0) (0.5,1,0) (0,0,1)"), IoError);
  CHECK_THROWS_AS(spacing("space directions: none (1,0,0) (0,1,0)"), IoError);
  CHECK_THROWS_AS(spacing("type: block"), IoError);
  CHECK_THROWS_AS(spacing("type: short"), IoError);  // no endian
  CHECK_THROWS_AS(spacing("encoding: bzip2"), IoError);
  CHECK_THROWS_AS(spacing("sizes: 5 4 3 1"), IoError);
  CHECK_THROWS_AS(spacing("data file: LIST"), IoError);
  CHECK_THROWS_AS(spacing("byte skip: -2"), IoError);
  CHECK_THROWS_AS(spacing("byte skip: 9223372036854775807"), IoError);
  CHECK_THROWS_AS(spacing("line skip: 9"), IoError);
}

TEST_CASE("image_file: content goes before the ending", "[image_file]") {
  const ScratchFolder folder;
  const std::string bytes = randomSamples(SampleType::uint8, voxels(kSmallSize), 5);
  writeFile(folder / "a.dat", nrrdHeader("uchar", "encoding: raw\n\n") + bytes);
  writeFile(folder / "b.tif", "Comment = x\n" + metaHeader("MET_UCHAR", "", "LOCAL") + bytes);
  writeTiff(folder / "c.nrrd", kSmallSize, SampleType::uint8, bytes);
  for (const std::string name : {"a.dat", "b.tif", "c.nrrd"}) {
    CHECK(looksLikeImage(folder / name));
    CHECK(samplesOf(folder / name) == bytes);
  }
  writeFile(folder / "d.tif", std::string(" BDV\0\0\0\0\0\0", 10));
  writeFile(folder / "e.txt", "words");
  writeFile(folder / "f.raw", "123");
  CHECK_FALSE(looksLikeImage(folder / "d.tif"));
  CHECK_FALSE(looksLikeImage(folder / "e.txt"));
  CHECK_FALSE(looksLikeImage(folder / "none.vdb"));
  CHECK(looksLikeImage(folder.path()));
  CHECK(looksLikeImage(folder / "f.raw"));
  CHECK(looksLikeImage("missing.tiff"));
  CHECK_THROWS_WITH(openImage(folder / "d.tif"), Contains("VDB"));
  CHECK_THROWS_WITH(openImage(folder / "e.txt"), Contains("e.txt"));
}
