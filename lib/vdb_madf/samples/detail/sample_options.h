// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/samples/sample.h"

namespace vdb_madf::detail {

/// A smaller ball is no voxel, most of the time.
constexpr double kMinRadius = 0.5;

/// Each @throw InvalidInput, one line that names the option and its range.
void checkSize(const Coord& size);
void checkRadii(double minimum, double maximum);
void checkFraction(double fraction);
void checkCount(int count);
/// `name` must be finite and lie in [lower, upper].
void checkRange(const char* name, double value, double lower, double upper);

/// The words of a `generate` command, as the metadata `madf_source` records them.
class SourceText {
 public:
  explicit SourceText(const std::string& sample) : text_("generate " + sample) {}
  /// The source that a grid has, to add to it.
  static SourceText of(const openvdb::GridBase& grid);
  SourceText& size(const Coord& size);
  SourceText& add(const char* option, const std::string& value);
  SourceText& add(const char* option, double value) { return add(option, shortestDecimal(value)); }
  SourceText& range(const char* option, double lower, double upper);
  /// Adds the edges of voxels that are no cubes.
  SourceText& edges(const std::optional<VoxelSize>& voxelSize);
  const std::string& str() const { return text_; }

 private:
  SourceText() = default;

  std::string text_;
};

/// Gives the grids of a sample their names, the domain [0, size - 1] in voxels, the source and the
/// size of the voxels.
Sample described(Sample sample, const Coord& size, const SourceText& source,
                 const std::optional<VoxelSize>& voxelSize = {});

}  // namespace vdb_madf::detail
