// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/folder_scratch.h"

#include <blosc.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <tuple>

#include "vdb_madf/base/detail/checksum.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/folder_lock.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/detail/output_stream.h"

namespace vdb_madf {

namespace {

namespace fs = std::filesystem;

constexpr char kWork[] = "work";
constexpr char kEnding[] = ".piece";
constexpr const char* kLock = detail::FolderLock::kName;

/// What a file of a piece begins with; the table of its blocks follows, then these.
struct Header {
  std::array<char, 8> magic{'m', 'a', 'd', 'f', 'p', 'c', '0', '4'};
  uint64_t size = 0;                   ///< of the bytes, before they were compressed
  std::array<uint64_t, 2> checksum{};  ///< of the table
};

/// Compressed by itself: 32-bit numbers that are mostly like the one before.
constexpr size_t kBlock = size_t(1) << 22;

/// A block as it is stored: compressed, with the checksum of that.
struct Block {
  uint64_t size = 0;
  std::array<uint64_t, 2> checksum{};
};

size_t blockCount(size_t size) {
  return (size + kBlock - 1) / kBlock;
}

/// f(block) in parallel.
template <typename F>
void forEachBlock(size_t size, const F& f) {
  detail::parallelForEach(blockCount(size), 1, nullptr, [&](size_t i) { f(i); });
}

/// What killed programs were writing: see OutputFile.
bool isHalfWritten(const fs::path& path) {
  const std::string name = path.filename().string();
  return name[0] == '.' && name.find(std::string(kEnding) + ".") != std::string::npos &&
         path.extension() == ".tmp";
}

void removeHalfWritten(const std::string& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (isHalfWritten(entry.path())) files.push_back(entry.path());
  for (const fs::path& file : files) fs::remove(file, error);
}

std::string pathOf(const std::string& path) {
  return (fs::path(path).lexically_normal() / "").parent_path().string();
}

/// Adds the time that it lives.
class Timer {
 public:
  explicit Timer(double& seconds) : seconds_(seconds) {}
  ~Timer() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

void failDamagedScratch(const std::string& path) {
  throw IoError(path + ": the scratch data is damaged: remove its folder and begin anew");
}

FolderScratch::FolderScratch(const std::string& path) : path_(pathOf(path)), isShared_(true) {
  if (!has(kWork))
    throw IoError(path_ + ": is not there for all processes: choose a folder that all see");
  lock_ = std::make_unique<detail::FolderLock>(path_, detail::FolderLock::Kind::shared);
}

FolderScratch::FolderScratch(const std::string& path, const std::string& work, bool resume)
    : path_(pathOf(path)) {
  std::error_code error;
  const bool isNew = fs::create_directory(path_, error);
  if (error)
    throw IoError("cannot make " + path_ + ": " + error.message() +
                  "; give the path of a folder, in one that is there");
  bool isEmpty = true;
  for (const auto& entry : fs::directory_iterator(path_, error))
    isEmpty = isEmpty && (entry.path().filename() == kLock || isHalfWritten(entry.path()));
  if (!isEmpty && !has(kWork))
    throw IoError(path_ + ": is no folder of scratch data: choose another one");
  lock_ = std::make_unique<detail::FolderLock>(path_);
  try {
    take(work, resume, isEmpty);
  } catch (...) {
    std::error_code ignored;
    if (isEmpty) fs::remove(file(kLock), ignored);
    if (isNew) fs::remove(path_, ignored);
    throw;
  }
}

FolderScratch::~FolderScratch() = default;

void FolderScratch::share() {
  lock_->share();
  isShared_ = true;
}

void FolderScratch::take(const std::string& work, bool resume, bool isEmpty) {
  if (!isEmpty && !resume)
    throw IoError(
        path_ +
        ": there is scratch data of a run that did not end: resume it, or remove the folder");
  const Bytes before = isEmpty ? Bytes() : read(kWork);
  if (!isEmpty && std::string(before.begin(), before.end()) != work)
    throw InvalidInput(
        path_ +
        ": the scratch data was made of another input or with other options: remove the folder, or "
        "give the same ones");
  removeHalfWritten(path_);
  if (isEmpty) write(kWork, {work.begin(), work.end()});
}

std::string FolderScratch::file(const std::string& name) const {
  return (fs::path(path_) / name).string();
}

void FolderScratch::writeBytes(const std::string& name, const char* bytes, size_t size) {
  const Timer timer(seconds_);
  Header header;
  header.size = size;
  std::vector<Block> table(blockCount(size));
  std::vector<Bytes> blocks(table.size());
  forEachBlock(size, [&](size_t i) {
    const size_t part = std::min(kBlock, size - i * kBlock);
    blocks[i].resize(part + BLOSC_MAX_OVERHEAD);
    const int written = blosc_compress_ctx(1, BLOSC_SHUFFLE, 4, part, bytes + i * kBlock,
                                           blocks[i].data(), blocks[i].size(), "lz4", 0, 1);
    if (written <= 0) throw IoError(file(name + kEnding) + ": cannot be compressed");
    blocks[i].resize(size_t(written));
    table[i] = {blocks[i].size(), detail::checksumOf(blocks[i].data(), blocks[i].size())};
  });
  const auto* tableBytes = reinterpret_cast<const char*>(table.data());
  header.checksum = detail::checksumOf(tableBytes, table.size() * sizeof(Block));
  detail::OutputStream out(file(name + kEnding));
  out.bytes(&header, sizeof header);
  out.bytes(tableBytes, table.size() * sizeof(Block));
  for (const Bytes& block : blocks) out.bytes(block.data(), block.size());
  out.commit(lasts_);
}

void FolderScratch::readBytes(const std::string& name, const Allocate& allocate) const {
  const Timer timer(seconds_);
  const std::string path = file(name + kEnding);
  const detail::InputFile in(path);
  Header header;
  if (in.readSome(0, &header, sizeof header) != sizeof header || header.magic != Header().magic)
    failDamagedScratch(path);
  // LZ4 cannot make less than a 255th of what it gets.
  if (header.size / 256 > in.size()) failDamagedScratch(path);
  std::vector<Block> table(blockCount(header.size));
  const size_t tableBytes = table.size() * sizeof(Block);
  if (in.readSome(sizeof header, table.data(), tableBytes) != tableBytes ||
      detail::checksumOf(reinterpret_cast<const char*>(table.data()), tableBytes) !=
          header.checksum)
    failDamagedScratch(path);
  std::vector<uint64_t> place{sizeof header + tableBytes};
  for (const Block& block : table) {
    if (block.size > kBlock + BLOSC_MAX_OVERHEAD) failDamagedScratch(path);
    place.push_back(place.back() + block.size);
  }
  if (place.back() != in.size()) failDamagedScratch(path);
  char* const bytes = allocate(header.size);
  forEachBlock(header.size, [&](size_t i) {
    Bytes stored(table[i].size);
    in.read(place[i], stored.data(), stored.size());
    const size_t size = std::min<size_t>(kBlock, header.size - i * kBlock);
    size_t held = 0;
    if (detail::checksumOf(stored.data(), stored.size()) != table[i].checksum ||
        blosc_cbuffer_validate(stored.data(), stored.size(), &held) != 0 || held != size ||
        blosc_decompress_ctx(stored.data(), bytes + i * kBlock, size, 1) != int(size))
      failDamagedScratch(path);
  });
}

bool FolderScratch::has(const std::string& name) const {
  std::error_code error;
  const bool isThere = fs::exists(file(name + kEnding), error);
  if (error) throw IoError(file(name + kEnding) + ": " + error.message());
  return isThere;
}

void FolderScratch::remove(const std::string& name) {
  std::error_code ignored;
  fs::remove(file(name + kEnding), ignored);
}

void FolderScratch::removeAll() {
  // The oldest first, and last what says whose data it is: what a kill leaves can be taken up, and
  // removed, again.
  std::error_code error;
  std::vector<std::tuple<bool, fs::file_time_type, fs::path>> files;
  for (const auto& entry : fs::directory_iterator(path_, error)) {
    const fs::path name = entry.path().filename();
    const bool isLast = name == std::string(kWork) + kEnding || name == kLock;
    files.emplace_back(isLast, fs::last_write_time(entry.path(), error), entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) fs::remove(std::get<fs::path>(file), error);
  fs::remove(path_, error);
}

}  // namespace vdb_madf
