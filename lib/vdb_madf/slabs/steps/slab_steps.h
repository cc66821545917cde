// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <chrono>
#include <vector>

#include "vdb_madf/base/detail/pages.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/slabs/steps/slab_plan.h"

namespace vdb_madf::detail {

/// Runs the steps. A step is a function of a slab: of the pieces that the steps before left of it,
/// and of the messages that other slabs sent to it. Each slab notes in scratch which step it has
/// done, so that a run that goes on skips those; what it does not need any more it forgets (Step of
/// pieces.h).
class SlabSteps {
 public:
  SlabSteps(const SlabPlan& plan, SlabStore& store, Team& team, bool isFiltered,
            Interrupter* interrupter);

  /// A step: f(s) for all own slabs, if they have not done it; then messages are exchanged. What
  /// the table of pieces cannot say that a slab forgets after it goes in forget(s).
  template <typename F, typename G>
  void forEachSlab(Step step, const F& f, const G& forget) {
    ++step_;
    for (size_t s = plan_.firstOwn(); s < plan_.endOwn(); ++s) {
      run(step, s, f);
      forget(s);
      returnFreedMemory();  // before the next slab takes as much
    }
    exchange();
  }
  template <typename F>
  void forEachSlab(Step step, const F& f) {
    forEachSlab(step, f, [](size_t) {});
  }
  /// A step of one slab after another, from the lowest or the highest one on: each has the messages
  /// of the one before. For short steps: other members wait.
  template <typename F>
  void upward(Step step, const F& f) {
    ++step_;
    for (int member = 0; member < team_.count(); ++member) {
      if (member == team_.member())
        for (size_t s = plan_.firstOwn(); s < plan_.endOwn(); ++s) run(step, s, f);
      exchange();
    }
  }
  template <typename F>
  void downward(Step step, const F& f) {
    ++step_;
    for (int member = team_.count(); member-- > 0;) {
      if (member == team_.member())
        for (size_t s = plan_.endOwn(); s-- > plan_.firstOwn();) run(step, s, f);
      exchange();
    }
  }
  /// Has a slab done the next step in a run before?
  bool isBeyond(size_t slab) const { return done_[slab] > step_; }

  /// Messages so far get to their slabs.
  void exchange() {
    ++exchanges_;
    store_.exchange();
  }

  /// What is told of a step on a slab: its share of the whole.
  WorkPart part(Step step, size_t slab) const;

  /// The next part of the work begins.
  void beginStage(const char* name);
  /// What all parts took, by all members; after the last.
  void endStages(SlabSegmentation& result);

 private:
  template <typename F>
  void run(Step step, size_t slab, const F& f) {
    if (done_[slab] < step_) {
      f(slab);
      store_.write(kDone, slab, step_);
      done_[slab] = step_;
    }
    store_.forget(step, slab);
  }

  using Clock = std::chrono::steady_clock;
  void endStage();

  const SlabPlan& plan_;
  SlabStore& store_;
  Team& team_;
  bool isFiltered_;
  Interrupter* interrupter_;
  int step_ = 0;
  int64_t exchanges_ = 0;
  std::vector<SlabStage> stages_;
  Clock::time_point stageStart_;
  int64_t sentBefore_ = 0;  // the stage
  std::vector<int> done_;   // the last step of each own slab
};

}  // namespace vdb_madf::detail
