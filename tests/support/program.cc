// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/program.h"
#include "support/catch.h"
#include "support/warm_start.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace vdb_madf::test {

namespace {

constexpr int64_t kMaxSeconds = 120;  // of the processors; far more than any case takes

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

/// A descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {
    if (number < 0) throw std::runtime_error("no file or socket for a run");
  }
  ~Descriptor() { ::close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

/// The command, loaded once and waiting for requests (warm_start.c). It ends with this process.
class WarmCommand {
 public:
  WarmCommand() {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
      throw std::runtime_error("no socket");
    server_ = ends[0];
    const std::string number = "VDB_MADF_WARM_START=" + std::to_string(ends[1]);
    std::string name = "vdb_madf", preload = "LD_PRELOAD=" VDB_MADF_WARM_START_LIBRARY,
                variable = number;
    std::vector<char*> variables{preload.data(), variable.data()};
    for (char** each = environ; *each; ++each) variables.push_back(*each);
    variables.push_back(nullptr);
    char* arguments[] = {name.data(), nullptr};
    // Until the child has become the program, a signal to it must not find the handlers of the
    // tests.
    sigset_t all, signals;
    ::sigfillset(&all);
    ::sigprocmask(SIG_SETMASK, &all, &signals);
    process_ = ::fork();
    if (process_ == 0) {
      ::fcntl(ends[1], F_SETFD, 0);
      ::sigprocmask(SIG_SETMASK, &signals, nullptr);
      ::execve(VDB_MADF_TOOL, arguments, variables.data());
      ::_exit(127);
    }
    ::sigprocmask(SIG_SETMASK, &signals, nullptr);
    ::close(ends[1]);
    if (process_ < 0) throw std::runtime_error("no process");
  }
  ~WarmCommand() {
    ::close(server_);
    ::waitpid(process_, nullptr, 0);
  }
  WarmCommand(const WarmCommand&) = delete;
  WarmCommand& operator=(const WarmCommand&) = delete;

  void ask(std::string request, const std::array<int, 4>& descriptors) const {
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof descriptors)] = {};
    iovec data{request.data(), request.size()};
    msghdr message{};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    cmsghdr* head = CMSG_FIRSTHDR(&message);
    head->cmsg_level = SOL_SOCKET;
    head->cmsg_type = SCM_RIGHTS;
    head->cmsg_len = CMSG_LEN(sizeof descriptors);
    std::memcpy(CMSG_DATA(head), descriptors.data(), sizeof descriptors);
    if (request.size() > WARM_REQUEST_BYTES ||
        ::sendmsg(server_, &message, MSG_NOSIGNAL) != ssize_t(request.size()))
      throw std::runtime_error("the command cannot be asked to run");
  }

 private:
  int server_ = -1;
  pid_t process_ = -1;
};

std::string requestOf(const std::string& folder, const std::vector<std::string>& arguments,
                      const RunOptions& options) {
  WarmRequest head{options.largestFile, options.memory, kMaxSeconds, 1, 0};
  std::string texts = folder + std::string(1, 0) + "vdb_madf" + std::string(1, 0);
  for (const std::string& argument : arguments) {
    texts += argument + std::string(1, 0);
    ++head.arguments;
  }
  for (char** each = environ; *each; ++each) {
    texts += *each + std::string(1, 0);
    ++head.variables;
  }
  return std::string(reinterpret_cast<const char*>(&head), sizeof head) + texts;
}

/// What a run's watcher tells: its process, then its status.
int toldBy(const Descriptor& watcher) {
  int value = 0;
  if (::read(watcher.number(), &value, sizeof value) != sizeof value)
    throw std::runtime_error("a run was not begun, or is lost");
  return value;
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
  static const WarmCommand command;
  Pipe in, out, err;
  // A pipe holds so much without a reader.
  if (::write(in.ends[1], options.piped.data(), options.piped.size()) !=
      ssize_t(options.piped.size()))
    throw std::runtime_error("too much for a pipe");
  in.closeWriting();
  const auto start = Clock::now();
  Clock::time_point signalled;
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error("no socket");
  const Descriptor watcher(ends[0]);
  {
    const Descriptor answer(ends[1]);
    const Descriptor from(options.in.empty() ? ::dup(in.ends[0])
                                             : ::open(options.in.c_str(), O_RDONLY | O_CLOEXEC));
    const Descriptor to(options.out.empty() ? ::dup(out.ends[1])
                                            : ::open(options.out.c_str(), O_WRONLY | O_CLOEXEC));
    command.ask(requestOf(folder_.path(), arguments, options),
                {from.number(), to.number(), err.ends[1], answer.number()});
  }
  out.closeWriting();
  err.closeWriting();
  const pid_t child = toldBy(watcher);

  Outcome outcome;
  bool waiting = options.signal != 0;
  pollfd streams[2] = {{out.ends[0], POLLIN, 0}, {err.ends[0], POLLIN, 0}};
  std::string* const captured[2] = {&outcome.out, &outcome.err};
  while (streams[0].fd >= 0 || streams[1].fd >= 0) {
    ::poll(streams, 2, waiting ? 2 : -1);
    for (int i = 0; i < 2; ++i) {
      if (streams[i].fd < 0 || streams[i].revents == 0) continue;
      char buffer[4096];
      const ssize_t got = ::read(streams[i].fd, buffer, sizeof buffer);
      if (got > 0)
        captured[i]->append(buffer, size_t(got));
      else
        streams[i].fd = -1;  // poll passes over it
    }
    if (waiting && appears(folder_.path(), options.interruptOn)) {
      waiting = false;
      std::this_thread::sleep_for(std::chrono::duration<double>(options.delay));
      signalled = Clock::now();
      ::kill(child, options.signal);
    }
  }
  const int status = toldBy(watcher);
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
