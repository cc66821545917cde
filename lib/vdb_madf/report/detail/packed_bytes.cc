// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/detail/packed_bytes.h"

#include <zlib.h>

#include <algorithm>
#include <new>

namespace vdb_madf::detail {

namespace {

constexpr size_t kPiece = size_t(1) << 16;

}  // namespace

std::string base64(const std::string& bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

struct PackedBytes::Stream {
  z_stream z{};
};

PackedBytes::PackedBytes() : stream_(std::make_unique<Stream>()) {
  if (deflateInit(&stream_->z, 9) != Z_OK) throw std::bad_alloc();
}

PackedBytes::~PackedBytes() {
  deflateEnd(&stream_->z);
}

void PackedBytes::bytes(const void* data, size_t count) {
  const auto* from = static_cast<const uint8_t*>(data);
  while (count > 0) {
    const size_t piece = std::min(count, kPiece);
    pending_.insert(pending_.end(), from, from + piece);
    if (pending_.size() >= kPiece) compress(Z_NO_FLUSH);
    from += piece;
    count -= piece;
  }
}

void PackedBytes::variable(uint64_t value) {
  for (; value >= 128; value >>= 7) pending_.push_back(uint8_t(value | 128));
  pending_.push_back(uint8_t(value));
  if (pending_.size() >= kPiece) compress(Z_NO_FLUSH);
}

void PackedBytes::compress(int flush) {
  z_stream& z = stream_->z;
  char piece[kPiece];
  z.next_in = pending_.data();
  z.avail_in = uInt(pending_.size());
  do {
    z.next_out = reinterpret_cast<Bytef*>(piece);
    z.avail_out = sizeof piece;
    deflate(&z, flush);
    packed_.append(piece, sizeof piece - z.avail_out);
  } while (z.avail_out == 0);
  pending_.clear();
}

std::string PackedBytes::text() {
  compress(Z_FINISH);
  return base64(packed_);
}

}  // namespace vdb_madf::detail
