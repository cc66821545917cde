// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/detail/near_squares.h"

#include <algorithm>

namespace vdb_madf::detail {

std::vector<int16_t> nearSquares(const std::array<size_t, 3>& sizes,
                                 const std::vector<uint8_t>& isSource, int reach) {
  const auto beyond = int16_t((reach + 1) * (reach + 1));
  std::vector<int16_t> squares(isSource.size()), next;
  std::transform(isSource.begin(), isSource.end(), squares.begin(),
                 [&](uint8_t source) { return source ? int16_t(0) : beyond; });
  size_t step = 1;
  for (size_t axis = 3; axis-- > 0; step *= sizes[axis]) {
    next = squares;
    const size_t block = step * sizes[axis];  // whole lines of the axis
    for (size_t first = 0; first < squares.size(); first += block)
      for (size_t d = 1; d <= size_t(reach) && d < sizes[axis]; ++d) {
        const auto square = int16_t(d * d);
        const size_t apart = d * step, count = block - apart;
        const int16_t* from = squares.data() + first;
        int16_t* to = next.data() + first;
        for (size_t i = 0; i < count; ++i)
          to[i] = std::min(to[i], int16_t(from[i + apart] + square));
        for (size_t i = 0; i < count; ++i)
          to[i + apart] = std::min(to[i + apart], int16_t(from[i] + square));
      }
    squares.swap(next);
  }
  for (int16_t& square : squares) square = std::min(square, beyond);
  return squares;
}

}  // namespace vdb_madf::detail
