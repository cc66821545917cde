// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <tbb/global_control.h>

#include <cstdio>
#include <iostream>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/method/initialize.h"

namespace vdb_madf::tools {

CLI::App* addVerb(CLI::App& app, Common& common, const std::string& name,
                  const std::string& description, const std::string& example) {
  CLI::App* verb = app.add_subcommand(name, description);
  verb->add_option("--threads", common.threads, "number of threads (default: all)")
      ->check(CLI::Range(1, 4096));
  verb->add_flag("-q,--quiet", common.quiet, "print nothing but errors");
  verb->add_flag("-v,--verbose", common.verbose, "print more");
  verb->footer("Example:\n  " + example);
  return verb;
}

namespace {

constexpr int kDone = 0, kFailed = 1, kWrongUsage = 2, kInterrupted = 130;

/// One line, whatever a file name or a corrupt header brought into it.
int fail(int code, std::string what) {
  for (char& c : what)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  std::cerr << "vdb_madf: error: " << what << std::endl;
  return code;
}

/// How the user of the command does what an error of the library hints at.
const char* optionFor(Hint hint) {
  switch (hint) {
    case Hint::none:
      break;
    case Hint::rawLayout:
      return " (--dims, --type)";
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

/// "vdb_madf segment", as far as the command line was understood.
std::string parsedCommand(const CLI::App& app) {
  std::string command = app.get_name();
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  return verbs.empty() ? command : command + " " + parsedCommand(*verbs.front());
}

void flushStandardOutput() {
  std::fflush(stdout);
  std::cout.flush();
  if (!std::cout || std::ferror(stdout)) throw IoError("standard output cannot be written");
}

int run(int argc, char** argv) {
  rejectEmptyArguments(argc, argv);
  CLI::App app("Separates the grains of granular microstructures in micro-CT volumes.", "vdb_madf");
  app.set_version_flag("--version", std::string("vdb_madf ") + kVersion);
  app.require_subcommand(0, 1);  // its absence is told below, in our words
  app.get_formatter()->column_width(34);
  app.get_formatter()->label("SUBCOMMAND", "VERB");
  app.get_formatter()->label("Subcommands", "Verbs");
  app.footer(
      "vdb_madf VERB --help explains a verb.\nExample:\n"
      "  vdb_madf segment scan.tif grains.vdb --phase 1 --voxel-size 8.5um");

  Common common;
  Action action;
  addGenerate(app, common, action);
  addConvert(app, common, action);
  addSegment(app, common, action);
  addRemerge(app, common, action);
  addSweep(app, common, action);
  addMeasure(app, common, action);
  addCompare(app, common, action);
  addRender(app, common, action);
  addExport(app, common, action);
  addInfo(app, common, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    flushStandardOutput();
    return kDone;
  } catch (const CLI::CallForVersion&) {
    std::cout << "vdb_madf " << kVersion << "\n";
    flushStandardOutput();
    return kDone;
  } catch (const CLI::ParseError& error) {
    return fail(kWrongUsage,
                std::string(error.what()) + " (see " + parsedCommand(app) + " --help)");
  }
  const std::string command = parsedCommand(app);
  if (!action) return fail(kWrongUsage, "say what to do: see " + command + " --help");

  catchInterrupts();
  Progress progress(common.quiet, command.substr(command.find(' ') + 1));
  common.progress = &progress;
  std::optional<tbb::global_control> threads;
  if (common.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(common.threads));
  initialize();
  action();
  flushStandardOutput();
  return kDone;
}

}  // namespace

}  // namespace vdb_madf::tools

int main(int argc, char** argv) {
  using namespace vdb_madf::tools;
  try {
    return run(argc, argv);
  } catch (const WrongUsage& error) {
    return fail(kWrongUsage, error.what());
  } catch (const vdb_madf::Interrupted&) {
    return fail(kInterrupted, "interrupted");
  } catch (const vdb_madf::InvalidInput& error) {
    return fail(kFailed, std::string(error.what()) + optionFor(error.hint()));
  } catch (const vdb_madf::IoError& error) {
    return fail(kFailed, std::string(error.what()) + optionFor(error.hint()));
  } catch (const std::bad_alloc&) {
    return fail(kFailed,
                "out of memory: crop or coarsen the volume, or use a machine with more memory");
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}
