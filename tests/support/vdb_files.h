// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "support/catch.h"
#include "support/vdb_samples.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/verified_files.h"
#include "vdb_madf/vdb/read_vdb.h"

/// Grids and files for the tests of VDB files.
namespace vdb_madf::test {

/// While it lives, files are not verified.
struct Unverified {
  Unverified() { setFilesAreVerified(false); }
  ~Unverified() { setFilesAreVerified(true); }
};

/// The error of reading; empty if it can be read.
inline std::string errorOf(const std::string& path, const VdbReadOptions& options = {}) {
  try {
    readVdb(path, options);
    return {};
  } catch (const IoError& error) {
    return error.what();
  }
}

inline void requireOneLineNaming(const std::string& error, const std::string& path) {
  INFO(error);
  REQUIRE(error.find(path) != std::string::npos);
  REQUIRE(error.find('\n') == std::string::npos);
  REQUIRE(error.size() < path.size() + 400);
}

}  // namespace vdb_madf::test
