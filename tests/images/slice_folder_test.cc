// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/catch.h"
#include "support/files.h"
#include "support/images.h"
#include "support/picture_files.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/open_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

constexpr int kWidth = 13, kHeight = 7;

std::string randomBytes(size_t count, int bits, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes;
  for (size_t i = 0; i < count; ++i) bytes += char(random() & ((1u << std::min(bits, 8)) - 1));
  return bytes;
}

std::string repeated(const std::string& bytes, int times, const std::string& more = "") {
  std::string all;
  for (const char c : bytes) all += std::string(size_t(times), c) + more;
  return all;
}

}  // namespace

TEST_CASE("image_pictures: PNG of every depth, interlaced or not", "[image_pictures]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.png";
  for (const bool interlaced : {false, true})
    for (const int bits : {1, 2, 4, 8, 16})
      for (const int colour : {0, 3, 4}) {
        if ((colour == 3 && bits == 16) || (colour == 4 && bits < 8)) continue;
        CAPTURE(interlaced, bits, colour);
        const size_t sample = bits == 16 ? 2 : 1;
        const std::string grey = randomBytes(kWidth * kHeight * sample, bits, 1);
        std::string samples;
        for (size_t i = 0; i < grey.size(); i += sample) {
          samples += grey.substr(i, sample);
          if (colour == 4) samples += std::string(sample, '\x77');
        }
        writeFile(path, pngFile({kWidth, kHeight, bits, colour, interlaced}, samples));
        CHECK(looksLikeImage(path));
        const auto image = openImage(path);
        CHECK(image->info().size == ImageSize{kWidth, kHeight, 1});
        CHECK(image->info().type == (bits == 16 ? SampleType::uint16 : SampleType::uint8));
        CHECK(image->info().format == "png");
        CHECK(readAll(*image) == swapped(grey, sample));
      }
}

TEST_CASE("image_pictures: BMP of every depth and row order", "[image_pictures]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.bmp";
  for (const bool topDown : {false, true})
    for (const bool core : {false, true})
      for (const int bits : {1, 4, 8, 24, 32}) {
        if (topDown && core) continue;  // has no signs
        CAPTURE(topDown, core, bits);
        const std::string grey = randomBytes(kWidth * kHeight, bits, 2);
        std::string rows;
        for (int y = 0; y < kHeight; ++y) {
          const std::string row = grey.substr(size_t(y * kWidth), kWidth);
          if (bits == 8) rows += row;
          if (bits > 8) rows += repeated(row, 3, bits == 32 ? "\x44" : "");
          if (bits < 8) {
            std::string packed(size_t(kWidth * bits + 7) / 8, '\0');
            for (int x = 0; x < kWidth; ++x) {
              char& byte = packed[size_t(x * bits / 8)];
              byte = char(byte | row[size_t(x)] << (8 - bits - x * bits % 8));
            }
            rows += packed;
          }
        }
        BmpLayout layout{kWidth, kHeight, bits, topDown, core, "", 0, 2};
        const size_t colour = core ? 3 : 4;
        if (bits <= 8)
          for (int i = 0; i < 1 << bits; ++i) layout.palette += std::string(colour, char(i));
        writeFile(path, bmpFile(layout, rows));
        const auto image = openImage(path);
        CHECK(image->info().size == ImageSize{kWidth, kHeight, 1});
        CHECK(image->info().type == SampleType::uint8);
        CHECK(image->info().format == "bmp");
        CHECK(readAll(*image) == grey);
        if (bits > 1) continue;
        std::reverse(layout.palette.begin(), layout.palette.end());  // now 0 is the brighter
        writeFile(path, bmpFile(layout, rows));
        std::string inverse = grey;
        for (char& c : inverse) c = char(1 - c);
        CHECK(readAll(*openImage(path)) == inverse);
      }
}

TEST_CASE("image_pictures: colors are read when they are gray, else refused", "[image_pictures]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.png";
  const std::string grey = randomBytes(kWidth * kHeight, 8, 3);
  for (const bool interlaced : {false, true})
    for (const int colour : {2, 6}) {
      std::string pixels = repeated(grey, 3, colour == 6 ? "\x10" : "");
      writeFile(path, pngFile({kWidth, kHeight, 8, colour, interlaced}, pixels));
      CHECK(readAll(*openImage(path)) == grey);
      pixels[pixels.size() - 2] = char(pixels[pixels.size() - 2] ^ 1);
      writeFile(path, pngFile({kWidth, kHeight, 8, colour, interlaced}, pixels));
      if (colour == 2)
        CHECK_THROWS_WITH(readAll(*openImage(path)), Contains(path) && Contains("colors"));
    }
  std::string wide = repeated(grey, 6);  // both bytes of three samples
  writeFile(path, pngFile({kWidth, kHeight, 16, 2, false}, wide));
  CHECK(openImage(path)->info().type == SampleType::uint16);
  CHECK(readAll(*openImage(path)) == repeated(grey, 2));
  wide[5] = char(wide[5] ^ 1);
  writeFile(path, pngFile({kWidth, kHeight, 16, 2, false}, wide));
  CHECK_THROWS_WITH(readAll(*openImage(path)), Contains(path) && Contains("colors"));
}

TEST_CASE("image_pictures: a folder of slices", "[image_pictures]") {
  for (const std::string kind : {"png", "bmp"}) {
    CAPTURE(kind);
    const ScratchFolder folder;
    const auto picture = [&](int height, const std::string& rows) {
      return kind == "png" ? pngFile({kWidth, height, 8, 0, false}, rows)
                           : bmpFile({kWidth, height, 8, false, false,
                                      repeated(std::string(256, 'a'), 4), 0, 0},
                                     rows);
    };
    const std::string all = randomBytes(kWidth * kHeight * 12, 8, 4);
    const size_t slice = kWidth * kHeight;
    for (size_t z = 0; z < 12; ++z)
      writeFile(folder / ("rec" + std::to_string(z) + "." + (z == 5 ? "B" + kind : kind)),
                picture(kHeight, all.substr(z * slice, slice)));
    std::filesystem::rename(folder / ("rec5.B" + kind),
                            folder / ("rec5." + (kind == "png" ? std::string("PNG") : "BMP")));
    writeFile(folder / ("rec_spr." + kind), picture(2, all.substr(0, 2 * kWidth)));
    writeFile(folder / ".hidden.png", "x");
    CHECK(looksLikeImage(folder.path()));
    const auto image = openImage(folder.path());
    CHECK(image->info().size == ImageSize{kWidth, kHeight, 12});
    CHECK(image->info().format == kind);
    CHECK_FALSE(image->info().voxelSize);
    CHECK(image->files().size() == 12);
    CHECK(readAll(*image, 5) == all);

    writeFile(folder / "rec.log",
              "[System]\r\nCamera Pixel Size (um)=  9.0\r\n[Acquisition]\r\n"
              "Image Pixel Size (um)=  8.4\r\n[Reconstruction]\r\nPixel Size (um)=8.5\r\n");
    writeFile(folder / "other.log", "nothing of interest\n");
    CHECK(openImage(folder.path())->info().voxelSize->edge() == 8.5e-6);
    writeFile(folder / "other.log", "Pixel Size (um)=7\n");
    CHECK_FALSE(openImage(folder.path())->info().voxelSize);
    writeFile(folder / "other.log", "Pixel Size (um)=-7\n");
    CHECK_THROWS_WITH(openImage(folder.path()), Contains("other.log"));
    std::filesystem::remove(folder / "other.log");

    writeFile(folder / ("rec12." + kind), picture(kHeight + 1, all.substr(0, slice + kWidth)));
    CHECK_THROWS_WITH(openImage(folder.path()),
                      Contains("rec12." + kind) && Contains("13 x 8 uint8"));
    std::filesystem::remove(folder / ("rec12." + kind));
    writeFile(folder / (kind == "png" ? "x.bmp" : "x.png"), "");
    CHECK_THROWS_WITH(openImage(folder.path()), Contains("has .png and .bmp"));
  }
}

TEST_CASE("image_pictures: previews beside TIFF slices are passed over", "[image_pictures]") {
  const ScratchFolder folder;
  const std::string bytes = randomSamples(SampleType::uint8, 12, 5);
  writeTiff(folder / "a.tif", ImageSize{4, 3, 1}, SampleType::uint8, bytes);
  writeFile(folder / "a.png", "no picture");
  writeFile(folder / "a.log", "Pixel Size (um) = 12\n");
  const auto image = openImage(folder.path());
  CHECK(image->info().format == "tiff");
  CHECK(image->info().voxelSize->edge() == 1.2e-5);
  CHECK(readAll(*image) == bytes);
}

TEST_CASE("image_pictures: pictures that claim too much or another kind", "[image_pictures]") {
  const ScratchFolder folder;
  const std::string bmp = folder / "a.bmp", png = folder / "a.png";
  const std::string rows(kWidth * kHeight, 'a');
  const auto refused = [&](const std::string& path, const std::string& file,
                           const std::string& why) {
    writeFile(path, file);
    CHECK_THROWS_WITH(openImage(path), Contains(path) && Contains(why));
  };
  const std::string palette(1024, 'a');
  refused(bmp, bmpFile({kWidth, kHeight, 8, false, false, palette, 1, 0}, rows), "compressed");
  refused(bmp, bmpFile({kWidth, kHeight, 16, false, false, "", 0, 0}, rows + rows), "16");
  refused(bmp, bmpFile({kWidth, kHeight + 1, 8, false, false, palette, 0, 0}, rows), "cut short");
  refused(bmp, bmpFile({1 << 21, kHeight, 8, false, false, palette, 0, 0}, rows), "size");
  refused(bmp, bmpFile({-3, kHeight, 8, false, false, palette, 0, 0}, rows), "size");
  PngLayout large{900000, 900000, 8, 0, false};
  std::string header(13, '\0');
  put(header, 0, uint32_t(large.width), true);
  put(header, 4, uint32_t(large.height), true);
  header[8] = 8;
  refused(png,
          "\x89PNG\r\n\x1a\n" + pngChunk("IHDR", header) + pngChunk("IDAT", deflated(rows, 15)) +
              pngChunk("IEND", ""),
          "too few");
  std::string good = pngFile({kWidth, kHeight, 8, 0, false}, rows);
  good[good.size() - 30] = char(good[good.size() - 30] ^ 4);
  writeFile(png, good);
  CHECK_THROWS_WITH(readAll(*openImage(png)), Contains(png) && Contains("damaged"));
}
