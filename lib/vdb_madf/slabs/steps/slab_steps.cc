// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_steps.h"

namespace vdb_madf::detail {

namespace {

/// The per cent of the whole that a step takes.
struct Share {
  int begin, end;
};
Share shareOf(Step step, bool isFiltered) {
  switch (step) {
    case Step::cavities:
      return {0, 5};
    case Step::distances:
    case Step::offers:
      return {5, 10};
    case Step::cells:
      return {10, 35};
    case Step::keptMap:
      return {35, 55};
    case Step::flow:
      return {isFiltered ? 65 : 10, 75};
    case Step::smoothing:
      return {75, 85};
    case Step::labels:
      return {85, 100};
    default:
      return {75, 75};  // tables alone
  }
}

}  // namespace

SlabSteps::SlabSteps(const SlabPlan& plan, SlabStore& store, Team& team, bool isFiltered,
                     Interrupter* interrupter)
    : plan_(plan),
      store_(store),
      team_(team),
      isFiltered_(isFiltered),
      interrupter_(interrupter),
      done_(plan.slabCount(), 0) {
  for (size_t s = plan.firstOwn(); s < plan.endOwn(); ++s)
    if (store.has(kDone, s)) done_[s] = store.read(kDone, s);
}

WorkPart SlabSteps::part(Step step, size_t slab) const {
  const Share share = shareOf(step, isFiltered_);
  const double each = double(share.end - share.begin) / double(plan_.endOwn() - plan_.firstOwn());
  const auto i = double(slab - plan_.firstOwn());
  return {interrupter_, int(share.begin + each * i), int(share.begin + each * (i + 1))};
}

void SlabSteps::beginStage(const char* name) {
  endStage();
  stages_.push_back({name, 0, 0});
  stageStart_ = Clock::now();
  sentBefore_ = store_.sentBytes();
}

void SlabSteps::endStage() {
  if (stages_.empty()) return;
  stages_.back().seconds = std::chrono::duration<double>(Clock::now() - stageStart_).count();
  stages_.back().messageBytes = store_.sentBytes() - sentBefore_;
}

void SlabSteps::endStages(SlabSegmentation& result) {
  endStage();
  std::vector<int64_t> bytes, nanoseconds;
  for (const SlabStage& stage : stages_) {
    bytes.push_back(stage.messageBytes);
    nanoseconds.push_back(int64_t(stage.seconds * 1e9));
  }
  team_.sum(bytes);
  team_.max(nanoseconds);
  for (size_t i = 0; i < stages_.size(); ++i)
    result.stages.push_back({stages_[i].name, double(nanoseconds[i]) * 1e-9, bytes[i]});
  result.exchanges = exchanges_;
}

}  // namespace vdb_madf::detail
