// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <sys/resource.h>

#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "vdb_madf/errors.h"
#include "vdb_madf/image_file.h"

namespace vdb_madf::test {

/// How many changed files of a format are tried: `usual`, or VDB_MADF_MUTATIONS of the environment.
inline int mutationsPerFormat(int usual) {
  const char* text = std::getenv("VDB_MADF_MUTATIONS");
  return text ? std::stoi(text) : usual;
}

/// Seconds of computing that a file of some kilobytes may take, under sanitizers too.
constexpr double kMostSeconds = 5;

/// Opens a volume and reads all of it, eight slices at a time. Empty if it reads or is properly
/// refused: soon, with one line that names the path. Else what is wrong.
/// @param fileBytes of all its files
/// @param expansion how many bytes of samples a byte of the file may stand for
inline std::string complaint(const std::string& path, uint64_t fileBytes, uint64_t expansion,
                             const std::string& dataset = "") {
  std::string message;
  const std::clock_t start = std::clock();
  const auto isSlow = [&] {
    return double(std::clock() - start) > kMostSeconds * double(CLOCKS_PER_SEC);
  };
  try {
    const auto image = openImage(path, {}, dataset);
    const ImageInfo& info = image->info();
    const uint64_t slice =
        uint64_t(info.size.x()) * uint64_t(info.size.y()) * sampleSize(info.type);
    if (slice > expansion * fileBytes) return "claims too much: " + std::to_string(slice);
    const int step = std::min(8, info.size.z());
    std::vector<char> slab(size_t(slice) * size_t(step));
    for (int z = 0; z < info.size.z(); z += step)
      image->read(z, std::min(step, info.size.z() - z), slab.data());
    return isSlow() ? "takes long" : "";
  } catch (const IoError& error) {
    message = error.what();
  } catch (const InvalidInput& error) {
    message = error.what();
  } catch (const std::exception& error) {
    return std::string("another exception: ") + error.what();
  }
  if (isSlow()) return "is refused late: " + message;
  if (message.find(path) == std::string::npos) return "does not name the file: " + message;
  if (message.find('\n') != std::string::npos) return "more than one line: " + message;
  if (message.size() > 2 * path.size() + 400) return "a long message: " + message;
  return {};
}

/// One to four changes at random, three of four within the first `headerBytes`.
inline std::string mutated(std::string bytes, size_t headerBytes, unsigned seed) {
  std::mt19937 random(seed);
  const int changes = 1 + int(random() % 4);
  for (int i = 0; i < changes; ++i) {
    const size_t span = random() % 4 ? headerBytes : bytes.size();
    const size_t place = random() % std::min(span, bytes.size());
    switch (random() % 6) {
      case 0:
        bytes[place] = char(bytes[place] ^ (1 << random() % 8));
        break;
      case 1:
        bytes[place] = char(random());
        break;
      case 2:
        bytes[place] = "0123456789-\n =:.e"[random() % 17];
        break;
      case 3:
        bytes[place] = char(random() % 2 ? 0xff : 0);
        break;
      case 4:
        bytes.erase(place, 1 + random() % 8);
        break;
      default:
        bytes.insert(place, std::string(1 + random() % 8, char(random())));
        break;
    }
    if (bytes.empty()) bytes = "x";
  }
  return bytes;
}

/// While it lives, this process gets at most so much more memory; then allocations fail.
/// No limit where the address space is already full of a sanitizer's shadow.
class MemoryLimit {
 public:
  explicit MemoryLimit(uint64_t bytes) {
    getrlimit(RLIMIT_AS, &before_);
    uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const uint64_t used = pages * 4096;
    rlimit limit = before_;
    limit.rlim_cur = used + bytes;
    if (pages > 0 && used < uint64_t(1) << 40) setrlimit(RLIMIT_AS, &limit);
  }
  ~MemoryLimit() { setrlimit(RLIMIT_AS, &before_); }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  rlimit before_;
};

}  // namespace vdb_madf::test
