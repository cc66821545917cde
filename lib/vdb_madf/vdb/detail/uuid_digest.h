// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/files/detail/content_digest.h"

// Instead of a random UUID a file of ours has the digest of all its other bytes. A program that
// writes the file again gives it another one.

namespace vdb_madf::detail {

/// Where the UUID stands in a VDB file, as text.
constexpr size_t kUuidStart = 21, kUuidLength = 36;

/// The checksum of a VDB file, but for its UUID.
class VdbSum : public ContentSum {
 public:
  explicit VdbSum(int64_t size) : ContentSum(size, kUuidStart, kUuidLength) {}
};

/// A UUID of version 8 (RFC 9562: contents defined by the application).
std::string uuidOf(const VdbSum& sum);

/// Whether a UUID, as text, is one of uuidOf().
bool isDigest(const std::string& uuid);

}  // namespace vdb_madf::detail
