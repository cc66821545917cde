// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/point_numbers.h"

#include <utility>

namespace vdb_madf::detail {

void PointNumbers::count(const std::vector<Coord>& points) {
  std::vector<Column> all;
  auto known = columns_.begin();
  for (const Coord& p : points) {
    const Column column{p.x(), p.y(), 0};
    while (known != columns_.end() && !isBefore(column, *known)) all.push_back(*known++);
    if (all.empty() || isBefore(all.back(), column)) all.push_back(column);
    ++all.back().number;
  }
  all.insert(all.end(), known, columns_.end());
  columns_ = std::move(all);
}

void PointNumbers::finish() {
  uint32_t number = 1;
  for (Column& column : columns_) number += std::exchange(column.number, number);
}

std::vector<uint32_t> PointNumbers::next(const std::vector<Coord>& points) {
  std::vector<uint32_t> numbers;
  auto column = columns_.begin();
  for (const Coord& p : points) {
    while (isBefore(*column, {p.x(), p.y(), 0})) ++column;
    numbers.push_back(column->number++);
  }
  return numbers;
}

}  // namespace vdb_madf::detail
