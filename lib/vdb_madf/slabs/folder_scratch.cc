// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/folder_scratch.h"

#include <blosc.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <utility>

#include "vdb_madf/base/detail/checksum.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/detail/output_stream.h"

namespace vdb_madf {

namespace {

namespace fs = std::filesystem;

constexpr char kWork[] = "work";
constexpr char kEnding[] = ".piece";
constexpr char kRemoved[] = ".madf_removed";  // a folder that is going

/// What a file of a piece begins with; its blocks follow, each with its size.
struct Header {
  std::array<char, 8> magic{'m', 'a', 'd', 'f', 'p', 'c', '0', '1'};
  uint64_t size = 0;  ///< of the bytes, before they were compressed
  std::array<uint64_t, 2> checksum{};
};

/// Compressed by itself: 32-bit numbers that are mostly like the one before.
constexpr size_t kBlock = size_t(1) << 22;

std::array<uint64_t, 2> checksumOf(const std::vector<char>& bytes) {
  detail::Checksum sum;
  sum.add(bytes.size());
  for (size_t i = 0; i < bytes.size(); i += 8) {
    uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min<size_t>(8, bytes.size() - i));
    sum.add(word);
  }
  return sum.value();
}

std::vector<std::vector<char>> compress(const std::vector<char>& bytes) {
  std::vector<std::vector<char>> blocks((bytes.size() + kBlock - 1) / kBlock);
  detail::parallelFor(blocks.size(), 1, nullptr, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t size = std::min(kBlock, bytes.size() - i * kBlock);
      blocks[i].resize(size + BLOSC_MAX_OVERHEAD);
      const int written = blosc_compress_ctx(1, BLOSC_SHUFFLE, 4, size, bytes.data() + i * kBlock,
                                             blocks[i].data(), blocks[i].size(), "lz4", 0, 1);
      blocks[i].resize(size_t(std::max(written, 0)));
    }
  });
  return blocks;
}

/// What killed programs were writing: see OutputFile.
void removeHalfWritten(const std::string& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name[0] == '.' && name.find(std::string(kEnding) + ".") != std::string::npos &&
        entry.path().extension() == ".tmp")
      files.push_back(entry.path());
  }
  for (const fs::path& file : files) fs::remove(file, error);
}

[[noreturn]] void failDamaged(const std::string& path) {
  throw IoError(path + ": the scratch data is damaged: remove its folder and begin anew");
}

}  // namespace

FolderScratch::FolderScratch(std::string path, const std::string& work, bool resume)
    : path_(std::move(path)) {
  std::error_code error;
  fs::remove_all(path_ + kRemoved, error);
  fs::create_directory(path_, error);
  if (error) throw IoError("cannot make " + path_ + ": " + error.message());
  if (resume) removeHalfWritten(path_);
  if (fs::is_empty(path_, error)) {
    write(kWork, {work.begin(), work.end()});
    return;
  }
  if (!resume)
    throw IoError(
        path_ +
        ": there is scratch data of a run that did not end: resume it, or remove the folder");
  if (!has(kWork)) throw IoError(path_ + ": is no folder of scratch data: choose another one");
  const std::vector<char> before = read(kWork);
  if (std::string(before.begin(), before.end()) != work)
    throw InvalidInput(
        path_ +
        ": the scratch data was made of another input or with other options: remove the "
        "folder, or give the same ones");
}

std::string FolderScratch::file(const std::string& name) const {
  return (fs::path(path_) / name).string();
}

void FolderScratch::write(const std::string& name, const std::vector<char>& bytes) {
  Header header;
  header.size = bytes.size();
  header.checksum = checksumOf(bytes);
  detail::OutputStream out(file(name + kEnding));
  out.bytes(&header, sizeof header);
  for (const std::vector<char>& block : compress(bytes)) {
    out.value(uint64_t(block.size()));
    out.bytes(block.data(), block.size());
  }
  out.commit();
}

std::vector<char> FolderScratch::read(const std::string& name) const {
  const std::string path = file(name + kEnding);
  const detail::InputFile in(path);
  Header header;
  if (in.readSome(0, &header, sizeof header) != sizeof header || header.magic != Header().magic)
    failDamaged(path);
  // LZ4 cannot make less than a 255th of what it gets.
  if (header.size / 256 > in.size()) failDamaged(path);
  std::vector<char> bytes(header.size), block;
  uint64_t at = sizeof header;
  for (size_t done = 0; done < bytes.size(); done += kBlock) {
    const size_t size = std::min(kBlock, bytes.size() - done);
    uint64_t stored = 0;
    if (in.readSome(at, &stored, sizeof stored) != sizeof stored ||
        stored > size + BLOSC_MAX_OVERHEAD)
      failDamaged(path);
    block.resize(stored);
    at += sizeof stored;
    size_t held = 0;
    if (in.readSome(at, block.data(), stored) != stored ||
        blosc_cbuffer_validate(block.data(), stored, &held) != 0 || held != size ||
        blosc_decompress_ctx(block.data(), bytes.data() + done, size, 1) != int(size))
      failDamaged(path);
    at += stored;
  }
  if (checksumOf(bytes) != header.checksum) failDamaged(path);
  return bytes;
}

bool FolderScratch::has(const std::string& name) const {
  std::error_code ignored;
  return fs::exists(file(name + kEnding), ignored);
}

void FolderScratch::remove(const std::string& name) {
  std::error_code ignored;
  fs::remove(file(name + kEnding), ignored);
}

void FolderScratch::removeAll() {
  // At once, so that a kill does not leave a part of it.
  std::error_code ignored;
  fs::rename(path_, path_ + kRemoved, ignored);
  fs::remove_all(path_ + kRemoved, ignored);
}

}  // namespace vdb_madf
