// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "command_line.h"
#include "vdb_madf/method/merge.h"
#include "vdb_madf/method/stable_strictness.h"

namespace vdb_madf::tools {

/// The merge options as typed; empty: not given.
struct MergeArguments {
  std::string strictness, mode, theta, delta, adjacency, minGrain;
  void add(Verb verb);
  /// Is the strictness of largest stability to be found (stable_strictness.h)?
  bool isAutomatic() const { return strictness == "auto"; }
  /// @throw WrongUsage
  MergeOptions parse() const;
};

/// What there is to say of a strictness that was found: two lines, without the last end of line.
std::string textOf(const StableStrictness& stable, const std::string& indentOfSecond);

/// Says to which way of merging it belongs.
[[noreturn]] void refuseOptionOfTests(const std::string& name);
[[noreturn]] void refuseStrictness(const std::string& mode);

/// --delta. @throw WrongUsage
int parseDelta(const std::string& text);

/// The value of an option. @throw WrongUsage
double parseStrictness(const std::string& text, const std::string& option = "--strictness");

/// --min-grain; empty: not given.
void addMinGrain(Verb verb, std::string& text);
/// @throw WrongUsage
int64_t parseMinGrain(const std::string& text);

/// --fill-holes: how cavities are filled; empty: not given.
void addFillHoles(Verb verb, std::string& text);
/// @throw WrongUsage
std::optional<int64_t> parseFillHoles(const std::string& text);

/// --tidy; empty: not given.
void addTidy(Verb verb, std::string& text);
/// @throw WrongUsage
int parseTidy(const std::string& text);

}  // namespace vdb_madf::tools
