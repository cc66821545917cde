// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>

namespace vdb_madf {

/// Largest resident memory of this process so far, bytes.
int64_t peakMemory();

/// Pages of memory that this process has touched for the first time, small or large.
int64_t pageFaults();

/// Bytes that the machine has free for a program, caches given back, within the limits of its
/// control groups and its own (`ulimit -v`); 0 if that is unknown.
int64_t availableMemory();

/// Bytes that this process can have at most: the machine's memory, or the limits of its control
/// groups, or its own.
int64_t memoryLimit();

/// From now on this process is refused memory beyond these bytes: an allocation then throws
/// std::bad_alloc. What it may write to counts, touched or not, so that a limit has to be above
/// peakMemory(), by 40 % for some. By RLIMIT_DATA, which Linux keeps; other systems may not.
/// @throw InvalidInput if the process has nearly as much already
void limitMemory(int64_t bytes);

/// How messages write a number of bytes: "154 MiB", with three digits; units are powers of 1024.
std::string readableBytes(int64_t bytes);

}  // namespace vdb_madf
