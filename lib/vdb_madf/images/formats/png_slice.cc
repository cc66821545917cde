// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <png.h>

#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/inflate_stream.h"
#include "vdb_madf/images/detail/gray_colors.h"
#include "vdb_madf/images/formats/picture_slice.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

namespace {

/// What libpng reads from, and what it has to say when it cannot.
struct Source {
  const InputFile& file;
  uint64_t position = 0;
  std::string error;
};

Source& sourceOf(png_structp png) {
  return *static_cast<Source*>(png_get_io_ptr(png));
}

void keepError(png_structp png, png_const_charp message) {
  static_cast<Source*>(png_get_error_ptr(png))->error = message;
  png_longjmp(png, 1);
}

void ignoreWarning(png_structp, png_const_charp) {}

void readBytes(png_structp png, png_bytep to, size_t count) {
  Source& source = sourceOf(png);
  bool good = false;
  try {
    source.file.read(source.position, to, count);
    source.position += count;
    good = true;
  } catch (const std::exception&) {  // must not leave through C
  }
  if (!good) png_error(png, "it ends early");
}

/// libpng, with its state freed at the end.
struct Decoder {
  explicit Decoder(Source& source) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, keepError, ignoreWarning);
    if (png) info = png_create_info_struct(png);
    if (!info) {
      png_destroy_read_struct(&png, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png, &source, readBytes);
  }
  ~Decoder() { png_destroy_read_struct(&png, &info, nullptr); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  png_structp png = nullptr;
  png_infop info = nullptr;
};

// The functions that libpng may leave by a jump have no objects that would have to be destroyed.

bool readHeader(Decoder& decoder) {
  if (setjmp(png_jmpbuf(decoder.png))) return false;
  png_read_info(decoder.png, decoder.info);
  return true;
}

/// To whole bytes, native byte order, without opacity.
bool transform(Decoder& decoder) {
  if (setjmp(png_jmpbuf(decoder.png))) return false;
  png_set_packing(decoder.png);
  png_set_swap(decoder.png);
  png_set_strip_alpha(decoder.png);
  png_set_interlace_handling(decoder.png);
  png_read_update_info(decoder.png, decoder.info);
  return true;
}

bool readRows(Decoder& decoder, png_bytepp rows) {
  if (setjmp(png_jmpbuf(decoder.png))) return false;
  png_read_image(decoder.png, rows);
  png_read_end(decoder.png, nullptr);
  return true;
}

[[noreturn]] void fail(const Source& source) {
  throw IoError(source.file.name() + ": is damaged or no PNG file: " + source.error);
}

PictureHeader pictureOf(const Source& source, const Decoder& decoder) {
  const std::string& name = source.file.name();
  PictureHeader picture;
  picture.width = png_get_image_width(decoder.png, decoder.info);
  picture.height = png_get_image_height(decoder.png, decoder.info);
  checkPictureSize(name, picture.width, picture.height);
  const int bits = png_get_bit_depth(decoder.png, decoder.info),
            channels = png_get_channels(decoder.png, decoder.info);
  picture.type = bits == 16 ? SampleType::uint16 : SampleType::uint8;
  const uint64_t bytes = picture.samples() / 8 * uint64_t(bits * channels);
  if (bytes / InflateStream::kMaxExpansion > source.file.size())
    throw IoError(name + ": has " + std::to_string(source.file.size()) + " bytes, too few for " +
                  picture.text());
  return picture;
}

}  // namespace

bool isPngHeader(const std::string& head) {
  return head.compare(0, 8, "\x89PNG\r\n\x1a\n") == 0;
}

PictureHeader pngHeader(const InputFile& file) {
  Source source{file, 0, {}};
  Decoder decoder(source);
  if (!readHeader(decoder)) fail(source);
  return pictureOf(source, decoder);
}

void readPng(const InputFile& file, const PictureHeader& picture, void* samples) {
  Source source{file, 0, {}};
  Decoder decoder(source);
  if (!readHeader(decoder)) fail(source);
  if (!pictureOf(source, decoder).sameAs(picture))
    throw IoError(file.name() + ": changed while it was read");
  if (!transform(decoder)) fail(source);
  const size_t width = size_t(picture.width), height = size_t(picture.height);
  const size_t rowBytes = png_get_rowbytes(decoder.png, decoder.info);
  const bool gray = png_get_channels(decoder.png, decoder.info) == 1;
  if (gray && rowBytes != width * sampleSize(picture.type))
    throw IoError(file.name() + ": its rows have " + std::to_string(rowBytes) + " bytes");
  auto* out = static_cast<unsigned char*>(samples);
  std::vector<unsigned char> colors(gray ? 0 : rowBytes * height);
  std::vector<png_bytep> rows(height);
  for (size_t y = 0; y < height; ++y) rows[y] = (gray ? out : colors.data()) + y * rowBytes;
  if (!readRows(decoder, rows.data())) fail(source);
  if (!gray)
    grayOfColors(file.name(), colors.data(), 3, sampleSize(picture.type), width * height, out);
}

}  // namespace vdb_madf::detail
