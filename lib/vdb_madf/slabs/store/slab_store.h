// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/slabs/store/pieces.h"
#include "vdb_madf/slabs/team.h"

namespace vdb_madf::detail {

/// What concerns the whole is done by one member, the owner of this slab.
constexpr size_t kRoot = 0;

/// The leaves of an object, or of a part of it, in scratch.
void writeLeaves(Scratch& scratch, const std::string& name, const Leaves& leaves);
Leaves readLeaves(const Scratch& scratch, const std::string& name);
/// What a slab holds of the object, as SlabBuilder left it.
inline Leaves storedObject(const Scratch& scratch, size_t slab) {
  return readLeaves(scratch, kObject.of(slab));
}

/// Reads and writes the pieces and messages of slabs (pieces.h). A value of another type than the
/// table says does not compile.
class SlabStore {
 public:
  SlabStore(size_t slabCount, Scratch& scratch, Team& team)
      : slabCount_(slabCount), scratch_(&scratch), team_(&team) {}

  // Pieces of an own slab.
  bool has(const StoredName& piece, size_t slab) const { return scratch_->has(piece.of(slab)); }
  template <typename T>
  void write(const Piece<T>& piece, size_t slab, const AsIs<T>& value) {
    scratch_->write(piece.of(slab), bytesOf<T>(value));
  }
  template <typename T>
  T read(const Piece<T>& piece, size_t slab) const {
    return valueOf<T>(scratch_->read(piece.of(slab)));
  }
  void remove(const StoredName& piece, size_t slab) { scratch_->remove(piece.of(slab)); }
  /// Values of voxels are written and read without a copy of them.
  template <typename T>
  void write(const Piece<VoxelArray<T>>& piece, size_t slab, const VoxelArray<T>& values) {
    scratch_->writeBytes(piece.of(slab), reinterpret_cast<const char*>(values.data()),
                         values.size() * sizeof(T));
  }
  template <typename T>
  VoxelArray<T> read(const Piece<VoxelArray<T>>& piece, size_t slab) const {
    VoxelArray<T> values;
    scratch_->readBytes(piece.of(slab), [&](size_t size) {
      if (size % sizeof(T) != 0) throw IoError("the scratch data is damaged");
      values = VoxelArray<T>(size / sizeof(T));
      return reinterpret_cast<char*>(values.data());
    });
    return values;
  }

  /// Sends from slab to slab; it is there after the next exchange.
  template <typename T>
  void send(const Message<T>& message, size_t from, size_t to, const AsIs<T>& value) {
    const Bytes bytes = bytesOf<T>(value);
    if (from != to) sentBytes_ += int64_t(bytes.size());
    team_->send(team_->ownerOf(to, slabCount_), nameOf(message, from, to), bytes, *scratch_);
  }
  /// T() if none was sent.
  template <typename T>
  T receive(const Message<T>& message, size_t from, size_t to) const {
    const std::string name = nameOf(message, from, to);
    return scratch_->has(name) ? valueOf<T>(scratch_->read(name)) : T();
  }
  /// The values of all slabs, from the lowest on.
  template <typename T>
  Values<T> receiveAll(const Message<Values<T>>& message, size_t to) const {
    Values<T> all;
    for (size_t from = 0; from < slabCount_; ++from) {
      const Values<T> more = receive(message, from, to);
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  }
  void removeMessage(const StoredName& message, size_t from, size_t to) {
    scratch_->remove(nameOf(message, from, to));
  }

  /// Gives a piece of a slab, or what is named like one, to another member.
  template <typename T>
  void give(int member, const Piece<T>& piece, size_t slab, const AsIs<T>& value) {
    const Bytes bytes = bytesOf<T>(value);
    sentBytes_ += int64_t(bytes.size());
    team_->send(member, piece.of(slab), bytes, *scratch_);
  }

  /// What the root has.
  template <typename T>
  T broadcast(const T& value) const {
    Bytes bytes = bytesOf<T>(value);
    team_->broadcast(bytes);
    return valueOf<T>(std::move(bytes));
  }

  /// Messages so far get to their slabs.
  void exchange() { team_->exchange(*scratch_); }

  /// Forgets what a slab does not need after a step that it has done.
  void forget(Step step, size_t slab);

  int64_t sentBytes() const { return sentBytes_; }
  bool isShared() const { return scratch_->isShared(); }

 private:
  template <typename T>
  static Bytes bytesOf(const T& value) {
    ByteWriter bytes;
    Stored<T>::write(bytes, value);
    return bytes.bytes();
  }
  template <typename T>
  static T valueOf(Bytes bytes) {
    return Stored<T>::read(ByteReader(std::move(bytes)));
  }
  static std::string nameOf(const StoredName& message, size_t from, size_t to) {
    return message.of(from) + "-" + std::to_string(to);
  }

  size_t slabCount_;
  Scratch* scratch_;
  Team* team_;
  int64_t sentBytes_ = 0;
};

}  // namespace vdb_madf::detail
