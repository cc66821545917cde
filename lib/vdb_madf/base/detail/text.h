// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace vdb_madf::detail {

/// True for 0 to 9, in every locale.
inline bool isDigit(char c) {
  return c >= '0' && c <= '9';
}
/// Drops the white space at both ends.
std::string trimmed(const std::string& text);
/// Text of a file in quotes for a message: printable, one line, clipped to 60 characters.
std::string inQuotes(const std::string& text);
/// The text as numbers between white space, in any locale; none if it holds anything else.
std::optional<std::vector<int64_t>> integers(const std::string& text);
std::optional<std::vector<double>> reals(const std::string& text);
/// The number that a text begins with, after white space and a plus sign, and how many characters
/// it takes: 0 if there is none. The decimal sign is a point in every locale.
struct LeadingReal {
  double value = 0;
  size_t length = 0;
};
LeadingReal leadingReal(const std::string& text);
/// What printf makes of %.<digits>g and %.<digits>f, but with a point in every locale.
std::string generalDecimal(double value, int digits);
std::string fixedDecimal(double value, int digits);
/// The shortest decimal that reads back as the same number. Returns its end; it has at most
/// kDecimalBytes.
constexpr size_t kDecimalBytes = 64;
template <typename T>
char* writeDecimal(T value, char* text) {
  return std::to_chars(text, text + kDecimalBytes, value).ptr;
}
template <typename T>
std::string shortestDecimal(T value) {
  char text[kDecimalBytes];
  return {text, writeDecimal(value, text)};
}
/// The double that prints like the float: 0.0085 rather than 0.008500000461935997.
double decimalOf(float value);
/// Text for HTML and XML: & < > " become references.
std::string markupEscaped(const std::string& text);

}  // namespace vdb_madf::detail
