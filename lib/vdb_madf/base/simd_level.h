// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf {

/// The instruction set of the inner loops that run here: "x86-64-v4" (AVX-512), "x86-64-v3" (AVX2)
/// or "baseline", what every processor of the kind has. It is the widest one of the processor; the
/// environment variable VDB_MADF_SIMD_LEVEL (4, 3 or 0) asks for less. All give the same bits.
/// @throw InvalidInput if that variable is anything else
const char* simdLevel();

}  // namespace vdb_madf
