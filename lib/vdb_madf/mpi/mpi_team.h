// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/slabs/team.h"

namespace vdb_madf {

/// The processes of an MPI job (MPI_COMM_WORLD), each a member. All calls are made by the thread
/// that made it. Messages of any size; they are in memory until exchange().
class MpiTeam : public Team {
 public:
  /// Begins MPI (MPI_THREAD_FUNNELED); one for a process. @throw std::runtime_error if this MPI
  /// allows no threads beside its calls.
  MpiTeam(int* argc, char*** argv);
  /// Ends MPI, with the others.
  ~MpiTeam() override;

  int count() const override { return count_; }
  int member() const override { return member_; }
  void exchange(Scratch& own) override;
  void sum(std::vector<int64_t>& values) override;
  void max(std::vector<int64_t>& values) override;
  void broadcast(Bytes& bytes) override;

  /// Ends the whole job, with this exit code.
  [[noreturn]] static void abort(int code);

 private:
  void post(int to, const std::string& name, const Bytes& bytes) override;

  int count_ = 1, member_ = 0;
  std::vector<Bytes> outbox_;  // to each member: names and bytes
};

}  // namespace vdb_madf
