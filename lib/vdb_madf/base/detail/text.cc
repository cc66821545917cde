// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/detail/text.h"

#include <algorithm>
#include <charconv>

namespace vdb_madf::detail {

namespace {

constexpr size_t kMaxQuote = 60;

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

double decimalOf(float value) {
  return reals(shortestDecimal(value)).value_or(std::vector<double>{double(value)}).front();
}

std::string inQuotes(const std::string& text) {
  std::string printable = "'" + text.substr(0, kMaxQuote);
  for (char& c : printable)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
  return printable + (text.size() > kMaxQuote ? "...'" : "'");
}

std::optional<std::vector<int64_t>> integers(const std::string& text) {
  return numbers<int64_t>(text);
}

std::optional<std::vector<double>> reals(const std::string& text) {
  return numbers<double>(text);
}

}  // namespace vdb_madf::detail
