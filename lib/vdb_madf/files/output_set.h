// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

namespace vdb_madf {

/// Files that replace earlier ones together or not at all. While a set lives, the files that its
/// thread commits (OutputFile; those that are synced) wait in their temporaries, and commit() puts
/// them in place. If one cannot be, all earlier files are put back. A set that is made while
/// another lives hands its files over to that. Destroyed without commit: the temporaries are
/// removed.
///
/// A program that is killed in commit() leaves some of the new files in place, the earlier ones
/// beside them, and in each folder a journal, ".out.mhd.1234-5.undo", which says what belongs
/// where: removeLeftovers(), with which runs that write to that folder begin, then puts the
/// earlier files of the folder back.
class OutputSet {
 public:
  OutputSet();
  ~OutputSet();
  OutputSet(const OutputSet&) = delete;
  OutputSet& operator=(const OutputSet&) = delete;

  /// @throw IoError if a file cannot be put in place, all being as before
  void commit();

 private:
  friend class OutputFile;
  struct Member {
    std::string path, target, temporary;  ///< path: what messages name
  };
  static OutputSet* current();

  std::vector<Member> members_;
  OutputSet* outer_;
};

namespace detail {

/// Puts the earlier files of a set back, as its journal says, and removes it.
/// @return an errno, or 0
int undoSet(const std::string& journal);

}  // namespace detail

}  // namespace vdb_madf
