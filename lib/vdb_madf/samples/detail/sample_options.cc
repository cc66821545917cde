// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/sample_options.h"

#include <fmt/core.h>
#include <openvdb/Metadata.h>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/grid_metadata.h"

namespace vdb_madf::detail {

void checkSize(const Coord& size) {
  for (int axis = 0; axis < 3; ++axis)
    if (size[axis] < 1 || size[axis] > kMaxExtent)
      throw InvalidInput(fmt::format("size must be 1 to {} voxels along each axis, not {}",
                                     kMaxExtent, size[axis]));
}

void checkRange(const char* name, double value, double lower, double upper) {
  if (!(value >= lower && value <= upper))  // false for NaN, too
    throw InvalidInput(fmt::format("{} must be {} to {}, not {}", name, shortestDecimal(lower),
                                   shortestDecimal(upper), shortestDecimal(value)));
}

void checkRadii(double minimum, double maximum) {
  checkRange("radius", minimum, kMinRadius, kMaxExtent);
  checkRange("radius", maximum, kMinRadius, kMaxExtent);
  if (minimum > maximum)
    throw InvalidInput("smallest radius " + shortestDecimal(minimum) + " exceeds the largest, " +
                       shortestDecimal(maximum));
}

void checkFraction(double fraction) {
  if (!(fraction > 0 && fraction < 1))
    throw InvalidInput("fraction must lie between 0 and 1, not be " + shortestDecimal(fraction));
}

void checkCount(int count) {
  if (count < 1) throw InvalidInput("count must be 1 or more, not " + std::to_string(count));
}

SourceText SourceText::of(const openvdb::GridBase& grid) {
  SourceText source;
  source.text_ = grid.metaValue<std::string>(kSourceKey);
  return source;
}

SourceText& SourceText::add(const char* option, const std::string& value) {
  text_ += std::string(" --") + option + " " + value;
  return *this;
}

SourceText& SourceText::size(const Coord& size) {
  return add("dims", fmt::format("{}x{}x{}", size.x(), size.y(), size.z()));
}

SourceText& SourceText::range(const char* option, double lower, double upper) {
  return add(option, shortestDecimal(lower) + ":" + shortestDecimal(upper));
}

SourceText& SourceText::edges(const std::optional<VoxelSize>& voxelSize) {
  if (!voxelSize || voxelSize->isCube()) return *this;
  const auto edges = voxelSize->edgesInUnit();
  return add("voxel-size",
             fmt::format("{}x{}x{}{}", shortestDecimal(edges[0]), shortestDecimal(edges[1]),
                         shortestDecimal(edges[2]), voxelSize->unit()));
}

Sample described(Sample sample, const Coord& size, const SourceText& source,
                 const std::optional<VoxelSize>& voxelSize) {
  const auto describe = [&](openvdb::GridBase& grid, const char* name) {
    grid.setName(name);
    setDomain(grid, CoordBBox(Coord(0), size.offsetBy(-1)));
    setVoxelSize(grid, voxelSize);
    grid.insertMeta(kSourceKey, openvdb::StringMetadata(source.str()));
  };
  describe(*sample.object, "object");
  if (sample.truth) describe(*sample.truth, "truth");
  return sample;
}

}  // namespace vdb_madf::detail
