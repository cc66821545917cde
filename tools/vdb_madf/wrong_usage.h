// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <stdexcept>

namespace vdb_madf::tools {

/// The command line is wrong in a way that shows before any file is opened: exit code 2.
class WrongUsage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace vdb_madf::tools
