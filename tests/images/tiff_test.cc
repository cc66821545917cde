// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/catch.h"
#include "support/files.h"
#include "support/images.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

const ImageSize kTiffSize{21, 18, 3};

/// Pages of fewer or other pixels after those that are there.
void appendPages(const std::string& path, const ImageSize& size, SampleType type) {
  TiffLayout layout;
  layout.mode = "a";
  writeTiff(path, size, type, randomSamples(type, voxels(size), 9), layout);
}

/// Bits of rows, padded to bytes, as a byte each.
std::string expanded(const std::string& packed, const ImageSize& size) {
  const size_t row = size_t(size.x + 7) / 8;
  std::string bytes;
  for (size_t r = 0; r < size_t(size.y * size.z); ++r)
    for (size_t x = 0; x < size_t(size.x); ++x) {
      const bool bit =
          (static_cast<unsigned char>(packed[r * row + x / 8]) >> (7 - x % 8) & 1) != 0;
      bytes.push_back(char(bit));
    }
  return bytes;
}

}  // namespace

TEST_CASE("image_file: TIFF of every type, byte order, compression and layout", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.tif";
  for (const SampleType type : kSampleTypes)
    for (const std::string mode : {"wl", "wb", "wl8", "wb8"})
      for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                                    COMPRESSION_DEFLATE, COMPRESSION_PACKBITS})
        for (const uint32_t rows : {1u, 5u, 18u, 1000u})
          for (const uint32_t tile : {0u, 16u}) {
            if (tile && rows > 1) continue;
            CAPTURE(sampleTypeName(type), mode, compression, rows, tile);
            TiffLayout layout;
            layout.mode = mode;
            layout.compression = compression;
            layout.rowsPerStrip = rows;
            layout.tile = tile;
            if (type == SampleType::uint16 && compression == COMPRESSION_LZW) layout.predictor = 2;
            const std::string bytes = randomSamples(type, voxels(kTiffSize), 6);
            writeTiff(path, kTiffSize, type, bytes, layout);
            const auto image = openImage(path);
            REQUIRE(image->info().size == kTiffSize);
            REQUIRE(image->info().type == type);
            REQUIRE(image->info().format == "tiff");
            REQUIRE(readAll(*image) == bytes);
            REQUIRE(readAll(*image, 2) == bytes);
          }
}

TEST_CASE("image_file: of 1-bit TIFF the stored bit counts, be it black or white", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.tif";
  const size_t row = size_t(kTiffSize.x + 7) / 8;
  std::string packed = randomSamples(SampleType::uint8, row * size_t(kTiffSize.y * kTiffSize.z), 7);
  for (size_t i = row - 1; i < packed.size(); i += row) packed[i] = char(packed[i] & 0xf8);
  for (const int compression :
       {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS,
        COMPRESSION_CCITTRLE, COMPRESSION_CCITTFAX3, COMPRESSION_CCITTFAX4})
    for (const int photometric : {PHOTOMETRIC_MINISBLACK, PHOTOMETRIC_MINISWHITE})
      for (const uint32_t rows : {1u, 7u, 18u}) {
        CAPTURE(compression, photometric, rows);
        TiffLayout layout;
        layout.bits = 1;
        layout.compression = compression;
        layout.photometric = photometric;
        layout.rowsPerStrip = rows;
        writeTiff(path, kTiffSize, SampleType::uint8, packed, layout);
        const auto image = openImage(path);
        REQUIRE(image->info().type == SampleType::uint8);
        REQUIRE(readAll(*image) == expanded(packed, kTiffSize));
        CHECK(image->notes().size() == (photometric == PHOTOMETRIC_MINISWHITE ? 1u : 0u));
      }
}

TEST_CASE("image_file: of wider TIFF samples the stored value counts", "[image_file]") {
  const ScratchFolder folder;
  TiffLayout layout;
  layout.photometric = PHOTOMETRIC_MINISWHITE;
  const std::string bytes = randomSamples(SampleType::uint8, voxels(kTiffSize), 8);
  writeTiff(folder / "a.tif", kTiffSize, SampleType::uint8, bytes, layout);
  const auto image = openImage(folder / "a.tif");
  CHECK(readAll(*image) == bytes);
  REQUIRE(image->notes().size() == 1);
  CHECK_THAT(image->notes()[0], Contains(folder / "a.tif") && Contains("0 is white in it"));
}

TEST_CASE("image_file: a folder says which slices have another white, and which are missing",
          "[image_file]") {
  const ScratchFolder folder;
  const ImageSize slice{kTiffSize.x, kTiffSize.y, 1};
  for (const int z : {1, 2, 3, 5}) {
    TiffLayout layout;
    if (z == 5) layout.photometric = PHOTOMETRIC_MINISWHITE;
    writeTiff(folder / ("s" + std::to_string(z) + ".tif"), slice, SampleType::uint8,
              std::string(voxels(slice), char(z)), layout);
  }
  const auto notes = openImage(folder.path())->notes();
  REQUIRE(notes.size() == 2);
  CHECK_THAT(notes[0], Contains(folder.path()) && Contains("s3.tif and s5.tif"));
  CHECK_THAT(notes[1], Contains(folder.path()) && Contains("1 of its 4 slices"));
}

TEST_CASE("image_file: colors of a TIFF are read when they are gray, else refused",
          "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.tif";
  for (const SampleType type : {SampleType::uint8, SampleType::uint16, SampleType::float32})
    for (const int channels : {3, 4})
      for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW})
        for (const uint32_t tile : {0u, 16u})
          for (const std::string mode : {"wl", "wb"}) {
            CAPTURE(sampleTypeName(type), channels, compression, tile, mode);
            const std::string gray = randomSamples(type, voxels(kTiffSize), 11);
            const size_t bytes = sampleSize(type);
            std::string colors;
            for (size_t i = 0; i < gray.size(); i += bytes) {
              for (int channel = 0; channel < 3; ++channel) colors += gray.substr(i, bytes);
              if (channels == 4) colors += std::string(bytes, '\1');
            }
            TiffLayout layout;
            layout.mode = mode;
            layout.channels = channels;
            layout.photometric = PHOTOMETRIC_RGB;
            layout.compression = compression;
            layout.tile = tile;
            writeTiff(path, kTiffSize, type, colors, layout);
            CHECK(openImage(path)->info().type == type);
            CHECK(readAll(*openImage(path), 2) == gray);
            colors[bytes] = char(colors[bytes] ^ 1);
            writeTiff(path, kTiffSize, type, colors, layout);
            CHECK_THROWS_WITH(readAll(*openImage(path)), Contains(path) && Contains("colors"));
          }
}

TEST_CASE("image_file: TIFF that is not a gray volume is refused", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.tif";
  TiffLayout layout;
  layout.channels = 3;
  writeTiff(path, kTiffSize, SampleType::uint8, std::string(3 * voxels(kTiffSize), 'a'), layout);
  CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains("gray"));

  layout = {};
  layout.bits = 4;
  writeTiff(path, kTiffSize, SampleType::uint8, std::string(voxels(kTiffSize), 'a'), layout);
  CHECK_THROWS_WITH(openImage(path), Contains("4 bits"));
  layout.bits = 16;
  layout.format = SAMPLEFORMAT_IEEEFP;
  writeTiff(path, kTiffSize, SampleType::uint16, std::string(2 * voxels(kTiffSize), 'a'), layout);
  CHECK_THROWS_WITH(openImage(path), Contains("16 bits"));

  for (const ImageSize& other : {ImageSize{21, 17, 1}, ImageSize{20, 18, 1}}) {
    writeTiff(path, kTiffSize, SampleType::uint8, std::string(voxels(kTiffSize), 'a'));
    appendPages(path, other, SampleType::uint8);
    CHECK_THROWS_WITH(openImage(path), Contains("pages differ"));
  }
  writeTiff(path, kTiffSize, SampleType::uint8, std::string(voxels(kTiffSize), 'a'));
  appendPages(path, kTiffSize, SampleType::int8);
  CHECK_THROWS_WITH(openImage(path), Contains("pages differ") && Contains("int8"));
}

TEST_CASE("image_file: a folder of slices is read in natural order", "[image_file]") {
  const ScratchFolder folder;
  const ImageSize slice{kTiffSize.x, kTiffSize.y, 1};
  const std::string names[] = {"s2.tif", "s09.TIF", "s10.tiff", "s0100.tif"};
  std::string bytes;
  unsigned seed = 0;
  for (const std::string& name : names) {
    const std::string samples = randomSamples(SampleType::uint16, voxels(slice), ++seed);
    writeTiff(folder / name, slice, SampleType::uint16, samples);
    bytes += samples;
  }
  writeFile(folder / "notes.txt", "not a slice");
  writeFile(folder / "._s2.tif", "not a slice either");
  CHECK(looksLikeImage(folder.path()));
  const auto image = openImage(folder.path());
  CHECK(image->info().size == ImageSize{kTiffSize.x, kTiffSize.y, 4});
  CHECK(readAll(*image, 3) == bytes);

  writeTiff(folder / "s11.tif", slice, SampleType::uint8, std::string(voxels(slice), 'a'));
  CHECK_THROWS_WITH(openImage(folder.path()), Contains("s11.tif") && Contains("uint8"));
  writeTiff(folder / "s11.tif", kTiffSize, SampleType::uint16,
            std::string(2 * voxels(kTiffSize), 'a'));
  CHECK_THROWS_WITH(openImage(folder.path()), Contains("s11.tif") && Contains("several pages"));
  writeFile(folder / "s11.tif", "II");
  CHECK_THROWS_WITH(openImage(folder.path()), Contains("s11.tif"));
  const ScratchFolder empty;
  CHECK_FALSE(looksLikeImage(empty.path()));
  CHECK_THROWS_WITH(openImage(empty.path()), Contains(empty.path()));
}

TEST_CASE("image_file: TIFF voxel size as ImageJ writes it", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.tif";
  TiffLayout layout;
  const auto size = [&](const std::string& description, double resolution) {
    layout.description = description;
    layout.resolution = resolution;
    writeTiff(path, kTiffSize, SampleType::uint8, std::string(voxels(kTiffSize), 'a'), layout);
    return openImage(path)->info().voxelSize;
  };
  CHECK(size("ImageJ=1.52a\nslices=3\nunit=micron\nspacing=4.0\n", 0.25)->edge() == 4e-6);
  CHECK(size("ImageJ=1.52a\nunit=\\u00B5m\nspacing=4\n", 0.25)->edge() == 4e-6);
  CHECK(size("ImageJ=1.52a\nunit=\u00b5m\nspacing=-4\n", 0.25)->edge() == 4e-6);
  CHECK(size("ImageJ=1.52a\nunit=mm\n", 1)->edge() == 1e-3);
  CHECK_FALSE(size("ImageJ=1.52a\nunit=mm\n", 4));
  CHECK_FALSE(size("ImageJ=1.52a\nunit=pixel\nspacing=1\n", 1));
  CHECK_FALSE(size("ImageJ=1.52a\nspacing=4\n", 0.25));
  CHECK(size("ImageJ=1.52a\nunit=\\u03BCm\nspacing=4\n", 0.25)->edge() == 4e-6);
  CHECK_FALSE(size("unit=mm\nspacing=4\n", 0.25));
  CHECK_FALSE(size("", 72));
  CHECK(size("ImageJ=1.52a\nunit=mm\nspacing=4\n", 1)->edges() ==
        std::array<double, 3>{1e-3, 1e-3, 4e-3});
  CHECK(size("ImageJ=1.52a\nunit=mm\nspacing=-4\n", 1 / 1.2)->edges() ==
        std::array<double, 3>{1.2e-3, 1.2e-3, 4e-3});
  // Without a unit: the proportions, if the tags are said to have none, too.
  const auto proportions = [&](const std::string& text, double resolution, int unit) {
    layout.resolutionUnit = unit;
    size(text, resolution);
    return openImage(path)->info().proportions;
  };
  using Edges = std::array<double, 3>;
  for (const std::string unit : {"", "unit=pixel\n"})
    CHECK(proportions("ImageJ=1.52a\n" + unit + "spacing=3\n", 1, RESUNIT_NONE) == Edges{1, 1, 3});
  CHECK_FALSE(proportions("ImageJ=1.52a\nspacing=3\n", 72, RESUNIT_INCH));
  CHECK_FALSE(proportions("ImageJ=1.52a\n", 72, RESUNIT_NONE));
  for (const std::string spacing : {"1", "0", "nan"})
    CHECK_FALSE(proportions("ImageJ=1.52a\nspacing=" + spacing + "\n", 1, RESUNIT_NONE));
  CHECK_THROWS_WITH(size("ImageJ=1.52a\nchannels=3\n", 0), Contains("channels"));
}

TEST_CASE("image_file: TIFF voxel size as OME writes it", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.ome.tif";
  const auto open = [&](const std::string& description) {
    TiffLayout layout;
    layout.description = description;
    writeTiff(path, kTiffSize, SampleType::uint8, std::string(voxels(kTiffSize), 'a'), layout);
    return openImage(path)->info().voxelSize;
  };
  const auto size = [&](const std::string& attributes) {
    return open(
        "<?xml version=\"1.0\"?><OME xmlns=\"x\"><Image Name=\"PhysicalSizeX=1\"><Pixels "
        "SizeZ=\"3\" " +
        attributes + "><Channel/></Pixels></Image></OME>");
  };
  const std::string x = "PhysicalSizeX='8.5' ", y = "PhysicalSizeY=\"8.5\" ",
                    z = "PhysicalSizeZ = \"8.5\"";
  CHECK(size(x + y + z)->edge() == 8.5e-6);
  CHECK(size(x + y + "PhysicalSizeZ='8500' PhysicalSizeZUnit='nm'")->edge() == 8.5e-6);
  for (const std::string unit : {"\u00b5m", "\u03bcm", "&#181;m", "&#xB5;m", "um"}) {
    const auto of = [&](const std::string& axis) {
      return " PhysicalSize" + axis + "Unit='" + unit + "'";
    };
    CHECK(size(x + y + z + of("X") + of("Y") + of("Z"))->edge() == 8.5e-6);
  }
  CHECK(open("<ome:OME><ome:Image><ome:Pixels " + x + y + z + "/></ome:Image></ome:OME>")->edge() ==
        8.5e-6);
  CHECK_FALSE(size(""));
  CHECK_FALSE(size(x + y));
  CHECK_FALSE(size(x + y + z + " PhysicalSizeXUnit='pixel'"));
  CHECK_FALSE(size(x + y + z + " PhysicalSizeXUnit='reference frame' PhysicalSizeYUnit='pixel'"));
  CHECK_FALSE(open("<Pixels " + x + y + z + "/>"));  // not OME's
  CHECK(size(x + y + "PhysicalSizeZ='17'")->edges() ==
        std::array<double, 3>{8.5e-6, 8.5e-6, 17e-6});
  CHECK_THROWS_WITH(size(x + y + "PhysicalSizeZ='-8.5'"), Contains("unusable spacing"));
  CHECK_THROWS_WITH(size("SizeC='3'"), Contains("several channels"));
  CHECK_THROWS_WITH(size("SizeT='2'"), Contains("several times"));
  CHECK_THROWS_WITH(open("<OME><Pixels SizeZ='4'/></OME>"), Contains("3 of the 4 slices"));
  CHECK_THROWS_WITH(open("<OME><Pixels /><Pixels /></OME>"), Contains("several images"));
  const auto planes = [&](const std::string& data) {
    return open("<OME><Pixels SizeZ='3'>" + data + "</Pixels></OME>");
  };
  CHECK_NOTHROW(planes("<TiffData/>"));
  CHECK_NOTHROW(planes("<TiffData IFD='0' PlaneCount='3'/>"));
  CHECK_NOTHROW(planes("<TiffData FirstZ='0' IFD='0'/><TiffData IFD='2' FirstZ='2'/>"));
  for (const std::string other :
       {"<TiffData IFD='1' PlaneCount='2'/>", "<TiffData IFD='0'/><TiffData FirstZ='2' IFD='1'/>",
        "<TiffData IFD='?'/>"})
    CHECK_THROWS_WITH(planes(other), Contains("in another order than its pages"));
  open("<OME><Pixels SizeZ='2'/></OME>");
  CHECK_THAT(openImage(path)->notes().at(0), Contains("describes 2 slices, and it has 3"));
  // A text that ends anywhere is read as far as it goes.
  const std::string whole = "<OME><Pixels SizeZ=\"3\" " + x + y + z + "/></OME>";
  for (size_t length = 1; length < whole.size(); ++length)
    CHECK_NOTHROW(open(whole.substr(0, length)));
}

TEST_CASE("image_file: large stacks of ImageJ and truncated ones of tifffile have one page",
          "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.tif";
  const ImageSize slice{kTiffSize.x, kTiffSize.y, 1};
  const std::string bytes = randomSamples(SampleType::uint16, voxels(kTiffSize), 10);
  TiffLayout layout;
  layout.mode = "wb";
  layout.rowsPerStrip = 1000;
  const std::string shape = std::to_string(kTiffSize.z) + ", " + std::to_string(kTiffSize.y) +
                            ", " + std::to_string(kTiffSize.x);
  layout.description = GENERATE_COPY(std::string("ImageJ=1.52a\nimages=3\nslices=3\n"),
                                     "{\"truncated\": true, \"shape\": [" + shape + "]}");
  writeTiff(path, slice, SampleType::uint16, bytes.substr(0, bytes.size() / 3), layout);
  CHECK(openImage(path)->info().size.z == 1);  // one slice that kept its description

  // libtiff puts the samples first: move them to the end of the file, with all that belongs there.
  std::string file = readFile(path);
  const size_t end = file.size();
  const uint32_t directory =
      uint32_t(static_cast<unsigned char>(file[6])) << 8 | static_cast<unsigned char>(file[7]);
  const size_t entries = static_cast<unsigned char>(file[directory + 1]);
  for (size_t i = 0; i < entries; ++i) {
    const size_t entry = directory + 2 + 12 * i;
    const int tag =
        static_cast<unsigned char>(file[entry]) << 8 | static_cast<unsigned char>(file[entry + 1]);
    if (tag != TIFFTAG_STRIPOFFSETS) continue;
    file[entry + 3] = 4;  // LONG
    for (size_t b = 0; b < 4; ++b) file[entry + 8 + b] = char(end >> (24 - 8 * b));
  }
  writeFile(path, file + swapped(bytes, 2));
  const auto image = openImage(path);
  CHECK(image->info().size == kTiffSize);
  CHECK(readAll(*image, 2) == bytes);
  writeFile(path, (file + swapped(bytes, 2)).substr(0, file.size() + bytes.size() - 1));
  CHECK_THROWS_WITH(openImage(path), Contains("truncated") && Contains("3 images"));
}

TEST_CASE("image_file: TIFF cut at any byte is refused or read whole", "[image_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.tif";
  const ImageSize size{3, 2, 3};
  for (const std::string mode : {"wl", "wb", "wl8", "wb8"}) {
    TiffLayout layout;
    layout.mode = mode;
    writeTiff(path, size, SampleType::uint8, randomSamples(SampleType::uint8, voxels(size), 12),
              layout);
    const std::string whole = readFile(path);
    for (size_t length = 0; length < whole.size(); ++length) {
      CAPTURE(mode, length, whole.size());
      writeFile(path, whole.substr(0, length));
      int slices = size.z;
      try {
        slices = openImage(path)->info().size.z;
      } catch (const IoError& error) {
        CHECK_THAT(error.what(), Contains(path));
      }
      CHECK(slices == size.z);
    }
  }
}

TEST_CASE("image_file: the real scan has the known phase", "[image_file]") {
  const auto path = dataFile("nmc.tif");
  if (!path) {
    WARN("SKIPPED: nmc.tif not found; set VDB_MADF_DATA to its folder");
    return;
  }
  const auto image = openImage(*path);
  CHECK(image->info().size == ImageSize{301, 301, 251});
  CHECK(image->info().type == SampleType::uint8);
  const std::string samples = readAll(*image, 8);
  CHECK(std::count(samples.begin(), samples.end(), '\1') == 11357945);
}
