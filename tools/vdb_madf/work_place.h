// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "segment_summary.h"
#include "vdb_madf/slabs/folder_scratch.h"

namespace vdb_madf::tools {

/// What labels in slabs come from, for the index of their folder: name and bytes of IN, and how it
/// was read.
Json originOf(const SegmentArguments& o);

/// Compares options, and the sizes of IN and of a mask, over the processes of a job.
/// @throw InvalidInput where they differ from those of member 0
void checkAlike(const SegmentArguments& o, Team& team);

/// Was OUT.slabs made, of the same IN and with the same options, by a run that ended?
/// @throw InvalidInput if there is one of other ones; IoError if it is damaged
bool isFinished(const SegmentArguments& o);

/// Where `segment IN OUT.slabs` works: OUT.slabs.part has the labels that are done, scratch all the
/// rest. Of several members each makes one, together; they share the folders, which member 0 makes
/// and removes. Without --scratch, --resume and --max-memory the scratch of several members is in
/// their memory.
class WorkPlace {
 public:
  /// @throw IoError, InvalidInput, one line, if the folders are in use or of other work;
  ///   OtherMemberFailed
  WorkPlace(const SegmentArguments& o, const Common& common, Team& team);

  Scratch& scratch() { return folder_ ? static_cast<Scratch&>(*folder_) : memory_; }
  bool isInMemory() const { return !folder_; }
  /// What reading and writing scratch took this process, seconds; 0 in memory.
  double scratchSeconds() const { return folder_ ? folder_->seconds() : 0; }
  /// True if the object is there, in slabs, from a run before.
  bool holdsSlabs() const;
  /// The folder in which OUT.slabs is made.
  const std::string& part() const { return part_; }
  /// What is known of the object beside its voxels; not in memory.
  std::string aboutFile() const { return folder_->file("about.vdb"); }

  /// @throw IoError if slabs are missing that a run before wrote
  void checkSlabs(size_t count) const;

  /// True if the work was all done by a run before, but for finish().
  bool isDone() const { return isDone_; }
  /// Puts, called by all members, the folder in the place of OUT, and removes scratch.
  void finish();
  /// Removes, after an error, what nobody can go on with, or says what is kept.
  /// @param isHopeless it would be the same error again
  void abandon(bool isHopeless);

 private:
  std::string file(const std::string& name) const;
  void makeFolders(const SegmentArguments& o);
  bool makePart(bool mayBeThere);
  void clearPart(bool butSlabs);
  void discard();

  Team& team_;
  Progress* progress_;
  std::string out_, part_;
  MemoryScratch memory_;
  std::unique_ptr<FolderScratch> folder_;
  bool isDone_ = false;
};

}  // namespace vdb_madf::tools
