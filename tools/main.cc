// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <tbb/global_control.h>

#include <iostream>
#include <new>
#include <optional>

#include "command.h"
#include "vdb_madf/errors.h"
#include "vdb_madf/vdb_file.h"
#include "vdb_madf/version.h"

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

int fail(int code, std::string what) {
  for (char& c : what)
    if (c == '\n' || c == '\r') c = ' ';
  std::cerr << "vdb_madf: error: " << what << std::endl;
  return code;
}

int run(int argc, char** argv) {
  CLI::App app("Separates the grains of granular microstructures in micro-CT volumes.", "vdb_madf");
  app.set_version_flag("--version", std::string("vdb_madf ") + kVersion);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.footer("vdb_madf VERB --help explains a verb.");

  Common common;
  Action action;
  addGenerate(app, common, action);
  addConvert(app, common, action);
  addSegment(app, common, action);
  addRemerge(app, common, action);
  addCompare(app, common, action);
  addRender(app, common, action);
  addInfo(app, common, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return kDone;
  } catch (const CLI::CallForVersion&) {
    std::cout << "vdb_madf " << kVersion << std::endl;
    return kDone;
  } catch (const CLI::ParseError& error) {
    return fail(kWrongUsage, std::string(error.what()) + " (see vdb_madf --help)");
  }

  catchInterrupts();
  Progress progress(common.quiet);
  common.progress = &progress;
  std::optional<tbb::global_control> threads;
  if (common.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(common.threads));
  initialize();
  action();
  std::cout.flush();
  if (!std::cout) throw IoError("standard output cannot be written");
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
  } catch (const std::bad_alloc&) {
    return fail(kFailed,
                "out of memory: crop or coarsen the volume, or use a machine with more memory");
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}
