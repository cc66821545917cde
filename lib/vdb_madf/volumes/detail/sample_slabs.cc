// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/detail/sample_slabs.h"

#include <algorithm>
#include <type_traits>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/grid_slabs.h"
#include "vdb_madf/grids/detail/number_grids.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/detail/slabs.h"

namespace vdb_madf::detail {

void requireNumbers(const std::string& name, const openvdb::GridBase& grid) {
  if (!grid.apply<NumberGrids>([](const auto&) {}))
    throw InvalidInput(name + ": grid '" + grid.getName() + "' of type " + grid.valueType() +
                       " cannot be an image: only " + kNumberGrids + " can");
}

void forEachSampleSlab(const std::string& name, const openvdb::GridBase& grid, const CoordBBox& box,
                       SampleType type, Interrupter* interrupter,
                       const std::function<void(int z, int count, const void* samples)>& f) {
  const size_t slice = size_t(box.dim().x()) * size_t(box.dim().y());
  const size_t slab = slice * size_t(std::min(kSlab, box.dim().z()));
  grid.apply<NumberGrids>([&](const auto& numbers) {
    using Tree = std::decay_t<decltype(numbers.tree())>;
    // The interior of a level set is inactive.
    using ValueOf = std::conditional_t<std::is_floating_point_v<typename Tree::ValueType>,
                                       StoredValue, ActiveValue>;
    using Slabs = GridSlabs<Tree, ValueOf>;
    using Value = typename Slabs::Value;
    const Slabs slabs(numbers.tree(), box);
    std::vector<Value> values(slab);
    withSampleType(type, [&](auto sample) {
      using Sample = decltype(sample);
      std::vector<Sample> samples(std::is_same_v<Sample, Value> ? 0 : slab);
      forEachSlab(box.min().z(), box.max().z() + 1, interrupter, [&](int z, int count) {
        slabs.readInParallel(z, count, values.data());
        if constexpr (std::is_same_v<Sample, Value>) {
          f(z, count, values.data());
        } else {
          convertSamples(name, values.data(), slice * size_t(count), type, samples.data());
          f(z, count, samples.data());
        }
      });
    });
  });
}

}  // namespace vdb_madf::detail
