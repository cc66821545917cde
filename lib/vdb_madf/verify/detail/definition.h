// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "vdb_madf/grids/domain.h"

namespace vdb_madf::detail {

/// Everything but the object that decides labels, as their metadata tell it.
struct Definition {
  std::optional<Domain> domain;
  bool open = false;
  int64_t gamma = 0, fillHoles = 0, minGrain = 0, tidy = 0;
  std::array<int64_t, 3> weights{1, 1, 1};
  std::string merge;      ///< "score", "both", "angle" or "neck"
  double strictness = 0;  ///< of "score"
  double theta = 0;       ///< of the others, as the next two
  bool cell = false;
  int64_t delta = 0;

  /// @throw InvalidInput if something is not there, or is none that verify() knows
  explicit Definition(const openvdb::MetaMap& metadata);
};

}  // namespace vdb_madf::detail
