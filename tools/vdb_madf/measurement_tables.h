// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "json_file.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf::tools {

constexpr double kIceDensity = 917;  // kg/m^3, at 0 degrees Celsius

/// grains.csv, bonds.csv and sample.json in a folder, which is made if it is not there. Made before
/// the work, so that a folder that cannot be written to is told at once. The files appear whole or
/// not at all.
class MeasurementTables {
 public:
  /// @throw IoError
  explicit MeasurementTables(const std::string& folder);
  ~MeasurementTables();
  MeasurementTables(const MeasurementTables&) = delete;
  MeasurementTables& operator=(const MeasurementTables&) = delete;

  /// Lengths in the unit of the voxel size, which the columns name, else in voxels.
  /// @return what sample.json holds. @throw IoError
  Json write(const Measurements& measurements, double iceDensity = kIceDensity);

  /// The paths of the three files.
  static std::vector<std::string> paths(const std::string& folder);

 private:
  std::string folder_;
  bool made_ = false, done_ = false;
  std::vector<std::unique_ptr<OutputFile>> files_;
};

}  // namespace vdb_madf::tools
