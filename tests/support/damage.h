// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>

namespace vdb_madf::test {

/// How many changed files of a format are tried: `usual`, or VDB_MADF_MUTATIONS of the environment.
inline int mutationsPerFormat(int usual) {
  const char* text = std::getenv("VDB_MADF_MUTATIONS");
  return text ? std::stoi(text) : usual;
}

/// Seconds of computing that a file of some kilobytes may take, under sanitizers too.
constexpr double kMaxSeconds = 5;

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
