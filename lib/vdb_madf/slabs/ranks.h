// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/slabs/scratch.h"

namespace vdb_madf {

/// The processes that share the slabs of an object. All run segmentSlabs() at a time, each with its own
/// slabs, which follow each other; what one slab has to tell another goes through here. All call
/// exchange(), sum(), max() and broadcast() in the same order. This one works alone.
class Ranks {
 public:
  Ranks() = default;
  virtual ~Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  virtual int count() const { return 1; }
  virtual int rank() const { return 0; }

  /// Slabs are dealt evenly: rank r has those from firstSlab(r, slabs) to before firstSlab(r + 1, slabs);
  /// rank 0 has some if there are any.
  size_t firstSlab(int rank, size_t slabs) const {
    const auto ranks = size_t(count());
    return (slabs * size_t(rank) + ranks - 1) / ranks;
  }
  int ownerOf(size_t slab, size_t slabs) const { return int(slab * size_t(count()) / slabs); }

  /// A piece for the scratch of a rank: of this one, `own`, at once; of another one, which has it after
  /// the next exchange(). (To a scratch that is shared this one writes it, and tells its name.)
  void send(int to, const std::string& name, const Bytes& bytes, Scratch& own) {
    if (to == rank() || own.isShared()) own.write(name, bytes);
    if (to != rank()) post(to, name, own.isShared() ? Bytes() : bytes);
  }
  /// Waits for all; puts the pieces that came into `own`.
  /// @throw IoError if `own` is shared and lacks one: its file system does not show it to all
  virtual void exchange(Scratch& /*own*/) {}

  /// Sums and maxima over the ranks, value by value.
  virtual void sum(std::vector<int64_t>& /*values*/) {}
  virtual void max(std::vector<int64_t>& /*values*/) {}
  /// Gives all what rank 0 has.
  virtual void broadcast(Bytes& /*bytes*/) {}

 protected:
  /// What has come with an exchange().
  static void receive(const std::string& name, const Bytes& bytes, Scratch& own) {
    if (!own.isShared())
      own.write(name, bytes);
    else if (!own.has(name))
      throw IoError(name +
                    ": another process has written this piece of scratch data, and it is not "
                    "seen here: choose a folder whose file system shows all processes the same");
  }

 private:
  /// send() to another rank.
  virtual void post(int /*to*/, const std::string& /*name*/, const Bytes& /*bytes*/) {}
};

}  // namespace vdb_madf
