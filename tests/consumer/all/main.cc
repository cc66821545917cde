// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What a program that links the whole library looks like: it makes balls, segments and measures
// them, and writes what it found.

#include "all_headers.h"

#include <filesystem>
#include <iostream>

#include "vdb_madf/exports/network_file.h"
#include "vdb_madf/samples/sintered.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "vdb_madf/volumes/write_image.h"

bool segmentsArrays();  // array.cc

int main() {
  if (!segmentsArrays()) return 1;
  vdb_madf::initialize();
  vdb_madf::SinteredOptions sample;
  sample.size = {64, 64, 64};
  sample.count = 4;
  const vdb_madf::Segmentation result =
      vdb_madf::segment(*vdb_madf::generateSintered(sample).object);
  vdb_madf::writeVdb("grains.vdb", {result.grain});
  vdb_madf::writeImage("grains.tif", *result.grain, {{0, 0, 0}, {63, 63, 63}},
                       vdb_madf::SampleType::uint16);
  vdb_madf::writeNetwork("grains.graphml", vdb_madf::grainNetwork(*result.grain));
  std::cout << result.counts.grains << " grains\n";
  for (const char* file : {"grains.vdb", "grains.tif", "grains.graphml"})
    if (!std::filesystem::exists(file)) return 1;
  return vdb_madf::readVdb("grains.vdb").size() == 1 && result.counts.grains > 0 ? 0 : 1;
}
