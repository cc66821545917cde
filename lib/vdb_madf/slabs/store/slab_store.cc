// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/store/slab_store.h"

namespace vdb_madf::detail {

void writeLeaves(Scratch& scratch, const std::string& name, const Leaves& leaves) {
  ByteWriter bytes;
  bytes.add(leaves);
  scratch.write(name, bytes.bytes());
}

Leaves readLeaves(const Scratch& scratch, const std::string& name) {
  return ByteReader(scratch.read(name)).vector<LeafIndex::LeafVoxels>();
}

void SlabStore::forget(Step step, size_t slab) {
  const auto forgetPiece = [&](const StoredName& piece) {
    if (piece.last == step) remove(piece, slab);
  };
  const auto forgetMessage = [&](const StoredName& message, From from) {
    if (message.last != step) return;
    const bool fromAll = from == From::all;
    for (size_t s = 0; fromAll && s < slabCount_; ++s) removeMessage(message, s, slab);
    if (from == From::below || from == From::neighbors) removeMessage(message, slab - 1, slab);
    if (from == From::above || from == From::neighbors) removeMessage(message, slab + 1, slab);
  };
  forEachForgotten(forgetPiece, forgetMessage);
}

}  // namespace vdb_madf::detail
