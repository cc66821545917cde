// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/program.h"
#include "support/catch.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace vdb_madf::test {

namespace {

constexpr rlim_t kMaxSeconds = 120;  // of the processors; far more than any case takes

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Pipe {
  int ends[2] = {-1, -1};
  Pipe() {
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) ::close(end);
  }
  void closeWriting() {
    ::close(ends[1]);
    ends[1] = -1;
  }
};

/// Between fork and exec: nothing but system calls.
[[noreturn]] void become(char* const* arguments, const char* folder, const RunOptions& options,
                         const sigset_t& signals, const Pipe& in, const Pipe& out,
                         const Pipe& err) {
  const int from =
      options.in.empty() ? in.ends[0] : ::open(options.in.c_str(), O_RDONLY | O_CLOEXEC);
  ::dup2(from, STDIN_FILENO);
  const int to =
      options.out.empty() ? out.ends[1] : ::open(options.out.c_str(), O_WRONLY | O_CLOEXEC);
  ::dup2(to, STDOUT_FILENO);
  ::dup2(err.ends[1], STDERR_FILENO);
  if (options.largestFile > 0) {
    const rlimit limit{rlim_t(options.largestFile), rlim_t(options.largestFile)};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  if (options.memory > 0) {
    const rlimit limit{rlim_t(options.memory), rlim_t(options.memory)};
    ::setrlimit(RLIMIT_AS, &limit);
  }
  // A program that hangs, or that outlives an aborted test, must not stay.
  const rlimit seconds{kMaxSeconds, kMaxSeconds};
  ::setrlimit(RLIMIT_CPU, &seconds);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXFSZ}) ::signal(signal, SIG_DFL);
  ::sigprocmask(SIG_SETMASK, &signals, nullptr);
  if (::chdir(folder) == 0) ::execv(VDB_MADF_TOOL, arguments);
  ::_exit(127);
}

/// `path` may lie in a folder that is not there yet.
bool appears(const std::string& folder, const std::string& path) {
  const std::filesystem::path whole = std::filesystem::path(folder) / path;
  const std::string beginning = whole.filename().string();
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(whole.parent_path(), missing))
    if (entry.path().filename().string().compare(0, beginning.size(), beginning) == 0) return true;
  return false;
}

}  // namespace

Outcome Bench::run(const std::vector<std::string>& arguments, const RunOptions& options) const {
  std::vector<std::string> texts{"vdb_madf"};
  texts.insert(texts.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);

  Pipe in, out, err;
  // A pipe holds so much without a reader.
  if (::write(in.ends[1], options.piped.data(), options.piped.size()) !=
      ssize_t(options.piped.size()))
    throw std::runtime_error("too much for a pipe");
  in.closeWriting();
  const auto start = Clock::now();
  Clock::time_point signalled;
  // Until the child has become the program, a signal to it must not find the handlers of the tests.
  sigset_t all, signals;
  ::sigfillset(&all);
  ::sigprocmask(SIG_SETMASK, &all, &signals);
  const pid_t child = ::fork();
  if (child == 0) become(argv.data(), folder_.path().c_str(), options, signals, in, out, err);
  ::sigprocmask(SIG_SETMASK, &signals, nullptr);
  if (child < 0) throw std::runtime_error("no process");
  out.closeWriting();
  err.closeWriting();

  Outcome outcome;
  bool waiting = options.signal != 0;
  pollfd ends[2] = {{out.ends[0], POLLIN, 0}, {err.ends[0], POLLIN, 0}};
  std::string* const captured[2] = {&outcome.out, &outcome.err};
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {
    ::poll(ends, 2, waiting ? 2 : -1);
    for (int i = 0; i < 2; ++i) {
      if (ends[i].fd < 0 || ends[i].revents == 0) continue;
      char buffer[4096];
      const ssize_t got = ::read(ends[i].fd, buffer, sizeof buffer);
      if (got > 0)
        captured[i]->append(buffer, size_t(got));
      else
        ends[i].fd = -1;  // poll passes over it
    }
    if (waiting && appears(folder_.path(), options.interruptOn)) {
      waiting = false;
      std::this_thread::sleep_for(std::chrono::duration<double>(options.delay));
      signalled = Clock::now();
      ::kill(child, options.signal);
    }
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  outcome.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  outcome.seconds = secondsSince(start);
  if (options.signal != 0 && !waiting) outcome.secondsAfterSignal = secondsSince(signalled);
  return outcome;
}

Outcome Bench::run(const std::string& arguments, const RunOptions& options) const {
  std::istringstream words(arguments);
  std::vector<std::string> list;
  for (std::string word; words >> word;) list.push_back(word);
  return run(list, options);
}

std::string Bench::mustRun(const std::string& arguments) const {
  INFO("vdb_madf " << arguments);
  const Outcome outcome = run(arguments);
  CHECK(outcome.err == "");
  REQUIRE(outcome.exitCode == 0);
  return outcome.out;
}

std::set<std::string> Bench::names() const {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
    names.insert(std::filesystem::relative(entry.path(), folder_.path()).string());
  return names;
}

}  // namespace vdb_madf::test
