// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/given_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "vdb_madf/base/counted.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf {

namespace {

using Cells = std::vector<std::string>;

Cells cellsOf(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  Cells cells(1);
  for (const char c : line)
    if (c == ',')
      cells.emplace_back();
    else
      cells.back() += c;
  return cells;
}

std::optional<double> numberOf(const std::string& cell) {
  const auto numbers = detail::reals(cell);
  if (!numbers || numbers->size() != 1) return std::nullopt;
  return numbers->front();
}

std::optional<size_t> find(const Cells& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return size_t(found - names.begin());
}

bool isName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

}  // namespace

std::vector<GivenColumn> givenColumns(const std::string& csv, bool ofLaterScan) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  const Cells names = cellsOf(line);
  const auto side = find(names, "side");
  const auto grain = side && ofLaterScan    ? find(names, "track")
                     : find(names, "grain") ? find(names, "grain")
                                            : find(names, "id");
  if (!grain)
    throw InvalidInput("has no column 'grain' or 'id' that says of which grain a line is");
  std::vector<GivenColumn> columns(names.size());
  std::vector<bool> isNumber;
  for (size_t n = 0; n < names.size(); ++n) {
    columns[n].name = names[n];
    const bool isNumberOfGrain = n == *grain || names[n] == "grain" || names[n] == "track";
    isNumber.push_back(!isNumberOfGrain && n != side && isName(names[n]));
  }
  std::map<int32_t, int> seen;
  for (int number = 2; std::getline(lines, line); ++number) {
    const Cells cells = cellsOf(line);
    if (cells == Cells{""}) continue;
    const std::string where = "line " + std::to_string(number) + ": ";
    if (cells.size() != names.size())
      throw InvalidInput(where + "has " + counted(cells.size(), "cell") + ", and the first " +
                         std::to_string(names.size()));
    if (side && cells[*side] != (ofLaterScan ? "after" : "before")) continue;
    const auto id = numberOf(cells[*grain]);
    constexpr double kMost = std::numeric_limits<int32_t>::max();
    if (!id || !(*id >= 1 && *id <= kMost) || *id != std::floor(*id))
      throw InvalidInput(where + "'" + cells[*grain] + "' is no number of a grain");
    if (seen[int32_t(*id)]++) throw InvalidInput(where + "grain " + cells[*grain] + " comes twice");
    for (size_t n = 0; n < names.size(); ++n) {
      if (!isNumber[n] || cells[n].empty()) continue;
      const auto value = numberOf(cells[n]);
      isNumber[n] = value.has_value();
      if (value && std::isfinite(*value)) columns[n].values[int32_t(*id)] = *value;
    }
  }
  std::vector<GivenColumn> kept;
  for (size_t n = 0; n < names.size(); ++n)
    if (isNumber[n] && !columns[n].values.empty()) kept.push_back(std::move(columns[n]));
  if (kept.empty()) throw InvalidInput("has no column of numbers");
  return kept;
}

}  // namespace vdb_madf
