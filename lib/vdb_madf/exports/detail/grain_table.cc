// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/grain_table.h"

#include <charconv>
#include <cmath>

#include "vdb_madf/measure/table_unit.h"

namespace vdb_madf::detail {

std::string measureText(const MeasureColumn& column, size_t row, const openvdb::Vec3d& edges) {
  const double value = column.values[row];
  if (std::isnan(value)) return "";
  if (column.isWhole()) return std::to_string(int64_t(value));
  const double number = scaled(column, value, edges);
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, number == 0 ? 0.0 : number,
                                 std::chars_format::general, 9);
  return {text, end.ptr};
}

GrainTable::GrainTable(const Measurements& measured)
    : columns_(grainColumns(measured.grains)), edges_(TableUnit(measured).edges) {
  const std::string unit = TableUnit(measured).name;
  for (const MeasureColumn& column : columns_)
    names_.push_back(column.name + unitSuffix(column.power, unit));
}

bool GrainTable::isKnown(size_t row, size_t column) const {
  return std::isfinite(columns_[column].values[row]);
}

}  // namespace vdb_madf::detail
