// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/verified_files.h"

#include <atomic>

namespace vdb_madf {

namespace {

std::atomic<bool> verifies{true};

}  // namespace

bool filesAreVerified() {
  return verifies;
}

void setFilesAreVerified(bool verified) {
  verifies = verified;
}

}  // namespace vdb_madf
