// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <exception>
#include <vector>

#include "vdb_madf/slabs/team.h"

namespace vdb_madf::tools {

/// Another process of the job failed, and says why.
struct OtherMemberFailed {};

/// f() in all members, which does not wait for others. If it throws in one, it fails in all.
/// @throw what f() throws; OtherMemberFailed where it does not
template <typename F>
void inAllMembers(Team& team, const F& f) {
  std::exception_ptr failure;
  try {
    f();
  } catch (...) {
    failure = std::current_exception();
  }
  std::vector<int64_t> failures{failure ? 1 : 0};
  team.sum(failures);
  if (failure) std::rethrow_exception(failure);
  if (failures[0] > 0) throw OtherMemberFailed();
}

}  // namespace vdb_madf::tools
