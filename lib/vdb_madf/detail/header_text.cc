// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/detail/header_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "vdb_madf/errors.h"

namespace vdb_madf::detail {

namespace {

constexpr int64_t kLargestSize = int64_t(1) << 20;
constexpr size_t kLongestQuote = 60;
/// Lengths beyond these are no voxels, and break transforms: an atom, a kilometre.
constexpr double kSmallestVoxel = 1e-10, kLargestVoxel = 1e3;
constexpr double kUnequal = 1.001;

constexpr char kWhite[] = " \t\r\n\f\v";

template <typename T>
std::optional<std::vector<T>> numbers(const std::string& text) {
  std::vector<T> values;
  size_t begin = 0;
  while ((begin = text.find_first_not_of(kWhite, begin)) != std::string::npos) {
    const size_t end = std::min(text.find_first_of(kWhite, begin), text.size());
    const char* first = text.data() + begin;
    if (*first == '+') ++first;
    T value{};
    const auto result = std::from_chars(first, text.data() + end, value);
    if (result.ec != std::errc() || result.ptr != text.data() + end) return std::nullopt;
    values.push_back(value);
    begin = end;
  }
  return values;
}

}  // namespace

std::string trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(kWhite);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(kWhite) - begin + 1);
}

std::string lowerCase(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return text;
}

std::string quoted(const std::string& text) {
  std::string printable = "'" + text.substr(0, kLongestQuote);
  for (char& c : printable)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
  return printable + (text.size() > kLongestQuote ? "...'" : "'");
}

std::optional<std::vector<int64_t>> integers(const std::string& text) {
  return numbers<int64_t>(text);
}

std::optional<std::vector<double>> reals(const std::string& text) {
  return numbers<double>(text);
}

std::string lengthIn(double unitsPerMetre, double metres) {
  const double value = metres * unitsPerMetre;
  for (const double candidate : {value, std::nextafter(value, 0.0), std::nextafter(value, 1e300)})
    if (candidate / unitsPerMetre == metres) {
      // 8.499999999999999 and 8.5 may both give 8.5e-6 back: the shorter is meant.
      char text[40];
      const auto end =
          std::to_chars(text, text + sizeof text, candidate, std::chars_format::general, 15).ptr;
      double rounded = 0;
      std::from_chars(text, end, rounded);
      if (rounded / unitsPerMetre == metres) return std::string(text, end);
      return shortestDecimal(candidate);
    }
  return shortestDecimal(value);
}

std::string besideHeader(const std::string& header, const std::string& name) {
  return (std::filesystem::path(header).parent_path() / name).string();
}

std::optional<double> unitsPerMetre(const std::string& unit) {
  static const std::map<std::string, double> kUnits = {{"nm", 1e9},
                                                       {"nanometer", 1e9},
                                                       {"nanometre", 1e9},
                                                       {"um", 1e6},
                                                       {"micron", 1e6},
                                                       {"micrometer", 1e6},
                                                       {"micrometre", 1e6},
                                                       {"\u00b5m", 1e6},   // micro sign, UTF-8
                                                       {"\u03bcm", 1e6},   // Greek mu, UTF-8
                                                       {"\xb5m", 1e6},     // micro sign, Latin-1
                                                       {"\\u00b5m", 1e6},  // as ImageJ escapes it
                                                       {"mm", 1e3},
                                                       {"millimeter", 1e3},
                                                       {"millimetre", 1e3},
                                                       {"cm", 1e2},
                                                       {"centimeter", 1e2},
                                                       {"centimetre", 1e2},
                                                       {"m", 1},
                                                       {"meter", 1},
                                                       {"metre", 1}};
  std::string name = lowerCase(trimmed(unit));
  auto found = kUnits.find(name);
  if (found == kUnits.end() && name.size() > 2 && name.back() == 's') {
    name.pop_back();
    found = kUnits.find(name);
  }
  if (found == kUnits.end()) return std::nullopt;
  return found->second;
}

std::optional<VoxelSize> cubicVoxelSize(const std::string& path,
                                        const std::array<double, 3>& spacing,
                                        std::optional<double> unitsPerMetre) {
  const auto [least, most] = std::minmax_element(spacing.begin(), spacing.end());
  const bool positive = std::all_of(spacing.begin(), spacing.end(),
                                    [](double s) { return std::isfinite(s) && s > 0; });
  if (!positive || *most > *least * kUnequal)
    throw IoError(path + ": " + (positive ? "unequal" : "unusable") + " spacing " +
                  shortestDecimal(spacing[0]) + ", " + shortestDecimal(spacing[1]) + ", " +
                  shortestDecimal(spacing[2]) + ": resample it to cubic voxels");
  if (!unitsPerMetre) return std::nullopt;
  const double metres = spacing[0] / *unitsPerMetre;
  if (metres < kSmallestVoxel || metres > kLargestVoxel)
    throw IoError(path + ": a voxel size of " + shortestDecimal(metres) +
                  " m is not plausible: correct the header");
  return VoxelSize{metres};
}

Coord checkedSize(const std::string& path, const std::vector<int64_t>& size) {
  if (size.size() != 3)
    throw IoError(path + ": has " + std::to_string(size.size()) +
                  " dimensions; only 3-D images can be read");
  for (const int64_t n : size)
    if (n < 1 || n > kLargestSize)
      throw IoError(path + ": size " + std::to_string(size[0]) + " x " + std::to_string(size[1]) +
                    " x " + std::to_string(size[2]) + " is not within 1 .. " +
                    std::to_string(kLargestSize) + " a side");
  return Coord(int(size[0]), int(size[1]), int(size[2]));
}

void checkSlices(const std::string& path, const ImageInfo& info, int first, int count) {
  if (first < 0 || count < 0 || count > info.size.z() || first > info.size.z() - count)
    throw InvalidInput(path + ": has slices 0 .. " + std::to_string(info.size.z() - 1) + ", not " +
                       std::to_string(first) + " and " + std::to_string(count) + " in all");
}

}  // namespace vdb_madf::detail
