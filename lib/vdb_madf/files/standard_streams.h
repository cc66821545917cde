// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

namespace vdb_madf {

/// The path `-` is standard input to all that reads files ("./-" is a file of that name).
inline bool isStandardInput(const std::string& path) {
  return path == "-";
}

/// The paths `raw:-`, `npy:-`, `nrrd:-` ... are standard output, in the format that stands in the
/// place of an ending (fileEnding()). Only what is written from its beginning to its end can go
/// there.
inline bool isStandardOutput(const std::string& path) {
  return path.size() > 2 && path.compare(path.size() - 2, 2, ":-") == 0 &&
         path.find('/') == std::string::npos;
}

/// Readers go to and fro, so what comes from a pipe is first copied to a file without a name, in
/// the folder that TMPDIR names, else /tmp; it is gone when the program ends. Once a process: calls
/// after the first do nothing. (InputFile calls it; a program that wants the waiting to end at a
/// signal calls it before.)
/// @throw IoError if standard input cannot be read, is a terminal, or the folder is full.
void keepStandardInput();

}  // namespace vdb_madf
