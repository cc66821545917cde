// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// Two labels, first < second, and the voxel faces between them.
struct LabelContact {
  int32_t first = 0, second = 0;
  int64_t faces = 0;
};

/// All pairs that share a face, ascending. @throw InvalidInput as LeafIndex does; Interrupted
std::vector<LabelContact> labelContacts(const Int32Grid& labels, Interrupter* interrupter);

/// Faces by pairs that share them.
using ContactFaces = std::map<std::pair<int32_t, int32_t>, int64_t>;
/// Adds the faces that the voxels of some 8x8x8 blocks have with those above them along an axis, in
/// these or others. @throw Interrupted
void addContactFaces(const Int32Tree& labels, const std::vector<Coord>& origins,
                     ContactFaces& faces, Interrupter* interrupter);
std::vector<LabelContact> contactsOf(const ContactFaces& faces);

}  // namespace vdb_madf::detail
