// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/measure/columns.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf::detail {

/// The number in a row of a column, where voxels have these edges: nine digits; whole numbers
/// whole; empty where there is no value.
std::string measureText(const MeasureColumn& column, size_t row, const openvdb::Vec3d& edges);

/// The measures of grains by the names and in the units of the table of grains, as text of JSON.
class GrainTable {
 public:
  explicit GrainTable(const Measurements& measured);

  size_t rows() const { return columns_.front().values.size(); }
  size_t columns() const { return columns_.size(); }  ///< the first holds the labels
  const MeasureColumn& column(size_t i) const { return columns_[i]; }
  const std::string& name(size_t column) const { return names_[column]; }
  /// False where a measure is not known.
  bool isKnown(size_t row, size_t column) const;
  std::string number(size_t row, size_t column) const {
    return measureText(columns_[column], row, edges_);
  }

 private:
  std::vector<MeasureColumn> columns_;
  std::vector<std::string> names_;
  openvdb::Vec3d edges_;  ///< of a voxel, in the unit
};

}  // namespace vdb_madf::detail
