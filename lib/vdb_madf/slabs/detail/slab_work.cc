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
  if (from != to && !stages_.empty()) stages_.back().messageBytes += int64_t(bytes.bytes().size());
  ranks.send(ranks.ownerOf(to, slabCount()), name(what, from, to), bytes.bytes(), scratch);
}

void SlabWork::sendTo(int rank, const char* what, size_t slab, const ByteWriter& bytes) {
  if (!stages_.empty()) stages_.back().messageBytes += int64_t(bytes.bytes().size());
  ranks.send(rank, name(what, slab), bytes.bytes(), scratch);
}

void SlabWork::beginStage(const char* name) {
  endStage();
  stages_.push_back({name, 0, 0});
  stageStart_ = Clock::now();
}

void SlabWork::endStage() {
  if (!stages_.empty())
    stages_.back().seconds = std::chrono::duration<double>(Clock::now() - stageStart_).count();
}

void SlabWork::endStages(SlabSegmentation& result) {
  endStage();
  std::vector<int64_t> bytes, nanoseconds;
  for (const SlabStage& stage : stages_) {
    bytes.push_back(stage.messageBytes);
    nanoseconds.push_back(int64_t(stage.seconds * 1e9));
  }
  ranks.sum(bytes);
  ranks.max(nanoseconds);
  for (size_t i = 0; i < stages_.size(); ++i)
    result.stages.push_back({stages_[i].name, double(nanoseconds[i]) * 1e-9, bytes[i]});
  result.exchanges = exchanges_;
}

}  // namespace vdb_madf::detail
