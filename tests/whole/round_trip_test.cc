// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <limits>

#include "support/catch.h"
#include "support/files.h"
#include "support/images.h"
#include "support/label_shapes.h"
#include "support/vtk_arrays.h"
#include "vdb_madf/exports/vti_file.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/pictures/preview_volume.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "vdb_madf/volumes/read_labels.h"
#include "vdb_madf/volumes/write_image.h"

// Labels come back to the bit from every format that holds them: by our reader, and decoded here by
// the definition of the format.

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

constexpr int32_t kLargest = std::numeric_limits<int32_t>::max();
/// Odd sizes, no multiple of a leaf, both sides of the origin.
const CoordBBox kBox(Coord(-13, -9, -21), Coord(17, 5, 10));

/// Half of the box, with the greatest labels of each width.
LabelMap manyLabels(int32_t most) {
  LabelMap voxels;
  std::mt19937 random(3);
  for (auto p = kBox.begin(); p; ++p)
    if (random() % 2) voxels[*p] = 1 + int32_t(random() % uint32_t(most));
  int x = -13;
  for (const int32_t label : {1, 255, 256, 65535, 65536, 16777217, kLargest})
    if (label <= most) voxels[{x++, -9, -21}] = label;
  return voxels;
}

Int32Grid::Ptr gridOf(const LabelMap& voxels) {
  const auto grid = labelGrid(voxels);
  setVoxelSize(*grid, VoxelSize{8.5e-6});
  setDomain(*grid, kBox);
  return grid;
}

/// x fastest.
template <typename T>
std::string samplesOf(const LabelMap& voxels) {
  std::string bytes;
  for (int z = kBox.min().z(); z <= kBox.max().z(); ++z)
    for (int y = kBox.min().y(); y <= kBox.max().y(); ++y)
      for (int x = kBox.min().x(); x <= kBox.max().x(); ++x) {
        const auto found = voxels.find({x, y, z});
        const T value = found == voxels.end() ? T(0) : T(found->second);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
  return bytes;
}

std::string samplesOf(const LabelMap& voxels, SampleType type) {
  return type == SampleType::uint16   ? samplesOf<uint16_t>(voxels)
         : type == SampleType::uint32 ? samplesOf<uint32_t>(voxels)
                                      : samplesOf<int32_t>(voxels);
}

/// What stands in front of the last `count` bytes.
std::string headerOf(const std::string& file, size_t count) {
  REQUIRE(file.size() >= count);
  return file.substr(0, file.size() - count);
}

std::string decodedTiff(const std::string& path) {
  const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(TIFFOpen(path.c_str(), "r"), TIFFClose);
  REQUIRE(tiff);
  std::string bytes;
  do {
    uint32_t width = 0, height = 0;
    uint16_t format = 0;
    TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &height);
    TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLEFORMAT, &format);
    CHECK(Coord(int(width), int(height), 0) == Coord(kBox.dim().x(), kBox.dim().y(), 0));
    CHECK(format != SAMPLEFORMAT_IEEEFP);
    std::string row(size_t(TIFFScanlineSize(tiff.get())), '\0');
    for (uint32_t y = 0; y < height; ++y) {
      REQUIRE(TIFFReadScanline(tiff.get(), row.data(), y) == 1);
      bytes += row;
    }
  } while (TIFFReadDirectory(tiff.get()));
  return bytes;
}

/// The samples of a file, without our readers; its header says what they are.
std::string decoded(const ScratchFolder& folder, const std::string& ending, SampleType type,
                    size_t count) {
  const std::string path = folder / ("a." + ending), file = readFile(path);
  const auto has = [](const std::string& text, const std::string& part) {
    CAPTURE(text);
    CHECK(text.find(part) != std::string::npos);
  };
  const bool wide = type != SampleType::uint16, isSigned = type == SampleType::int32;
  if (ending == "raw") return file;
  if (ending == "tif") return decodedTiff(path);
  const std::string header = ending == "mhd" ? file : headerOf(file, count);
  if (ending == "npy") {
    has(header, isSigned ? "'<i4'" : wide ? "'<u4'" : "'<u2'");
    has(header, "(32, 15, 31)");
    has(header, "'fortran_order': False");
    CHECK(header.size() % 64 == 0);
    CHECK(header.size() == 10 + size_t(uint8_t(header[8])) + 256 * size_t(uint8_t(header[9])));
  } else if (ending == "nrrd") {
    has(header, std::string("\ntype: ") + (isSigned ? "int32" : wide ? "uint32" : "uint16") + "\n");
    has(header, "\nsizes: 31 15 32\n");
    has(header, "\nendian: little\nencoding: raw\n\n");
    CHECK(header.find("\n\n") + 2 == header.size());
  } else {
    has(header, std::string("\nElementType = MET_") +
                    (isSigned ? "INT"
                     : wide   ? "UINT"
                              : "USHORT") +
                    "\n");
    has(header, "\nDimSize = 31 15 32\n");
    has(header, "\nBinaryDataByteOrderMSB = False\n");
    has(header, ending == "mhd" ? "\nElementDataFile = a.raw\n" : "\nElementDataFile = LOCAL\n");
  }
  return ending == "mhd" ? readFile(folder / "a.raw") : file.substr(header.size());
}

/// Voxels and labels, and that nothing else is active.
void checkSame(const Int32Grid& grid, const LabelMap& voxels, const Coord& shift) {
  CHECK(grid.activeVoxelCount() == voxels.size());
  size_t wrong = 0;
  for (const auto& [p, label] : voxels) wrong += grid.tree().getValue(p + shift) != label;
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("round_trip: labels in images", "[round_trip]") {
  const ScratchFolder folder;
  for (const SampleType type : {SampleType::uint16, SampleType::uint32, SampleType::int32}) {
    const LabelMap voxels = manyLabels(type == SampleType::uint16 ? 65535 : kLargest);
    const auto grid = gridOf(voxels);
    const std::string samples = samplesOf(voxels, type);
    for (const std::string ending : {"mhd", "raw", "tif", "mha", "nrrd", "npy"}) {
      CAPTURE(ending, sampleTypeName(type));
      const std::string path = folder / ("a." + ending);
      writeImage(path, *grid, kBox, type);
      CHECK((decoded(folder, ending, type, samples.size()) == samples));
      std::optional<RawLayout> layout;
      if (ending == "raw") layout = RawLayout{toImageSize(kBox.dim()), type, false};
      const auto image = openImage(path, layout);
      CHECK(toCoord(image->info().size) == kBox.dim());
      CHECK(image->info().type == type);
      if (ending != "raw" && ending != "npy") CHECK(image->info().voxelSize->edge() == 8.5e-6);
      checkSame(*readLabels(*openImage(path, layout)), voxels, -kBox.min());
    }
  }
}

TEST_CASE("round_trip: labels in VTI, compressed or not", "[round_trip]") {
  const ScratchFolder folder;
  const LabelMap voxels = manyLabels(kLargest);
  for (const bool compressed : {false, true}) {
    writeVti(folder / "a.vti", *gridOf(voxels), kBox, compressed);
    const auto values = VtkArrays(readFile(folder / "a.vti")).values<int32_t>("grain_id");
    const std::string bytes(reinterpret_cast<const char*>(values.data()), 4 * values.size());
    CHECK((bytes == samplesOf<int32_t>(voxels)));
  }
}

TEST_CASE("round_trip: labels in VDB, and as their own reduction by one", "[round_trip]") {
  const ScratchFolder folder;
  const LabelMap voxels = manyLabels(kLargest);
  const auto grid = gridOf(voxels);
  const auto same = reduceLabels(*grid, 1);
  checkSame(*same, voxels, Coord(0));
  CHECK(same->transform() == grid->transform());
  CHECK(*storedDomain(*same) == kBox);
  writeVdb(folder / "a.vdb", {grid, same});
  for (const auto& read : readVdb(folder / "a.vdb")) {
    checkSame(*openvdb::gridPtrCast<Int32Grid>(read), voxels, Coord(0));
    CHECK(read->transform() == grid->transform());
    CHECK(*storedDomain(*read) == kBox);
    CHECK(storedVoxelSize(*read)->edge() == 8.5e-6);
  }
}
