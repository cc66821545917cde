// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/slabs/detail/bytes.h"
#include "vdb_madf/slabs/detail/slab_body.h"
#include "vdb_madf/slabs/segment_slabs.h"

namespace vdb_madf::detail {

/// What all steps of segmentSlabs() work with. What they leave in scratch has the name of what it is
/// and the number of the slab; a step whose last piece is there is done, be it by a run before.
struct SlabWork {
  const SlabObject& object;
  std::optional<Domain> domain;
  const SegmentOptions& options;
  Scratch& scratch;
  Interrupter* interrupter;
  Obstacles obstacles{};
  bool fillsNone = false;  ///< would the cavities be all background?

  /// What is told of the work on the slabs, of which this is the i-th: it goes from `begin` to `end` per
  /// cent of the whole.
  WorkPart part(int begin, int end, size_t i) const {
    const double step = double(end - begin) / double(slabCount());
    return {interrupter, int(begin + step * double(i)), int(begin + step * double(i + 1))};
  }

  size_t slabCount() const { return object.slabCount(); }
  int begin(size_t slab) const { return object.cuts[slab]; }
  int end(size_t slab) const { return object.cuts[slab + 1]; }

  static std::string name(const char* what, size_t slab) {
    return std::string(what) + "-" + std::to_string(slab);
  }
  bool has(const char* what, size_t slab) const { return scratch.has(name(what, slab)); }
  void write(const char* what, size_t slab, const ByteWriter& bytes) {
    scratch.write(name(what, slab), bytes.bytes());
  }
  ByteReader read(const char* what, size_t slab) const {
    return ByteReader(scratch.read(name(what, slab)));
  }
  void remove(const char* what, size_t slab) { scratch.remove(name(what, slab)); }

  template <typename T>
  void writeVector(const char* what, size_t slab, const std::vector<T>& values) {
    ByteWriter bytes;
    bytes.add(values);
    write(what, slab, bytes);
  }
  template <typename T>
  std::vector<T> readVector(const char* what, size_t slab) const {
    return read(what, slab).vector<T>();
  }

  std::vector<LeafIndex::LeafVoxels> cavities(size_t slab) const {
    if (fillsNone) return {};
    return readVector<LeafIndex::LeafVoxels>("cavities", slab);
  }
  SlabBody body(size_t slab) const { return SlabBody(object.leaves(slab), cavities(slab)); }
};

}  // namespace vdb_madf::detail
