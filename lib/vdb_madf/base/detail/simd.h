// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

// Functions marked VDB_MADF_SIMD are compiled for several instruction sets; the best one is chosen
// when the program starts. All give the same bits: integer arithmetic, or single operations of
// floating point, which are rounded alike (-ffp-contract=off). VDB_MADF_SIMD_LEVEL (CMake) leaves out
// the wider ones: 4 by default, 3, or 0 for none.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#if VDB_MADF_SIMD_LEVEL >= 4
#define VDB_MADF_SIMD_V4
#define VDB_MADF_SIMD_V3
#define VDB_MADF_SIMD __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#elif VDB_MADF_SIMD_LEVEL == 3
#define VDB_MADF_SIMD_V3
#define VDB_MADF_SIMD __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define VDB_MADF_SIMD
#endif
#else
#define VDB_MADF_SIMD
#endif
