// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "command_line.h"
#include "vdb_madf/method/merge.h"

namespace vdb_madf::tools {

/// The merge options as typed; empty: not given.
struct MergeArguments {
  std::string theta, mode, adjacency;
  void add(Verb verb);
  /// @throw WrongUsage
  MergeOptions parse() const;
};

}  // namespace vdb_madf::tools
