// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/domain.h"
#include "vdb_madf/measure/detail/domain_pairs.h"

namespace vdb_madf::detail {

/// Follows the correlation of an object along an axis from lag to lag, until it has fallen to 1/e.
class CorrelationDecay {
 public:
  /// \p voxels: of the object, 1 or more.
  CorrelationDecay(int64_t voxels, const Domain& domain, int axis);

  int lag() const { return lag_; }  ///< that is next, 1 at first
  bool isDone() const { return isDone_; }
  /// \p pairs: of object voxels lag() apart. Unless isDone(). @throw Interrupted
  void add(int64_t pairs, Interrupter* interrupter);
  const std::optional<double>& length() const { return length_; }  ///< see correlation_length.h

 private:
  double share_;
  DomainPairs all_;
  int extent_;
  int lag_ = 0;
  double before_ = 1;
  bool isDone_ = false;
  std::optional<double> length_;

  void moveOn();
};

}  // namespace vdb_madf::detail
