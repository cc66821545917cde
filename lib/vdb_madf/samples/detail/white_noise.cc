// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/white_noise.h"

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/samples/detail/random.h"

namespace vdb_madf::detail {

FloatBox whiteNoise(const CoordBBox& box, uint64_t seed, uint64_t stream,
                    Interrupter* interrupter) {
  FloatBox field(box);
  const WhiteNoise noise(seed, stream);
  const size_t planes = size_t(box.dim().x());
  const size_t grain = field.values.size() < kSequentialValues ? planes : 1;
  parallelFor(planes, grain, interrupter, [&](size_t begin, size_t end) {
    for (int x = box.min().x() + int(begin); x < box.min().x() + int(end); ++x)
      for (int y = box.min().y(); y <= box.max().y(); ++y) {
        const uint64_t row = noise.row(x, y);
        float* values = field.values.data() + field.offset(x, y, box.min().z());
        for (int z = box.min().z(); z <= box.max().z(); ++z) *values++ = noise.value(row, z);
      }
  });
  return field;
}

}  // namespace vdb_madf::detail
