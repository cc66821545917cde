// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf::detail {

// std::floor and std::ceil for values that fit an int: without SSE 4.1 those are calls.
inline int floorOf(double value) {
  const int whole = int(value);
  return whole - (double(whole) > value);
}
inline int ceilOf(double value) {
  const int whole = int(value);
  return whole + (double(whole) < value);
}

}  // namespace vdb_madf::detail
