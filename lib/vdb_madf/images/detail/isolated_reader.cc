// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/detail/isolated_reader.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/header_checks.h"

namespace vdb_madf::detail {

namespace {

/// What the names of all files may take.
constexpr uint64_t kMaxFileBytes = uint64_t(1) << 26;

/// One end of the socket. What goes over it are plain values of one program.
class Line {
 public:
  explicit Line(int descriptor) : descriptor_(descriptor) {}
  ~Line() { close(descriptor_); }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  /// False if the other side is gone.
  bool send(const void* bytes, size_t count) const {
    const char* next = static_cast<const char*>(bytes);
    while (count > 0) {
      const ssize_t sent = ::send(descriptor_, next, count, MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) return false;
      next += sent;
      count -= size_t(sent);
    }
    return true;
  }
  bool receive(void* bytes, size_t count) const {
    char* next = static_cast<char*>(bytes);
    while (count > 0) {
      const ssize_t got = recv(descriptor_, next, count, 0);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      next += got;
      count -= size_t(got);
    }
    return true;
  }

 private:
  int descriptor_;
};

struct Request {
  int first, count;
};

/// What precedes samples, a description or a message.
struct Reply {
  enum Kind { good, ioError, invalidInput } kind;
  Hint hint;
  uint64_t bytes;
};

/// ImageInfo without its strings.
struct Description {
  int size[3];
  SampleType type;
  double edges[3];  ///< meters; 0: unknown
  char format[16];
};

bool reply(const Line& line, Reply::Kind kind, Hint hint, const void* bytes, uint64_t count) {
  const Reply head{kind, hint, count};
  return line.send(&head, sizeof head) && line.send(bytes, size_t(count));
}

/// Runs `work`, and sends what it throws as a reply. False: no more requests are to be served.
template <typename Work>
bool answer(const Line& line, const Work& work) {
  std::string message;
  Reply::Kind kind = Reply::ioError;
  Hint hint = Hint::none;
  try {
    return work();
  } catch (const InvalidInput& error) {
    kind = Reply::invalidInput;
    message = error.what();
    hint = error.hint();
  } catch (const IoError& error) {
    message = error.what();
    hint = error.hint();
  } catch (const std::exception&) {  // out of memory, most likely
    return false;
  }
  return reply(line, kind, hint, message.data(), message.size());
}

/// The other process: a crash is silent and leaves nothing behind; signals are for the first one.
[[noreturn]] void serve(const Line& line,
                        const std::function<std::unique_ptr<ImageReader>()>& open) {
  for (const int crash : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) signal(crash, SIG_DFL);
  for (const int end : {SIGINT, SIGTERM, SIGHUP}) signal(end, SIG_IGN);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);

  std::unique_ptr<ImageReader> reader;
  bool going = answer(line, [&] {
    reader = open();
    const ImageInfo& info = reader->info();
    Description description{};
    for (int axis = 0; axis < 3; ++axis) description.size[axis] = info.size[axis];
    description.type = info.type;
    if (info.voxelSize)
      std::copy_n(info.voxelSize->edges().begin(), 3, std::begin(description.edges));
    std::strncpy(description.format, info.format.c_str(), sizeof description.format - 1);
    std::string files;
    for (const std::string& file : reader->files()) files += file + '\0';
    return reply(line, Reply::good, Hint::none, &description, sizeof description) &&
           reply(line, Reply::good, Hint::none, files.data(), files.size());
  });
  std::vector<char> samples;
  for (Request request{}; going && reader && line.receive(&request, sizeof request);)
    going = answer(line, [&] {
      samples.resize(size_t(sliceBytes(reader->info())) * size_t(request.count));
      reader->read(request.first, request.count, samples.data());
      return reply(line, Reply::good, Hint::none, samples.data(), samples.size());
    });
  _exit(0);
}

class IsolatedReader : public ImageReader {
 public:
  IsolatedReader(const std::string& path,
                 const std::function<std::unique_ptr<ImageReader>()>& open) {
    path_ = path;
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) failToStart();
    line_ = std::make_unique<Line>(ends[0]);
    auto theirs = std::make_unique<Line>(ends[1]);
    process_ = fork();
    if (process_ < 0) failToStart();
    if (process_ == 0) {
      line_.reset();
      serve(*theirs, open);
    }
    theirs.reset();
    try {
      Description description;
      receive(&description, sizeof description);
      info_.size = {description.size[0], description.size[1], description.size[2]};
      info_.type = description.type;
      const auto& [x, y, z] = description.edges;
      if (x > 0) info_.voxelSize = VoxelSize({x, y, z});
      info_.format = description.format;
      receiveFiles();
    } catch (...) {
      end();
      throw;
    }
  }
  ~IsolatedReader() override { end(); }

  void read(int first, int count, void* samples) override {
    checkSlices(path_, info_, first, count);
    const Request request{first, count};
    if (!line_->send(&request, sizeof request)) failToAnswer();
    receive(samples, sliceBytes(info_) * uint64_t(count));
  }

 private:
  [[noreturn]] void failToStart() const {
    throw IoError(path_ + ": no process can be started to read it: " + std::strerror(errno));
  }
  [[noreturn]] void failToAnswer() const {
    throw IoError(path_ + ": is damaged: the library that reads it crashed or ran out of memory");
  }

  void receive(void* to, uint64_t count) const {
    if (receiveHead() != count || !line_->receive(to, size_t(count))) failToAnswer();
  }

  /// Names, each with a zero behind it.
  void receiveFiles() {
    std::string names(size_t(std::min(receiveHead(), kMaxFileBytes)), '\0');
    if (!line_->receive(names.data(), names.size())) failToAnswer();
    for (size_t begin = 0, end; (end = names.find('\0', begin)) != names.npos; begin = end + 1)
      files_.push_back(names.substr(begin, end - begin));
  }

  /// How many bytes follow. @throw what the other process threw
  uint64_t receiveHead() const {
    Reply head;
    if (!line_->receive(&head, sizeof head)) failToAnswer();
    if (head.kind == Reply::good) return head.bytes;
    std::string message(size_t(std::min<uint64_t>(head.bytes, 1 << 16)), '\0');
    if (!line_->receive(message.data(), message.size())) failToAnswer();
    if (head.kind == Reply::invalidInput) throw InvalidInput(message, head.hint);
    throw IoError(message, head.hint);
  }

  void end() {
    kill(process_, SIGKILL);
    while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) continue;
  }

  std::unique_ptr<Line> line_;
  pid_t process_ = -1;
};

}  // namespace

std::unique_ptr<ImageReader> openIsolated(
    const std::string& path, const std::function<std::unique_ptr<ImageReader>()>& open) {
  return std::make_unique<IsolatedReader>(path, open);
}

}  // namespace vdb_madf::detail
