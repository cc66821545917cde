// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_work.h"

#include <algorithm>

namespace vdb_madf::detail {

SlabWork::SlabWork(const SlabObject& cut, const SegmentOptions& how, Scratch& pieces, Ranks& team,
                   Interrupter* stop)
    : object(cut),
      options(how),
      scratch(pieces),
      ranks(team),
      interrupter(stop),
      done_(cut.slabCount(), 0) {
  for (size_t s = firstOwn(); s < endOwn(); ++s)
    if (has("step", s)) done_[s] = readVector<int>("step", s).at(0);
}

size_t SlabWork::slabOf(int z) const {
  const std::vector<int>& cuts = object.cuts;
  return size_t(std::upper_bound(cuts.begin(), cuts.end(), z) - cuts.begin()) - 1;
}

void SlabWork::send(const char* what, size_t from, size_t to, const ByteWriter& bytes) {
  const int owner = ranks.ownerOf(to, slabCount());
  if (owner == ranks.rank())
    scratch.write(name(what, from, to), bytes.bytes());
  else
    ranks.send(owner, name(what, from, to), bytes.bytes(), scratch);
}

}  // namespace vdb_madf::detail
