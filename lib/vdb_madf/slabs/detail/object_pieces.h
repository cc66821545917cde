// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/slabs/detail/bytes.h"
#include "vdb_madf/slabs/scratch.h"

// Leaves of an object in scratch.

namespace vdb_madf::detail {

/// The piece with the object of a slab.
inline std::string objectName(size_t slab) {
  return "object-" + std::to_string(slab);
}

inline void writeLeaves(Scratch& scratch, const std::string& name,
                        const std::vector<LeafIndex::LeafVoxels>& leaves) {
  ByteWriter bytes;
  bytes.add(leaves);
  scratch.write(name, bytes.bytes());
}

inline std::vector<LeafIndex::LeafVoxels> readLeaves(const Scratch& scratch,
                                                     const std::string& name) {
  return ByteReader(scratch.read(name)).vector<LeafIndex::LeafVoxels>();
}

}  // namespace vdb_madf::detail
