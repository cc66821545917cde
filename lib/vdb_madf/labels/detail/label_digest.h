// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "vdb_madf/labels/detail/label_leaves.h"

namespace vdb_madf::detail {

/// A checksum of the places and labels of the labeled voxels. Equal labels have equal digests,
/// however they are stored, and in whatever parts they come: it is a sum over their leaves.
class LabelDigest {
 public:
  void add(const LabelLeaves& labels);
  std::string text() const;  ///< 32 hexadecimal digits

 private:
  std::array<uint64_t, 2> sums_{};
};

/// The digest of all leaves.
std::string labelDigest(const LabelLeaves& labels);

}  // namespace vdb_madf::detail
