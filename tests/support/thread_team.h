// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "vdb_madf/slabs/team.h"

// Members that are threads, each with a scratch of its own: what one does not send, the others
// never have.

namespace vdb_madf::test {

/// What threads have in common.
class ThreadTeam {
 public:
  explicit ThreadTeam(int members)
      : count(members), mail(size_t(members)), votes(size_t(members)) {}

  /// Thrown in a member when another one failed.
  struct OtherFailed {};

  /// Waits for all; the last one does something first.
  void meet(const std::function<void()>& last = [] {}) {
    std::unique_lock<std::mutex> lock(mutex_);
    if (failed_) throw OtherFailed();
    const int64_t meeting = meeting_;
    if (++arrived_ == count) {
      last();
      arrived_ = 0;
      ++meeting_;
      all_.notify_all();
      return;
    }
    all_.wait(lock, [&] { return meeting_ != meeting || failed_; });
    if (meeting_ == meeting) throw OtherFailed();
  }
  void fail() {
    const std::lock_guard<std::mutex> lock(mutex_);
    failed_ = true;
    all_.notify_all();
  }
  void post(int member, const std::string& name, const Bytes& bytes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    mail[size_t(member)].emplace_back(name, bytes);
    ++messages;
  }

  const int count;
  std::vector<std::vector<std::pair<std::string, Bytes>>> mail;  ///< to each member
  std::vector<std::vector<int64_t>> votes;
  Bytes word;
  int64_t messages = 0;

 private:
  std::mutex mutex_;
  std::condition_variable all_;
  int arrived_ = 0;
  int64_t meeting_ = 0;
  bool failed_ = false;
};

class ThreadMember : public Team {
 public:
  ThreadMember(ThreadTeam& team, int member) : team_(team), member_(member) {}

  int count() const override { return team_.count; }
  int member() const override { return member_; }
  void exchange(Scratch& own) override {
    team_.meet();
    for (const auto& [name, bytes] : std::exchange(team_.mail[size_t(member_)], {}))
      receive(name, bytes, own);
    team_.meet();
  }
  void sum(std::vector<int64_t>& values) override {
    vote(values, [](int64_t a, int64_t b) { return a + b; });
  }
  void max(std::vector<int64_t>& values) override {
    vote(values, [](int64_t a, int64_t b) { return std::max(a, b); });
  }
  void broadcast(Bytes& bytes) override {
    if (member_ == 0) team_.word = bytes;
    team_.meet();
    bytes = team_.word;
    team_.meet();
  }

 private:
  void post(int to, const std::string& name, const Bytes& bytes) override {
    team_.post(to, name, bytes);
  }
  template <typename F>
  void vote(std::vector<int64_t>& values, const F& join) {
    team_.votes[size_t(member_)] = values;
    team_.meet([&] {
      std::vector<int64_t> all = team_.votes[0];
      for (size_t r = 1; r < team_.votes.size(); ++r)
        for (size_t i = 0; i < all.size(); ++i) all[i] = join(all[i], team_.votes[r].at(i));
      team_.votes.assign(team_.votes.size(), all);
    });
    values = team_.votes[size_t(member_)];
    team_.meet();
  }

  ThreadTeam& team_;
  int member_;
};

/// Runs f(member) in so many threads. @throw what the first of them throws
template <typename F>
void asMembers(ThreadTeam& team, const F& f) {
  std::vector<std::exception_ptr> errors(size_t(team.count));
  std::vector<std::thread> threads;
  for (int r = 0; r < team.count; ++r)
    threads.emplace_back([&, r] {
      ThreadMember member(team, r);
      try {
        f(member);
      } catch (const ThreadTeam::OtherFailed&) {
      } catch (...) {
        errors[size_t(r)] = std::current_exception();
        team.fail();
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace vdb_madf::test
