// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace vdb_madf::detail {

/// Sorts what a list has from `first` on, and keeps one of what is equal there.
template <typename T>
void sortUnique(std::vector<T>& list, size_t first = 0) {
  const auto begin = list.begin() + std::ptrdiff_t(first);
  std::sort(begin, list.end());
  list.erase(std::unique(begin, list.end()), list.end());
}

/// The index of a value in an ascending list, or of the next larger one.
template <typename T, typename Value>
size_t sortedIndex(const std::vector<T>& list, const Value& value) {
  return size_t(std::lower_bound(list.begin(), list.end(), value) - list.begin());
}

/// The index of a value in an ascending list; none: it is not there.
template <typename T, typename Value>
std::optional<size_t> findSorted(const std::vector<T>& list, const Value& value) {
  const size_t index = sortedIndex(list, value);
  return index < list.size() && list[index] == value ? std::optional(index) : std::nullopt;
}

}  // namespace vdb_madf::detail
