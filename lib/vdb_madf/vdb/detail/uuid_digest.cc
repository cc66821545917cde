// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/detail/uuid_digest.h"

#include <cstdio>

namespace vdb_madf::detail {

namespace {

/// "madf". Version 0.1.0 had a digest of another kind, and other digits here.
const std::string kOurs = "6d616466-";

}  // namespace

std::string uuidOf(const VdbSum& sum) {
  const auto [high, low] = sum.value();
  char text[kUuidLength + 1];
  std::snprintf(text, sizeof text, "%s%04x-8%03x-%04x-%012llx", kOurs.c_str(), unsigned(high >> 48),
                unsigned(high >> 32 & 0xfff), unsigned(0x8000 | (high >> 16 & 0x3fff)),
                static_cast<unsigned long long>(low >> 16));
  return text;
}

bool isDigest(const std::string& uuid) {
  return uuid.compare(0, kOurs.size(), kOurs) == 0;
}

}  // namespace vdb_madf::detail
