// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "call.h"

namespace vdb_madf::python {

namespace {

constexpr auto kAskEvery = std::chrono::milliseconds(50);

}  // namespace

void Monitor::start(const char* stage) {
  if (std::this_thread::get_id() == caller_) stage_ = stage ? stage : "";
}

bool Monitor::wasInterrupted(int percent) {
  if (!stop_ && std::this_thread::get_id() == caller_ && Clock::now() - last_ >= kAskEvery)
    ask(percent);
  return stop_;
}

void Monitor::ask(int percent) {
  const py::gil_scoped_acquire lock;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress_.is_none() && percent >= 0) progress_(percent, stage_);
  } catch (const py::error_already_set&) {
    raised_ = std::current_exception();
    stop_ = true;
  }
  last_ = Clock::now();
}

}  // namespace vdb_madf::python
