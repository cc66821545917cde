// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "vdb_madf/measure/columns.h"

namespace vdb_madf::detail {

/// What goes into the groups of one HDF5 file.
struct Hdf5Tables {
  std::string unit;      ///< of length
  openvdb::Vec3d edges;  ///< of a voxel, in that unit
  std::vector<MeasureColumn> grains, bonds;
  nlohmann::ordered_json sample;  ///< an object
};

/// True if that is written into one file, by the ending: .h5 or .hdf5.
bool isHdf5Tables(const std::string& path);

/// Finds out before the work. @throw IoError if there can be no such file, or HDF5 was not there
/// when this was built.
void checkHdf5Tables(const std::string& path);

/// Whole or not at all, with the same bytes whenever it is written. @throw IoError
void writeHdf5Tables(const std::string& path, const Hdf5Tables& tables);

}  // namespace vdb_madf::detail
