// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "support/images.h"

#include "vdb_madf/images/image.h"

// Files of formats with a header, built by hand from their definitions.

namespace vdb_madf::test {

template <typename T>
void put(std::string& bytes, size_t offset, T value, bool bigEndian = false) {
  std::string word(sizeof value, '\0');
  std::memcpy(word.data(), &value, sizeof value);
  if (bigEndian) word = swapped(word, sizeof value);
  bytes.replace(offset, sizeof value, word);
}

inline std::string npyHeader(const std::string& dictionary, int version) {
  std::string head = std::string("\x93NUMPY") + char(version) + '\0';
  const std::string text = dictionary + "   \n";
  head += char(text.size() & 255);
  head += char(text.size() >> 8);
  if (version > 1) head += std::string(2, '\0');
  return head + text;
}

inline std::string npyFile(const std::string& type, const std::string& shape,
                           const std::string& samples, int version = 1,
                           const std::string& fortran = "False") {
  return npyHeader("{'descr': '" + type + "', 'fortran_order': " + fortran + ", 'shape': " + shape +
                       ", }",
                   version) +
         samples;
}

struct IsqLayout {
  ImageSize voxels, micrometres;
  int32_t type = 3;
  int32_t blocks = 0;  ///< between the first block and the samples
};

inline std::string isqFile(const IsqLayout& layout, const std::string& samples) {
  std::string bytes(512 * size_t(1 + std::max(layout.blocks % 100, 0)), '\0');
  bytes.replace(0, 16, "CTDATA-HEADER_V1");
  put(bytes, 16, layout.type);
  for (size_t axis = 0; axis < 3; ++axis) {
    put(bytes, 44 + 4 * axis, int32_t(layout.voxels[int(axis)]));
    put(bytes, 56 + 4 * axis, int32_t(layout.micrometres[int(axis)]));
  }
  put(bytes, 508, layout.blocks);
  return bytes + samples;
}

struct NiftiLayout {
  std::vector<int> dim;
  int type = 2;
  std::array<float, 3> edge{1, 1, 1};
  int units = 0;
  float slope = 0, intercept = 0;
  bool bigEndian = false;
  size_t offset = 352;      ///< where the samples really begin
  float statedOffset = -1;  ///< what the header says instead
  std::string magic = "n+1";
};

inline std::string niftiFile(const NiftiLayout& layout, const std::string& samples) {
  std::string bytes(layout.offset, '\0');
  const bool big = layout.bigEndian;
  put(bytes, 0, int32_t(348), big);
  for (size_t i = 0; i < layout.dim.size(); ++i)
    put(bytes, 40 + 2 * i, int16_t(layout.dim[i]), big);
  put(bytes, 70, int16_t(layout.type), big);
  for (size_t i = 0; i < 3; ++i) put(bytes, 80 + 4 * i, layout.edge[i], big);
  put(bytes, 108, layout.statedOffset == -1 ? float(layout.offset) : layout.statedOffset, big);
  put(bytes, 112, layout.slope, big);
  put(bytes, 116, layout.intercept, big);
  bytes[123] = char(layout.units);
  bytes.replace(344, 3, layout.magic);
  return bytes + samples;
}

/// A header of 5 x 4 x 3 voxels. Version 0: none is stated.
inline std::string dgtalHeader(const std::string& voxelSize, int version) {
  return "Center-X: 2\nCenter-Y: 1\nCenter-Z: 1\nX: 5\nY: 4\nZ: 3\n" + voxelSize +
         "\nAlpha-Color: 0\nVoxel-Endian: 0\nInt-Endian: 0123\n" +
         (version ? "Version: " + std::to_string(version) + "\n" : "") + ".\n";
}

}  // namespace vdb_madf::test
