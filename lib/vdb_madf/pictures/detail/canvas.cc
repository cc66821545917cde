// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/canvas.h"

#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>

#include "vdb_madf/pictures/png_file.h"

namespace vdb_madf::detail {

// The bytes of the font file: made by the build.
extern const unsigned char kFont[];
extern const size_t kFontSize;

namespace {

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

constexpr double kUnitsPerInch = 96, kDotsPerInch = 300;

void require(cairo_status_t status) {
  if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
  if (status != CAIRO_STATUS_SUCCESS) throw std::runtime_error(cairo_status_to_string(status));
}

cairo_font_face_t* loadFont() {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  if (FT_Init_FreeType(&library) != 0 ||
      FT_New_Memory_Face(library, kFont, FT_Long(kFontSize), 0, &face) != 0)
    throw std::runtime_error("the font of the pictures cannot be read");
  return cairo_ft_font_face_create_for_ft_face(face, FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP);
}

Surface image(int width, int height) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height),
                  cairo_surface_destroy);
  require(cairo_surface_status(surface.get()));
  return surface;
}

Context contextOf(const Surface& surface) {
  static cairo_font_face_t* const font = loadFont();  // lives as long as the program
  Context context(cairo_create(surface.get()), cairo_destroy);
  require(cairo_status(context.get()));
  cairo_set_font_face(context.get(), font);
  cairo_font_options_t* const options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context.get(), options);
  cairo_font_options_destroy(options);
  cairo_set_line_join(context.get(), CAIRO_LINE_JOIN_ROUND);
  return context;
}

/// Rows of 32-bit numbers 0x00RRGGBB.
uint32_t* row(const Surface& surface, int y) {
  unsigned char* const data = cairo_image_surface_get_data(surface.get());
  return reinterpret_cast<uint32_t*>(data +
                                     ptrdiff_t(y) * cairo_image_surface_get_stride(surface.get()));
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

/// Cairo numbers its surfaces from the beginning of the program on.
void dropNumberOfSurface(std::string& svg) {
  const std::string name = "id=\"surface";
  const size_t begin = svg.find(name);
  if (begin == std::string::npos) return;
  const size_t end = svg.find('"', begin + name.size());
  svg.erase(begin + name.size(), end - begin - name.size());
}

}  // namespace

void Canvas::scale(double factor) {
  cairo_scale(context_, factor, factor);
}

void Canvas::color(const Rgb& color) {
  cairo_set_source_rgb(context_, color[0] / 255.0, color[1] / 255.0, color[2] / 255.0);
}

void Canvas::path(const std::vector<Point>& points) {
  cairo_new_path(context_);
  for (const Point& p : points) cairo_line_to(context_, p[0], p[1]);
}

void Canvas::line(const std::vector<Point>& points, const Pen& pen) {
  if (points.size() < 2) return;
  path(points);
  color(pen.color);
  cairo_set_line_width(context_, pen.width);
  cairo_set_dash(context_, pen.dashes.data(), int(pen.dashes.size()), 0);
  cairo_stroke(context_);
}

void Canvas::area(const std::vector<Point>& corners, const Rgb& fill) {
  path(corners);
  color(fill);
  cairo_fill(context_);
}

void Canvas::rectangle(const Point& corner, double width, double height, const Rgb& fill) {
  cairo_rectangle(context_, corner[0], corner[1], width, height);
  color(fill);
  cairo_fill(context_);
}

void Canvas::text(const Point& at, const std::string& text, double size, const Rgb& ink,
                  Anchor anchor) {
  const double width = anchor == Anchor::start ? 0 : textWidth(text, size);
  color(ink);
  cairo_set_font_size(context_, size);
  cairo_move_to(context_, at[0] - (anchor == Anchor::middle ? width / 2 : width), at[1]);
  cairo_show_text(context_, text.c_str());
}

double textWidth(const std::string& text, double size) {
  const Context context = contextOf(image(1, 1));
  cairo_text_extents_t extents;
  // The font is large, so that the extents do not depend on whole pixels.
  constexpr double kLarge = 1000;
  cairo_set_font_size(context.get(), kLarge);
  cairo_text_extents(context.get(), text.c_str(), &extents);
  return extents.x_advance * size / kLarge;
}

void paint(Picture& picture, int left, int top, int width, int height, const Drawing& drawing) {
  const int firstX = std::max(left, 0), firstY = std::max(top, 0);
  const int endX = std::min(left + width, picture.width),
            endY = std::min(top + height, picture.height);
  if (firstX >= endX || firstY >= endY) return;
  const Surface surface = image(endX - firstX, endY - firstY);
  for (int y = firstY; y < endY; ++y)
    for (int x = firstX; x < endX; ++x) {
      const Rgb& c = picture.at(x, y);
      row(surface, y - firstY)[x - firstX] = uint32_t(c[0] << 16 | c[1] << 8 | c[2]);
    }
  cairo_surface_mark_dirty(surface.get());
  {
    const Context context = contextOf(surface);
    cairo_translate(context.get(), left - firstX, top - firstY);
    Canvas canvas(context.get());
    drawing(canvas);
    require(cairo_status(context.get()));
  }
  cairo_surface_flush(surface.get());
  for (int y = firstY; y < endY; ++y)
    for (int x = firstX; x < endX; ++x) {
      const uint32_t c = row(surface, y - firstY)[x - firstX];
      picture.at(x, y) = {uint8_t(c >> 16), uint8_t(c >> 8), uint8_t(c)};
    }
}

std::string plotFile(PlotType type, double width, double height, const Drawing& drawing) {
  if (type == PlotType::png) {
    const double scale = kDotsPerInch / kUnitsPerInch;
    Picture picture(int(std::ceil(width * scale)), int(std::ceil(height * scale)), {255, 255, 255});
    paint(picture, 0, 0, picture.width, picture.height, [&](Canvas& canvas) {
      canvas.scale(scale);
      drawing(canvas);
    });
    return pngBytes(picture);
  }
  std::string bytes;
  {
    const double points = 72 / kUnitsPerInch;
    const Surface surface(
        type == PlotType::svg
            ? cairo_svg_surface_create_for_stream(append, &bytes, width, height)
            : cairo_pdf_surface_create_for_stream(append, &bytes, width * points, height * points),
        cairo_surface_destroy);
    require(cairo_surface_status(surface.get()));
    if (type == PlotType::svg) {
      cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
    } else {
      cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, nullptr);
    }
    const Context context = contextOf(surface);
    Canvas canvas(context.get());
    if (type == PlotType::pdf) canvas.scale(points);
    canvas.rectangle({0, 0}, width, height, {255, 255, 255});
    drawing(canvas);
    require(cairo_status(context.get()));
    cairo_surface_finish(surface.get());
    require(cairo_surface_status(surface.get()));
  }
  if (type == PlotType::svg) dropNumberOfSurface(bytes);
  return bytes;
}

}  // namespace vdb_madf::detail
