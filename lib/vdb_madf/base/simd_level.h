// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf {

/// For which instruction sets the inner loops were compiled that run here: "x86-64-v4" (AVX-512),
/// "x86-64-v3" (AVX2) or "baseline", what every processor of the kind has. The results are the same
/// bits. It is the widest one of the processor; the environment variable VDB_MADF_SIMD_LEVEL (4, 3 or
/// 0) asks for less.
/// @throw InvalidInput if that variable is anything else
const char* simdLevel();

}  // namespace vdb_madf
