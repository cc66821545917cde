// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace vdb_madf {

/// One grid per grain is for looking at some, not for a sample: each costs at least 300 KB.
constexpr size_t kMaxGrainGrids = 2000;

/// "grain_000123": what a grain is called in every file.
std::string grainName(int32_t label);

}  // namespace vdb_madf
