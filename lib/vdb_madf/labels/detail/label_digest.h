// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/labels/detail/label_leaves.h"

namespace vdb_madf::detail {

/// A checksum of the places and labels of the labelled voxels: 32 hexadecimal digits. Equal labels
/// have equal digests, however they are stored.
std::string labelDigest(const LabelLeaves& labels);

}  // namespace vdb_madf::detail
