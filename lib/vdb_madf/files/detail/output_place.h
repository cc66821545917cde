// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>

namespace vdb_madf::detail {

// What outputs that appear whole or not at all, files and folders, have in common.

/// @throw IoError that says why a path cannot be written, and what to do.
[[noreturn]] void failToWrite(const std::string& path, const std::string& reason,
                              const std::string& advice);
/// Throws as above, with the text of an errno.
[[noreturn]] void failToWrite(const std::string& path, int error);

/// The parts of the path that an output goes to.
struct OutputPlace {
  std::string folder, name;  ///< the folder with its slash; "." for that of the process
};
OutputPlace outputPlaceOf(const std::string& target);

/// What the temporaries of an output are called: this, the number of the process, that of the
/// output within it, and an ending: ".out.vdb.1234-0.tmp".
std::string temporaryStem(const std::string& name);
/// The path of another one with each call. The number of the process tells programs apart, the
/// other threads and what a program of the same number in another container left behind.
std::string nextTemporary(const OutputPlace& place);
/// The path of another journal of a set (output_set.h), which ends with ".undo".
std::string nextJournal(const OutputPlace& place);

/// The name of a temporary in parts; nothing if it is none.
struct Temporary {
  std::string stem;
  int process = 0;
  bool isJournal = false;
};
std::optional<Temporary> temporaryOf(const std::string& name);
/// True if there is no such process on this machine.
bool isGone(int process);

/// Makes the renaming of something in a folder last. Some file systems cannot sync a folder: the
/// output is in place all the same. @return EIO if the disk fails, or 0
int syncFolder(const std::string& path);
/// @throw IoError that says that syncFolder() failed
[[noreturn]] void failToLast(const std::string& target, int error);
/// Both, of the folder of `target`. @throw IoError
void syncFolderOf(const std::string& target);

}  // namespace vdb_madf::detail
