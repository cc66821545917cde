// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/slabs/scratch.h"

namespace vdb_madf {

namespace detail {
class FolderLock;
}

/// A folder with a file for each piece, compressed, with a checksum. Each file is there whole or
/// not at all, so that what a killed program left can be taken up again.
class FolderScratch final : public Scratch {
 public:
  /// Makes the folder, or takes what is there, if that was made for the same work.
  /// @param work what the pieces depend on, as text
  /// @param resume take up what is there; otherwise the folder must be new or empty
  /// @throw IoError if it cannot be made, is not empty, or another run works in it; InvalidInput if
  ///   it was made for other work
  FolderScratch(const std::string& path, const std::string& work, bool resume);
  /// Takes part in the folder of another process, which has called share().
  /// @throw IoError if this process does not see it, or a run works in it that does not share it
  explicit FolderScratch(const std::string& path);
  ~FolderScratch() override;

  /// What is written from now on serves this run alone, which nobody takes up again: it need not
  /// outlive the machine.
  void serveThisRun() { lasts_ = false; }

  /// Lets other processes take part from now on: all have what one writes.
  void share();
  bool isShared() const override { return isShared_; }

  const std::string& path() const { return path_; }
  /// Where a file that is no piece goes.
  std::string file(const std::string& name) const;

  /// @throw IoError, one line: disk full, a piece missing or damaged ...
  void writeBytes(const std::string& name, const char* bytes, size_t size) override;
  void readBytes(const std::string& name, const Allocate& allocate) const override;
  bool has(const std::string& name) const override;
  void remove(const std::string& name) override;

  /// Removes all that is in it, and the folder.
  void removeAll();

  /// What reading and writing took so far, in this process.
  double seconds() const { return seconds_; }

 private:
  void take(const std::string& work, bool resume, bool isEmpty);

  std::string path_;
  bool isShared_ = false;
  bool lasts_ = true;
  mutable double seconds_ = 0;
  std::unique_ptr<detail::FolderLock> lock_;
};

/// @param path a piece, or another file there. @throw IoError that says so, and what to do
[[noreturn]] void failDamagedScratch(const std::string& path);

}  // namespace vdb_madf
