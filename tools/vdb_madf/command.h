// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <string>

#include "command_line.h"
#include "progress.h"
#include "vdb_madf/base/counted.h"
#include "vdb_madf/slabs/team.h"

namespace vdb_madf::tools {

/// Options of every verb.
struct Common {
  int threads = 0;  ///< 0: all
  bool quiet = false;
  bool verbose = false;
  bool unverified = false;  ///< see setFilesAreVerified()
  std::string maxMemory;    ///< see MemoryLimit::kept; empty: none
  Progress* progress = nullptr;
  Team* team = nullptr;  ///< of vdb_madf_mpi
};

using Action = std::function<void()>;

/// Who sees that a verb takes no more than --max-memory.
enum class MemoryLimit {
  kept,    ///< the system, which refuses more while the verb works: limitMemory()
  planned  ///< the verb, which refuses before it works, and has an option of its own
};

/// Adds a verb with the common options and an example under its help.
Verb addVerb(Verb parent, Common& common, const std::string& name, const std::string& description,
             const std::string& example, MemoryLimit limit = MemoryLimit::kept);

/// Leaves out what is printed where it would get into an output on standard output.
Common besideOutput(Common common, const std::string& output);

/// A line to begin with. @param team of vdb_madf_mpi; null for vdb_madf
inline const char* exampleOfSegment(const Team* team) {
  return team ? "mpiexec -n 4 vdb_madf_mpi segment core.tif core.slabs --phase 1"
              : "vdb_madf segment scan.tif grains.vdb --phase 1 --voxel-size 8.5um";
}

// One function per verb; the returned action does the work once the command line is parsed.
void addGenerate(Verb command, Common& common, Action& action);
void addEvolve(Verb generate, Common& common, Action& action);  ///< a kind of it
void addConvert(Verb command, Common& common, Action& action);
void addSegment(Verb command, Common& common, Action& action);
void addRemerge(Verb command, Common& common, Action& action);
void addEdit(Verb command, Common& common, Action& action);
void addSweep(Verb command, Common& common, Action& action);
void addHierarchy(Verb command, Common& common, Action& action);
void addMeasure(Verb command, Common& common, Action& action);
void addCollect(Verb command, Common& common, Action& action);
void addVerify(Verb command, Common& common, Action& action);
void addCompare(Verb command, Common& common, Action& action);
void addTrack(Verb command, Common& common, Action& action);
void addRender(Verb command, Common& common, Action& action);
void addExport(Verb command, Common& common, Action& action);
void addReport(Verb command, Common& common, Action& action);
void addInfo(Verb command, Common& common, Action& action);
void addCompletion(Verb command, const CommandLine& line, Action& action);

}  // namespace vdb_madf::tools
