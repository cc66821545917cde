// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <pybind11/numpy.h>

#include <optional>
#include <string>

#include "vdb_madf/images/image.h"

namespace vdb_madf::python {

namespace py = pybind11;

/// An array-like of Python: anything that gives slabs.
struct ArraySource {
  std::string name;  ///< in messages, and in the metadata madf_source
  ImageSize size;
  SampleType type = SampleType::uint8;
  std::optional<VoxelSize> voxelSize;  ///< that it tells, of an HDF5 file
  py::object read;  ///< read(first, stop): these slices, C-contiguous, of the type
};

/// The source as an image; takes the lock of the interpreter for each slab.
/// The source must live as long.
class ArrayReader : public ImageReader {
 public:
  explicit ArrayReader(const ArraySource& source);
  void read(int first, int count, void* samples) override;

 private:
  const ArraySource& source_;
};

}  // namespace vdb_madf::python
