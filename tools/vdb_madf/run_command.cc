// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "run_command.h"

#include <fmt/core.h>
#include <openvdb/version.h>
#include <tbb/global_control.h>
#ifdef VDB_MADF_MIMALLOC
#include <mimalloc.h>
#endif

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "command.h"
#include "command_line.h"
#include "member_failure.h"
#include "message.h"
#include "outputs.h"
#include "parse.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/base/simd_level.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/files/verified_files.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/report/report.h"
#include "vdb_madf/segmentation/initialize.h"

namespace vdb_madf::tools {

Verb addVerb(Verb parent, Common& common, const std::string& name, const std::string& description,
             const std::string& example, MemoryLimit limit) {
  Verb verb = parent.verb(name, description);
  verb.option("--threads", common.threads, "number of threads (default: all)").range(1, 4096);
  verb.flag("-q,--quiet", common.quiet, "print nothing but errors");
  verb.flag("-v,--verbose", common.verbose, "print more");
  verb.flag("--no-verify", common.unverified,
            "read files whose content is not what their digest says");
  if (limit == MemoryLimit::kept)
    verb.option("--max-memory", common.maxMemory,
                "end with an error rather than take more, such as 12GiB")
        .typeName("SIZE");
  verb.footer("Example:\n  " + example);
  return verb;
}

Common besideOutput(Common common, const std::string& output) {
  common.quiet |= isOnStandardOutput(output);
  return common;
}

namespace {

constexpr int kDone = 0, kFailed = 1, kWrongUsage = 2, kInterrupted = 130;

int fail(const Team* team, int code, const std::string& what) {
  // What several find wrong is said once: the first of them ends the others while these wait. That
  // takes a moment.
  if (team && team->member() > 0)
    std::this_thread::sleep_for(std::chrono::seconds(2 + std::min(team->member(), 20)));
  printMessage("error", what);
  return code;
}

/// How the user of the command does what an error of the library hints at.
const char* optionFor(Hint hint) {
  switch (hint) {
    case Hint::none:
      break;
    case Hint::rawLayout:
      return " (--dims, --type, --skip)";
    case Hint::dataset:
      return " (--dataset)";
    case Hint::voxelSize:
      return " (--voxel-size)";
    case Hint::memoryLimit:
      return " (--max-memory)";
    case Hint::manifolds:
      return " with --keep manifold";
    case Hint::smallerLabels:
      return " (export --as lod)";
    case Hint::areLabels:
      return " (or, if it holds labels, convert --labels)";
    case Hint::unverified:
      return " (--no-verify)";
  }
  return "";
}

/// An unset variable of a script must not turn `--phase "$PHASE"` into the default.
void rejectEmptyArguments(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.empty())
      throw WrongUsage(i > 1 ? "the argument after '" + std::string(argv[i - 1]) + "' is empty"
                             : "the first argument is empty");
    if (argument.compare(0, 2, "--") == 0 && argument.back() == '=')
      throw WrongUsage("'" + argument + "' lacks its value");
  }
}

void flushStandardOutput() {
  std::fflush(stdout);
  std::cout.flush();
  if (!std::cout || std::ferror(stdout)) throw IoError("standard output cannot be written");
}

/// Lets this process's memory come in large pages (2 MiB), where the system gives them to those who
/// ask. A large sample has a million blocks of 2 KiB, the values of leaf nodes: a half of a small
/// page each. Where a page's first touch is slow, as in virtual machines that are given memory on
/// demand, these touches would take as long as the method. Nothing where the program was built
/// without mimalloc 2, whose allocator it is then.
void askForLargePages() {
#ifdef VDB_MADF_MIMALLOC
  mi_option_enable(mi_option_large_os_pages);
  // Otherwise a thread's first memory comes in small pages.
  mi_option_set(mi_option_eager_commit_delay, 0);
#endif
}

/// Starts as many threads as TBB may, and ends them: TBB ends the process where it is refused one,
/// or memory that it begins with.
/// @throw InvalidInput if the system refuses one
void checkThreads() {
  constexpr size_t kThreadBytes = size_t(8) << 20, kOtherBytes = size_t(32) << 20;
  using Control = tbb::global_control;
  const size_t others = Control::active_value(Control::max_allowed_parallelism) - 1;
  if (others == 0) return;
  std::vector<std::thread> started;
  started.reserve(others);
  std::mutex untilAllRun;
  std::unique_lock<std::mutex> lock(untilAllRun);
  bool isRefused = false;
  try {
    // The stacks of these threads stay with the process: those of TBB's are others.
    std::vector<std::unique_ptr<char[]>> untouched(others);
    const std::unique_ptr<char[]> other(new char[kOtherBytes]);
    for (size_t i = 0; i < others; ++i) {
      untouched[i].reset(new char[kThreadBytes]);
      started.emplace_back([&] { const std::lock_guard<std::mutex> wait(untilAllRun); });
    }
  } catch (const std::exception&) {  // system_error, or bad_alloc
    isRefused = true;
  }
  lock.unlock();
  for (std::thread& thread : started) thread.join();
  if (isRefused)
    throw InvalidInput(fmt::format(
        "the system refuses a thread more than {}: allow more memory (--max-memory, ulimit -v) or "
        "processes (ulimit -u), or use fewer (--threads)",
        started.size() + 1));
}

/// The version of the command, and in lines below it what it was built with and runs with:
/// OpenVDB's version, the instruction set, optional formats.
std::string versionText() {
  return std::string(kVersion) + "\nOpenVDB " + openvdb::getLibraryVersionString() +
         "\nSIMD level " + simdLevel() +
         (readsHdf5() ? "\nHDF5 is read and written"
                      : "\nHDF5 is not read or written: install libhdf5-dev, then configure and "
                        "build again") +
         (canWriteReport() ? "\nReports are written"
                           : "\nReports are not written: install esbuild, libjs-three and "
                             "libjs-jquery-datatables, then configure and build again");
}

void addVerbs(Verb command, const CommandLine& line, Common& common, Action& action) {
  addGenerate(command, common, action);
  addConvert(command, common, action);
  addSegment(command, common, action);
  addRemerge(command, common, action);
  addEdit(command, common, action);
  addSweep(command, common, action);
  addHierarchy(command, common, action);
  addMeasure(command, common, action);
  addCollect(command, common, action);
  addVerify(command, common, action);
  addCompare(command, common, action);
  addTrack(command, common, action);
  addRender(command, common, action);
  addReport(command, common, action);
  addExport(command, common, action);
  addInfo(command, common, action);
  addCompletion(command, line, action);
}

int run(const char* program, int argc, char** argv, Team* team) {
  rejectEmptyArguments(argc, argv);
  CommandLine line(program, "Separates the grains of granular microstructures in micro-CT volumes.",
                   versionText());
  Verb command = line.command();
  Common common;
  common.team = team;
  command.footer(fmt::format("{} help VERB explains a verb.\nExample:\n  {}", program,
                             exampleOfSegment(team)));
  Action action;
  if (team) {
    addConvert(command, common, action);
    addSegment(command, common, action);
  } else {
    addVerbs(command, line, common, action);
  }
  if (const std::optional<std::string> text = line.parse(argc, argv)) {
    if (!team || team->member() == 0) std::cout << *text;
    flushStandardOutput();
    return kDone;
  }
  const std::string given = line.given();
  if (!action) throw WrongUsage("say what to do: see " + given + " --help");

  common.quiet |= team && team->member() > 0;
  catchInterrupts();
  Progress progress(common.quiet, given.substr(given.find(' ') + 1));
  common.progress = &progress;
  std::optional<tbb::global_control> threads;
  if (common.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(common.threads));
  if (!common.maxMemory.empty()) limitMemory(parseMemory(common.maxMemory));
  checkThreads();
  initialize();
  setFilesAreVerified(!common.unverified);
  try {
    action();
  } catch (const std::bad_alloc&) {
    if (common.maxMemory.empty()) throw;
    throw InvalidInput(common.maxMemory +
                       " of memory are not enough: allow more (--max-memory), crop or coarsen the "
                       "volume, or give labels in slabs, of which measure takes one at a time");
  }
  flushStandardOutput();
  return kDone;
}

}  // namespace

int runCommand(const char* program, int argc, char** argv, Team* team) {
  askForLargePages();
  try {
    return run(program, argc, argv, team);
  } catch (const OtherMemberFailed&) {
    // The member that failed prints why, and then ends this process, by MPI_Abort. If this one
    // ended first, the job would be over before that message came.
    std::this_thread::sleep_for(std::chrono::minutes(1));
    return kFailed;
  } catch (const WrongUsage& error) {
    return fail(team, kWrongUsage, error.what());
  } catch (const Interrupted&) {
    return fail(team, kInterrupted, "interrupted");
  } catch (const InvalidInput& error) {
    return fail(team, kFailed, std::string(error.what()) + optionFor(error.hint()));
  } catch (const IoError& error) {
    return fail(team, kFailed, std::string(error.what()) + optionFor(error.hint()));
  } catch (const std::bad_alloc&) {
    return fail(
        team, kFailed,
        "out of memory: crop or coarsen the volume, segment in slabs (OUT.slabs) with a lower "
        "--max-memory, or use a machine with more memory");
  } catch (const std::exception& error) {
    return fail(team, kFailed, error.what());
  }
}

}  // namespace vdb_madf::tools
