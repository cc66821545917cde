// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>
#include <vector>

namespace vdb_madf::tools {

/// What a value or an argument may be, as far as a shell can complete it.
struct ValueWords {
  enum class Path { none, file, folder };
  Path path = Path::none;
  std::vector<std::string> choices;  ///< beside paths
};

struct OptionWords {
  std::vector<std::string> names;  ///< "-q", "--quiet"
  std::string help;
  std::optional<ValueWords> value;  ///< of what is no flag
};

/// A verb or the command itself: all words that may follow it.
struct VerbWords {
  std::string name, help;
  std::vector<OptionWords> options;
  std::vector<VerbWords> verbs;
  ValueWords argument;  ///< where there are no verbs
};

}  // namespace vdb_madf::tools
