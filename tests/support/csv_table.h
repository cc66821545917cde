// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.h"

namespace vdb_madf::test {

/// A table that the command wrote.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;

  explicit Table(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::vector<std::string> cells;
      std::string cell;
      std::istringstream row(line + ",");
      while (std::getline(row, cell, ',')) cells.push_back(cell);
      if (names.empty())
        names = cells;
      else
        rows.push_back(cells);
    }
  }
  size_t column(const std::string& name) const {
    const auto found = std::find(names.begin(), names.end(), name);
    INFO(name);
    REQUIRE(found != names.end());
    return size_t(found - names.begin());
  }
  double at(size_t row, const std::string& name) const {
    return std::stod(rows.at(row).at(column(name)));
  }
  double sum(const std::string& name) const {
    double sum = 0;
    for (size_t i = 0; i < rows.size(); ++i) sum += at(i, name);
    return sum;
  }
};

}  // namespace vdb_madf::test
