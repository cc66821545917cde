// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "array_source.h"

#include <cstring>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::python {

ArrayReader::ArrayReader(const ArraySource& source) : source_(source) {
  path_ = source.name;
  info_.size = source.size;
  info_.type = source.type;
  info_.voxelSize = source.voxelSize;
  info_.format = "array";
}

void ArrayReader::read(int first, int count, void* samples) {
  const size_t bytes =
      size_t(count) * size_t(info_.size.y) * size_t(info_.size.x) * sampleSize(info_.type);
  const py::gil_scoped_acquire lock;
  const py::array slab = source_.read(first, first + count);
  if (size_t(slab.nbytes()) != bytes || !(slab.flags() & py::array::c_style))
    throw IoError(path_ + ": gave " + std::to_string(slab.nbytes()) + " bytes for slices " +
                  std::to_string(first) + " to " + std::to_string(first + count - 1) + ", where " +
                  std::to_string(bytes) + " were expected");
  const void* const data = slab.data();
  const py::gil_scoped_release release;  // of a large copy; the slab stays
  std::memcpy(samples, data, bytes);
}

}  // namespace vdb_madf::python
