// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace vdb_madf::test {

/// What a finished program leaves.
struct Outcome {
  int exitCode = -1;  ///< 1000 + n if signal n ended it
  std::string out, err;
  double seconds = 0;             ///< from the start
  double secondsAfterSignal = 0;  ///< from the signal, if one was sent
};

/// How to run the program other than by its arguments.
struct RunOptions {
  std::string in;           ///< file for standard input; empty: see `piped`
  std::string piped;        ///< what comes through a pipe there, at most 64 KiB
  std::string out;          ///< file or device for standard output, which is then not captured
  int64_t largestFile = 0;  ///< bytes; 0: no limit
  int64_t memory = 0;       ///< bytes that it may map; 0: no limit
  std::string interruptOn;  ///< send `signal` when a file appears whose name begins with this
  int signal = 0;
  double delay = 0;  ///< seconds from then to the signal
};

/// A temporary folder in which the real vdb_madf command is run.
class Bench {
 public:
  /// Arguments parted by spaces, or as they are.
  Outcome run(const std::string& arguments, const RunOptions& options = {}) const;
  Outcome run(const std::vector<std::string>& arguments, const RunOptions& options = {}) const;
  /// Runs it and requires that it succeeds without a word on stderr; returns what it printed.
  std::string mustRun(const std::string& arguments) const;

  std::string path(const std::string& name) const { return folder_.file(name); }
  std::string bytes(const std::string& name) const { return bytesOf(path(name)); }
  void write(const std::string& name, const std::string& bytes) const {
    writeBytes(path(name), bytes);
  }
  /// All names in the folder, hidden ones too.
  std::set<std::string> names() const;

 private:
  TemporaryFolder folder_;
};

}  // namespace vdb_madf::test
