// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace vdb_madf::tools {

using Color = std::array<uint8_t, 3>;

/// A picture: row by row from the top, left to right.
struct Picture {
  int width = 0, height = 0;
  std::vector<Color> pixels;

  Picture(int w, int h, const Color& fill) : width(w), height(h), pixels(size_t(w) * h, fill) {}
  Color& at(int x, int y) { return pixels[size_t(y) * width + x]; }
  const Color& at(int x, int y) const { return pixels[size_t(y) * width + x]; }
};

/// Writes a PNG, whole or not at all. @throw IoError
void writePng(const std::string& path, const Picture& picture);

}  // namespace vdb_madf::tools
