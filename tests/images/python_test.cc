// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cstdio>
#include <sstream>

#include "support/files.h"
#include "support/images.h"

#include "support/catch.h"
#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

// Files as NumPy, nibabel, zarr, h5py and Pillow write them, and ours as NumPy, tifffile and pynrrd
// read them. What is not installed is skipped, and said so.

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// The lines that tests/support/image_formats.py prints.
std::vector<std::string> linesOf(const std::string& verb, const std::string& folder) {
  // Debian's own, for which its packages are; not one that stands before it in the PATH.
  const char* own = "/usr/bin/python3";
  const std::string python = std::ifstream(own).good() ? own : "python3";
  const std::string command = python + " -W ignore '" + VDB_MADF_TEST_DIR +
                              "/support/image_formats.py' " + verb + " '" + folder + "'";
  FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe);
  std::string text;
  for (int c; (c = std::fgetc(pipe)) != EOF;) text += char(c);
  const int status = pclose(pipe);
  if (status == 127 << 8) return {"skipped python3"};
  REQUIRE(status == 0);
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The labels, which are written with 64 bits, as the 32 bits that we read.
std::string truthOf(const std::string& path, size_t voxelCount) {
  std::string bytes = readFile(path), narrow;
  if (bytes.size() != 8 * voxelCount) return bytes;
  for (size_t i = 0; i < bytes.size(); i += 8) narrow += bytes.substr(i, 4);
  return narrow;
}

void warnIfSkipped(const std::string& line) {
  if (line.compare(0, 8, "skipped ") == 0)
    WARN("SKIPPED: the cross-check with Python's " << line.substr(8) << ": not installed");
}

}  // namespace

TEST_CASE("image_python: files of other programs give the same voxels", "[image_python]") {
  const ScratchFolder folder;
  for (const std::string& line : linesOf("write", folder.path())) {
    CAPTURE(line);
    std::istringstream words(line);
    std::string kind, truth, name, dataset;
    double metres = 0;
    words >> kind >> truth >> name >> metres >> dataset;
    warnIfSkipped(line);
    if (kind != "file") continue;
#ifndef VDB_MADF_HDF5
    if (name == "volume.h5") {
      WARN("SKIPPED: the cross-check with h5py: built without libhdf5-dev");
      continue;
    }
#endif
    const auto image = openImage(folder / name, {}, dataset);
    CHECK(image->info().size == ImageSize{11, 7, 6});
    CHECK((image->info().voxelSize ? image->info().voxelSize->edge() : 0) == metres);
    const bool same = readAll(*image, 4) == truthOf(folder / truth, voxels(ImageSize{11, 7, 6}));
    CHECK(same);
  }
}

TEST_CASE("image_python: other programs read what we write", "[image_python]") {
  const ScratchFolder folder;
  linesOf("write", folder.path());
  if (!std::ifstream(folder / "labels.npy").good()) {
    WARN("SKIPPED: the cross-check of our files: Python's numpy is not installed");
    return;
  }
  std::vector<std::string> endings = {"npy", "tif", "nrrd"};
  if (readsHdf5()) endings.push_back("h5");
  for (const std::string& ending : endings) {
    ImageInfo info;
    info.size = ImageSize{11, 7, 6};
    info.type = ending == "tif" ? SampleType::uint16 : SampleType::int32;
    info.voxelSize = VoxelSize{8.5e-6};
    const std::string labels = truthOf(folder / "labels.raw", voxels(info.size));
    std::string samples;
    for (size_t i = 0; i < labels.size(); i += 4)
      samples += labels.substr(i, sampleSize(info.type));
    const auto writer = createImage(folder / ("ours." + ending), info);
    writer->write(6, samples.data());
    writer->finish();
  }
  int compared = 0;
  for (const std::string& line : linesOf("check", folder.path())) {
    warnIfSkipped(line);
    CAPTURE(line);
    CHECK(line.find("differs") == std::string::npos);
    compared += line.compare(0, 5, "same ") == 0;
  }
  CHECK(compared > 0);
}
