// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <vector>

#include "vdb_madf/base/color.h"

namespace vdb_madf {

/// A picture: row by row from the top, left to right.
struct Picture {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;

  Picture(int w, int h, const Rgb& fill) : width(w), height(h), pixels(size_t(w) * h, fill) {}
  Rgb& at(int x, int y) { return pixels[size_t(y) * width + x]; }
  const Rgb& at(int x, int y) const { return pixels[size_t(y) * width + x]; }
};

}  // namespace vdb_madf
