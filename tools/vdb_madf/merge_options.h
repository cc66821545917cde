// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "vdb_madf/method/merge.h"

namespace vdb_madf::tools {

/// The merge options as typed; empty: not given.
struct MergeArguments {
  std::string theta, mode, adjacency;
  void add(CLI::App& verb);
  /// @throw WrongUsage
  MergeOptions parse() const;
};

/// @throw WrongUsage unless a whole number >= 0.
int64_t parseGamma(const std::string& text);

}  // namespace vdb_madf::tools
