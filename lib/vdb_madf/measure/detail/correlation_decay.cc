// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/correlation_decay.h"

#include <cmath>

namespace vdb_madf::detail {

CorrelationDecay::CorrelationDecay(int64_t voxels, const Domain& domain, int axis)
    : share_(double(voxels) / double(domain.voxelCount())),
      all_(domain, axis),
      extent_(domain.box().dim()[axis]) {
  moveOn();
}

void CorrelationDecay::moveOn() {
  ++lag_;
  isDone_ = !(share_ < 1) || 2 * int64_t(lag_) > extent_;
}

void CorrelationDecay::add(int64_t pairs, Interrupter* interrupter) {
  const double all = all_.count(lag_, interrupter);
  if (all == 0) {
    isDone_ = true;
    return;
  }
  const double target = std::exp(-1.0);
  const double both = double(pairs) / all;
  const double correlation = (both - share_ * share_) / (share_ - share_ * share_);
  if (correlation <= target) {
    length_ = lag_ - 1 + (before_ - target) / (before_ - correlation);
    isDone_ = true;
    return;
  }
  before_ = correlation;
  moveOn();
}

}  // namespace vdb_madf::detail
