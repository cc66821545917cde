// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <atomic>
#include <string>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/files/output_tree.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

enum class ZarrVersion { two = 2, three = 3 };

/// What becomes of the active values above 0 of a tree; all else is 0.
enum class ZarrSamples {
  label,  ///< uint32, as they are
  mask,   ///< uint8, 255
  gray    ///< uint8, as they are
};

/// Voxels along each edge of a chunk, or as many as the array has.
constexpr int kZarrChunk = 64;

/// An array [z, y, x] of a box, at `name` within a folder: its description, and chunks by gzip,
/// layer by layer. Chunks of background alone are left out, but for the first where there would be
/// none: an array without any looks like one whose chunks were lost.
class ZarrArray {
 public:
  /// Writes the description. The folder must live as long. @throw IoError
  ZarrArray(const OutputTree& folder, std::string name, const CoordBBox& box, ZarrSamples samples,
            ZarrVersion version);

  /// Layers of chunks along z, from the lowest slices of the box on.
  int layerCount() const;
  int firstSlice(int layer) const { return box_.min().z() + layer * edges_.z(); }

  /// Writes the chunks in the layers [begin, end), all of whose values are there. Memory: a chunk
  /// per thread. @param values without active tiles
  /// @throw IoError; Interrupted
  void write(const Int32Tree& values, int begin, int end, Interrupter* interrupter);
  /// Completes the array when all layers are written. @throw IoError
  void finish() const;

 private:
  std::string chunkName(const Coord& number) const;
  void writeDescription() const;

  const OutputTree& folder_;
  std::string name_;
  CoordBBox box_;
  Coord edges_;  // of a chunk
  ZarrSamples samples_;
  ZarrVersion version_;
  std::atomic<bool> isEmpty_{true};
};

/// Writes a group's description. @param attributes a JSON object
void writeZarrGroup(const OutputTree& folder, const std::string& name,
                    const std::string& attributes, ZarrVersion version);

}  // namespace vdb_madf::detail
