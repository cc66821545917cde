// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf {

/// For which instruction sets the inner loops that run on this processor were compiled: "x86-64-v4"
/// (AVX-512), "x86-64-v3" (AVX2) or "baseline", what every processor of the kind has. The results are
/// the same bits.
const char* simdLevel();

}  // namespace vdb_madf
