// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/detail/text.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string>

#ifndef __cpp_lib_to_chars
#include <locale.h>
#endif

namespace vdb_madf::detail {

namespace {

constexpr size_t kMaxQuote = 60;

constexpr char kWhite[] = " \t\r\n\f\v";

template <typename T>
std::from_chars_result readNumber(const char* begin, const char* end, T& value) {
  return std::from_chars(begin, end, value);
}

#ifndef __cpp_lib_to_chars
/// libc++ before 20 reads integers alone in this way.
std::from_chars_result readNumber(const char* begin, const char* end, double& value) {
  static const locale_t kPoint = ::newlocale(LC_ALL_MASK, "C", nullptr);
  const std::string text(begin, end);
  char* last = nullptr;
  value = ::strtod_l(text.c_str(), &last, kPoint);
  const bool isRead = last != text.c_str() && *begin != '+' && *begin != ' ';
  return {begin + (last - text.c_str()), isRead ? std::errc() : std::errc::invalid_argument};
}
#endif

std::string withPrecision(double value, std::chars_format format, int digits) {
  char text[400];  // 1.8e308 has 309 digits before the point
  return {text, std::to_chars(text, text + sizeof text, value, format, digits).ptr};
}

template <typename T>
std::optional<std::vector<T>> numbers(const std::string& text) {
  std::vector<T> values;
  size_t begin = 0;
  while ((begin = text.find_first_not_of(kWhite, begin)) != std::string::npos) {
    const size_t end = std::min(text.find_first_of(kWhite, begin), text.size());
    const char* first = text.data() + begin;
    if (*first == '+') ++first;
    T value{};
    const auto result = readNumber(first, text.data() + end, value);
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

double decimalOf(float value) {
  return reals(shortestDecimal(value)).value_or(std::vector<double>{double(value)}).front();
}

std::string inQuotes(const std::string& text) {
  std::string printable = "'" + text.substr(0, kMaxQuote);
  for (char& c : printable)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
  return printable + (text.size() > kMaxQuote ? "...'" : "'");
}

LeadingReal leadingReal(const std::string& text) {
  const size_t begin = text.find_first_not_of(kWhite);
  if (begin == std::string::npos) return {};
  const char* first = text.data() + begin;
  if (*first == '+' && first[1] != '-') ++first;
  LeadingReal result;
  const auto [end, error] = readNumber(first, text.data() + text.size(), result.value);
  if (error == std::errc()) result.length = size_t(end - text.data());
  return result;
}

std::string generalDecimal(double value, int digits) {
  return withPrecision(value, std::chars_format::general, digits);
}

std::string fixedDecimal(double value, int digits) {
  return withPrecision(value, std::chars_format::fixed, digits);
}

std::optional<std::vector<int64_t>> integers(const std::string& text) {
  return numbers<int64_t>(text);
}

std::optional<std::vector<double>> reals(const std::string& text) {
  return numbers<double>(text);
}

std::string markupEscaped(const std::string& text) {
  std::string result;
  for (const char c : text)
    result += c == '&'   ? "&amp;"
              : c == '<' ? "&lt;"
              : c == '>' ? "&gt;"
              : c == '"' ? "&quot;"
                         : std::string(1, c);
  return result;
}

}  // namespace vdb_madf::detail
