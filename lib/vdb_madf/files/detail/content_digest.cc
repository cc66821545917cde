// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/content_digest.h"

#include <algorithm>
#include <cstring>

#include "vdb_madf/base/detail/checksum.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/verified_files.h"

namespace vdb_madf::detail {

namespace {

/// Four sums of every fourth word, which do not wait for each other, make one of all words.
std::array<uint64_t, 2> sumOfPiece(uint64_t position, const char* bytes, size_t size) {
  constexpr size_t kWord = sizeof(uint64_t), kStep = 4 * kWord;
  uint64_t a = 1, b = 2, c = 3, d = 4;
  const auto mix = [](uint64_t& lane, const char* from) {
    uint64_t word;
    std::memcpy(&word, from, kWord);
    lane = (lane ^ word) * 0xff51afd7ed558ccdu;
    lane ^= lane >> 32;
  };
  Checksum sum;
  sum.add(position);
  sum.add(size);
  for (; size >= kStep; size -= kStep, bytes += kStep) {
    mix(a, bytes);
    mix(b, bytes + kWord);
    mix(c, bytes + 2 * kWord);
    mix(d, bytes + 3 * kWord);
  }
  for (const uint64_t lane : {a, b, c, d}) sum.add(lane);
  addToChecksum(sum, bytes, size);
  return sum.value();
}

}  // namespace

ContentSum::ContentSum(int64_t size, int64_t leftStart, int64_t left)
    : size_(size),
      leftStart_(leftStart),
      leftEnd_(leftStart + left),
      added_((size_t(size) + kPart - 1) / kPart) {}

void ContentSum::addPart(int64_t position, const char* bytes, size_t count) {
  const size_t part = size_t(position) / kPart;
  if (part >= added_.size() || added_[part]) return;
  added_[part] = 1;
  const int64_t end = position + int64_t(count);
  addPiece(position, std::min(end, leftStart_), bytes);
  const int64_t first = std::max(position, leftEnd_);
  addPiece(first, end, bytes + (first - position));
}

void ContentSum::addPiece(int64_t first, int64_t last, const char* bytes) {
  if (first >= last) return;
  const auto sum = sumOfPiece(uint64_t(first), bytes, size_t(last - first));
  for (size_t i = 0; i < sums_.size(); ++i) sums_[i] += sum[i];
}

void ContentSum::addRest(const Read& read, Interrupter* interrupter) {
  parallelFor(added_.size(), 16, interrupter, [&](size_t begin, size_t end) {
    std::vector<char> bytes;
    for (size_t part = begin; part < end; ++part) {
      if (added_[part]) continue;
      const uint64_t position = part * kPart;
      bytes.resize(std::min(kPart, size_t(size_) - position));
      read(position, bytes.data(), bytes.size());
      addPart(int64_t(position), bytes.data(), bytes.size());
    }
  });
}

std::string digestOf(const std::string& bytes) {
  return checksumText(checksumOf(bytes.data(), bytes.size()));
}

void requireDigest(const std::string& file, const std::string& stored, const std::string& found) {
  if (stored.empty() || stored == found || !filesAreVerified()) return;
  throw IoError("the content of " + file + " is not what was written (digest " + found +
                    " instead of " + stored +
                    "): copy or make it again, or, if it was changed on purpose, do not verify it",
                Hint::unverified);
}

}  // namespace vdb_madf::detail
