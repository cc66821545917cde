// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <stdint.h>

// What program.cc and warm_start.c say to each other; for C, too.

enum { WARM_REQUEST_BYTES = 1 << 17 };

/// Behind it the folder to run in, the arguments and the variables of the environment. Its
/// descriptors: input, output, errors, and the socket for the answer.
struct WarmRequest {
  int64_t largestFile, memory, seconds;  ///< limits of the run; 0: none
  int32_t arguments, variables;
};
