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

/// The processes that share the slabs of an object. All run segmentSlabs() at a time, each with its
/// own slabs, which follow each other; what one slab has to tell another goes through here. All
/// call exchange(), sum(), max() and broadcast() in the same order. This one works alone.
class Team {
 public:
  Team() = default;
  virtual ~Team() = default;
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  virtual int count() const { return 1; }
  virtual int member() const { return 0; }

  /// Slabs are dealt evenly: member r has those from firstSlab(r, slabs) to before firstSlab(r + 1,
  /// slabs); member 0 has some if there are any.
  size_t firstSlab(int member, size_t slabs) const {
    const auto members = size_t(count());
    return (slabs * size_t(member) + members - 1) / members;
  }
  int ownerOf(size_t slab, size_t slabs) const { return int(slab * size_t(count()) / slabs); }

  /// A piece for the scratch of a member: of this one, `own`, at once; of another one, which has it
  /// after the next exchange(). (To a scratch that is shared this one writes it, and tells its
  /// name.)
  void send(int to, const std::string& name, const Bytes& bytes, Scratch& own) {
    if (to == member() || own.isShared()) own.write(name, bytes);
    if (to != member()) post(to, name, own.isShared() ? Bytes() : bytes);
  }
  /// Waits for all; puts the pieces that came into `own`.
  /// @throw IoError if `own` is shared and lacks one: its file system does not show it to all
  virtual void exchange(Scratch& /*own*/) {}

  /// Sums and maxima over the members, value by value.
  virtual void sum(std::vector<int64_t>& /*values*/) {}
  virtual void max(std::vector<int64_t>& /*values*/) {}
  /// Gives all what member 0 has.
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
  /// send() to another member.
  virtual void post(int /*to*/, const std::string& /*name*/, const Bytes& /*bytes*/) {}
};

}  // namespace vdb_madf
