// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "vdb_madf/base/detail/pages.h"

namespace vdb_madf {

/// Plain data. What is added to it has to be written: it is not cleared.
using Bytes = std::vector<char, detail::PageAllocator<char>>;

/// Where the slabs are that are not being worked on: named pieces of bytes.
class Scratch {
 public:
  Scratch() = default;
  virtual ~Scratch() = default;
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  /// Replaces what has that name.
  virtual void writeBytes(const std::string& name, const char* bytes, size_t size) = 0;
  /// Gives the memory for that many bytes.
  using Allocate = std::function<char*(size_t size)>;
  /// Calls allocate() once. If reading fails, some of the bytes may be there.
  virtual void readBytes(const std::string& name, const Allocate& allocate) const = 0;
  virtual bool has(const std::string& name) const = 0;
  virtual void remove(const std::string& name) = 0;

  void write(const std::string& name, const Bytes& bytes) {
    writeBytes(name, bytes.data(), bytes.size());
  }
  Bytes read(const std::string& name) const {
    Bytes bytes;
    readBytes(name, [&](size_t size) {
      bytes.resize(size);
      return bytes.data();
    });
    return bytes;
  }

  /// Is it one and the same for all members, so that each has what another one writes?
  virtual bool isShared() const { return false; }
};

/// A scratch in memory, for volumes that fit.
class MemoryScratch : public Scratch {
 public:
  void writeBytes(const std::string& name, const char* bytes, size_t size) override {
    pieces_[name].assign(bytes, bytes + size);
  }
  void readBytes(const std::string& name, const Allocate& allocate) const override {
    const Bytes& bytes = pieces_.at(name);
    std::copy(bytes.begin(), bytes.end(), allocate(bytes.size()));
  }
  bool has(const std::string& name) const override { return pieces_.count(name) > 0; }
  void remove(const std::string& name) override { pieces_.erase(name); }

 private:
  std::map<std::string, Bytes> pieces_;
};

}  // namespace vdb_madf
