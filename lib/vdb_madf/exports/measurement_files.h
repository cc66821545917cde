// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/files/output_folder.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

namespace detail {
class OutputStream;
}

constexpr double kIceDensity = 917;  // kg/m^3, at 0 degrees Celsius

/// What the tables say besides the measures.
struct TableOptions {
  std::string labels;  ///< where they are, such as the path of their file; empty: not said
  /// Name of the sample: the first column of both tables, so that those of several samples can be
  /// joined. Empty: no such column.
  std::string sample;
  /// Density of the grains' material, kg/m^3, above 0; none: nothing is said of masses.
  std::optional<double> density;
  std::string unit{};  ///< of lengths, as TableUnit takes it
};

/// The texts of the three files below.
struct MeasurementTexts {
  std::string grains, bonds;  ///< comma-separated values
  std::string sample;         ///< JSON in ASCII or UTF-8
};
MeasurementTexts measurementTexts(const Measurements& measurements,
                                  const TableOptions& options = {});

/// Reads a file for parseSizeReference(). @throw InvalidInput, which names the file, too; IoError
SizeReference readSizeReference(const std::string& path);

/// sizeCurve() as comma-separated values, with units as in the tables. @pre measured with sizes
std::string sizeCurveText(const Measurements& measurements, const TableOptions& options = {});

/// bridgeColumns() likewise. @pre measured with binder
std::string bridgesText(const Measurements& measurements, const TableOptions& options = {});

/// grains.csv, bonds.csv and sample.json in a folder, which is made if it is not there. Made before
/// the work, so that a folder that cannot be written to is reported before it. The files appear
/// whole or not at all. A run replaces the files of an earlier one; if one of them is there without
/// the others, it is not of a run, and is left alone.
///
/// The columns are those of columns.h; lengths are in the unit asked for, else in that of the voxel
/// size, else in voxels, and names end with it. An unknown number is an empty cell, or null.
/// sample.json also says where the numbers come from: our version, the labels and their digest, and
/// of the metadata of their grid the numbers and texts whose names begin with `madf_`.
///
/// A name that ends with .h5 or .hdf5 is that of one HDF5 file instead, with the same bytes
/// whenever it is written: groups `grains` and `bonds` with a dataset per column, named without the
/// unit, which is its attribute `units` ("mm", "mm^2", "1/mm"; none of plain numbers); counts are
/// int64 (if all are known), other numbers float64 with all their digits, NaN if unknown. The
/// members of the group `sample` are those of sample.json, lists as arrays, true and false as 1 and
/// 0; it has the name of the sample.
class MeasurementTables {
 public:
  /// @throw IoError, also for HDF5 if it was not there when this was built
  explicit MeasurementTables(const std::string& folder);
  ~MeasurementTables();
  MeasurementTables(const MeasurementTables&) = delete;
  MeasurementTables& operator=(const MeasurementTables&) = delete;

  /// @throw IoError
  void write(const Measurements& measurements, const TableOptions& options = {});

  /// The paths of the three files, or of the one.
  static std::vector<std::string> paths(const std::string& folder);

 private:
  std::optional<OutputFolder> folder_;  // goes after the files
  std::vector<std::unique_ptr<detail::OutputStream>> files_;
  std::string file_;  ///< the one of HDF5; empty: those above
};

}  // namespace vdb_madf
