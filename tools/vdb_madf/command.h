// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

#include "progress.h"

namespace vdb_madf::tools {

/// The command line is wrong in a way that shows before any file is opened: exit code 2.
class WrongUsage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Options of every verb.
struct Common {
  int threads = 0;  ///< 0: all
  bool quiet = false;
  bool verbose = false;
  Progress* progress = nullptr;
};

using Action = std::function<void()>;

/// Adds a verb with the common options and an example under its help.
CLI::App* addVerb(CLI::App& app, Common& common, const std::string& name,
                  const std::string& description, const std::string& example);

/// "1 grain", "2 grains".
inline std::string counted(int64_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// One function per verb; the returned action does the work once the command line is parsed.
void addGenerate(CLI::App& app, Common& common, Action& action);
void addConvert(CLI::App& app, Common& common, Action& action);
void addSegment(CLI::App& app, Common& common, Action& action);
void addRemerge(CLI::App& app, Common& common, Action& action);
void addSweep(CLI::App& app, Common& common, Action& action);
void addMeasure(CLI::App& app, Common& common, Action& action);
void addCompare(CLI::App& app, Common& common, Action& action);
void addRender(CLI::App& app, Common& common, Action& action);
void addExport(CLI::App& app, Common& common, Action& action);
void addInfo(CLI::App& app, Common& common, Action& action);

}  // namespace vdb_madf::tools
