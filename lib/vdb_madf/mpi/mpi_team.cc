// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/mpi/mpi_team.h"

#include <mpi.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace vdb_madf {

namespace {

constexpr size_t kChunk = size_t(1) << 30;  // MPI counts in int

void append(Bytes& bytes, const void* data, size_t size) {
  const auto first = static_cast<const char*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

/// f(offset, count) for the parts of an array.
template <typename F>
void forEachChunk(size_t size, const F& f) {
  for (size_t at = 0; at < size; at += kChunk) f(at, int(std::min(kChunk, size - at)));
}

/// f(name, bytes) for the pieces of a message, as post() makes it.
template <typename F>
void forEachPiece(const Bytes& message, const F& f) {
  size_t at = 0;
  const auto size = [&] {
    uint64_t value;
    std::memcpy(&value, message.data() + at, sizeof value);
    at += sizeof value;
    return size_t(value);
  };
  while (at < message.size()) {
    const size_t nameSize = size();
    const std::string name(message.data() + at, nameSize);
    at += nameSize;
    const size_t pieceSize = size();
    f(name,
      {message.begin() + std::ptrdiff_t(at), message.begin() + std::ptrdiff_t(at + pieceSize)});
    at += pieceSize;
  }
}

}  // namespace

MpiTeam::MpiTeam(int* argc, char*** argv) {
  int provided = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
  if (provided < MPI_THREAD_FUNNELED) {
    MPI_Finalize();
    throw std::runtime_error("this MPI does not allow threads (MPI_THREAD_FUNNELED)");
  }
  MPI_Comm_size(MPI_COMM_WORLD, &count_);
  MPI_Comm_rank(MPI_COMM_WORLD, &member_);
  outbox_.resize(size_t(count_));
}

MpiTeam::~MpiTeam() {
  MPI_Finalize();
}

void MpiTeam::post(int to, const std::string& name, const Bytes& bytes) {
  Bytes& message = outbox_[size_t(to)];
  const auto add = [&message](const auto& part) {
    const uint64_t size = part.size();
    append(message, &size, sizeof size);
    append(message, part.data(), size);
  };
  add(name);
  add(bytes);
}

void MpiTeam::exchange(Scratch& own) {
  const auto members = size_t(count_);
  std::vector<uint64_t> sent(members), coming(members);
  for (size_t r = 0; r < members; ++r) sent[r] = outbox_[r].size();
  MPI_Alltoall(sent.data(), 1, MPI_UINT64_T, coming.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD);
  std::vector<Bytes> inbox(members);
  std::vector<MPI_Request> requests;
  // Messages between two members do not overtake each other, so chunks need no number.
  for (size_t r = 0; r < members; ++r) {
    inbox[r].resize(coming[r]);
    forEachChunk(coming[r], [&](size_t at, int count) {
      requests.emplace_back();
      MPI_Irecv(inbox[r].data() + at, count, MPI_BYTE, int(r), 0, MPI_COMM_WORLD, &requests.back());
    });
    forEachChunk(sent[r], [&](size_t at, int count) {
      requests.emplace_back();
      MPI_Isend(outbox_[r].data() + at, count, MPI_BYTE, int(r), 0, MPI_COMM_WORLD,
                &requests.back());
    });
  }
  MPI_Waitall(int(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  outbox_.assign(members, {});
  for (Bytes& message : inbox) {
    forEachPiece(message,
                 [&](const std::string& name, const Bytes& bytes) { receive(name, bytes, own); });
    message = {};
  }
}

void MpiTeam::sum(std::vector<int64_t>& values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), int(values.size()), MPI_INT64_T, MPI_SUM,
                MPI_COMM_WORLD);
}

void MpiTeam::max(std::vector<int64_t>& values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), int(values.size()), MPI_INT64_T, MPI_MAX,
                MPI_COMM_WORLD);
}

void MpiTeam::broadcast(Bytes& bytes) {
  uint64_t size = bytes.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  bytes.resize(size);
  forEachChunk(size, [&](size_t at, int count) {
    MPI_Bcast(bytes.data() + at, count, MPI_BYTE, 0, MPI_COMM_WORLD);
  });
}

void MpiTeam::abort(int code) {
  MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

}  // namespace vdb_madf
