// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/given_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <sstream>

#include "vdb_madf/base/counted.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf {

namespace {

using Cells = std::vector<std::string>;

/// A line of cells; those in quotation marks may go on in the next one.
bool readCells(std::istream& table, Cells& cells) {
  cells.assign(1, "");
  if (table.peek() == EOF) return false;
  bool isQuoted = false;
  for (int c = table.get(); c != EOF; c = table.get()) {
    if (c == '"' && isQuoted && table.peek() == '"')
      cells.back() += char(table.get());
    else if (c == '"' && (isQuoted || cells.back().empty()))
      isQuoted = !isQuoted;
    else if (isQuoted)
      cells.back() += char(c);
    else if (c == ',')
      cells.emplace_back();
    else if (c == '\n')
      break;
    else if (c != '\r' || table.peek() != '\n')
      cells.back() += char(c);
  }
  if (isQuoted) throw InvalidInput("a quotation mark is never closed");
  return true;
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

/// With an underscore for what cannot be part of a name, but for those at the ends.
std::string nameOf(const std::string& text) {
  std::string name;
  bool isApart = false;
  for (const char c : text) {
    const bool isPart = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (isPart && isApart && !name.empty()) name += '_';
    isApart = !isPart;
    if (isPart) name += c;
  }
  return name;
}

bool isMissing(const std::string& cell) {
  return cell.empty() || cell == "NA" || cell == "N/A" || cell == "NaN" || cell == "nan";
}

}  // namespace

GivenTable givenColumns(const std::string& csv, bool ofLaterScan) {
  std::istringstream lines(csv);
  Cells names, cells;
  readCells(lines, names);
  if (const std::string mark = "\xEF\xBB\xBF"; names[0].rfind(mark, 0) == 0)
    names[0].erase(0, mark.size());  // as spreadsheets write it
  const bool isOfTracks = find(names, "side") && find(names, "grain") && find(names, "track");
  const size_t side = isOfTracks ? *find(names, "side") : names.size();
  const auto grain = isOfTracks && ofLaterScan ? find(names, "track")
                     : find(names, "grain")    ? find(names, "grain")
                                               : find(names, "id");
  if (!grain)
    throw InvalidInput("has no column 'grain' or 'id' that says of which grain a line is");
  std::vector<GivenColumn> columns(names.size());
  std::vector<bool> isNumber;
  const auto isOfGrain = [&](size_t n) {
    return n == *grain || names[n] == "grain" || names[n] == "track";
  };
  std::set<std::string> taken;
  for (size_t n = 0; n < names.size(); ++n) {
    columns[n].name = nameOf(names[n]);
    isNumber.push_back(!isOfGrain(n) && n != side && !columns[n].name.empty() &&
                       taken.insert(columns[n].name).second);
  }
  std::map<int32_t, int> seen;
  for (int number = 2; readCells(lines, cells); ++number) {
    if (cells == Cells{""}) continue;
    const std::string where = "line " + std::to_string(number) + ": ";
    if (cells.size() != names.size())
      throw InvalidInput(where + "has " + counted(cells.size(), "cell") + ", and the first " +
                         std::to_string(names.size()));
    if (isOfTracks && cells[side] != (ofLaterScan ? "after" : "before")) continue;
    const auto id = numberOf(cells[*grain]);
    constexpr double kMost = std::numeric_limits<int32_t>::max();
    if (!id || !(*id >= 1 && *id <= kMost) || *id != std::floor(*id))
      throw InvalidInput(where + "'" + cells[*grain] + "' is no number of a grain");
    if (seen[int32_t(*id)]++) throw InvalidInput(where + "grain " + cells[*grain] + " comes twice");
    for (size_t n = 0; n < names.size(); ++n) {
      if (!isNumber[n] || isMissing(cells[n])) continue;
      const auto value = numberOf(cells[n]);
      isNumber[n] = value.has_value();
      if (value && std::isfinite(*value)) columns[n].values[int32_t(*id)] = *value;
    }
  }
  GivenTable result;
  for (size_t n = 0; n < names.size(); ++n)
    if (isNumber[n] && !columns[n].values.empty())
      result.columns.push_back(std::move(columns[n]));
    else if (!isOfTracks && !isOfGrain(n))
      result.leftOut.push_back(names[n]);
  if (result.columns.empty()) throw InvalidInput("has no column of numbers");
  return result;
}

std::string noteOnGiven(const std::vector<GivenColumn>& columns,
                        const std::vector<GrainMeasures>& grains) {
  std::set<int32_t> known, given;
  for (const GrainMeasures& grain : grains) known.insert(grain.id);
  for (const GivenColumn& column : columns)
    for (const auto& [id, value] : column.values) given.insert(id);
  const auto strangers =
      std::count_if(given.begin(), given.end(), [&](int32_t id) { return known.count(id) == 0; });
  if (strangers == 0) return "";
  return std::to_string(strangers) + " of its " + counted(int64_t(given.size()), "grain") +
         " are not among those of the labels";
}

}  // namespace vdb_madf
