// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// Samples as a file holds them. Integers of 64 bits, which NumPy makes of most labels, are read as
/// int32 or uint32; a value that does not fit is an error, never another value.
struct StoredType {
  SampleType type = SampleType::uint8;  ///< the type they are read as
  bool is64Bit = false;                 ///< stored as integers of 64 bits
  bool bigEndian = false;

  size_t bytes() const { return is64Bit ? 8 : sampleSize(type); }
};

/// Converts stored samples to samples in native byte order; the two may be the same memory.
/// @throw IoError that names the path and the first value beyond 32 bits.
void toSamples(const std::string& path, const StoredType& stored, const void* from, size_t count,
               void* samples);

/// A type in NumPy's notation, as npy and Zarr files have it: "<u2", "|b1" (bool becomes uint8).
/// Nothing for half floats, complex numbers, records, text ...
std::optional<StoredType> storedTypeFromNumpy(const std::string& name);
/// Little-endian: "<u2", "|u1".
std::string numpyName(SampleType type);

}  // namespace vdb_madf::detail
