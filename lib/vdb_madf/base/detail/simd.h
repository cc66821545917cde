// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

// Inner loops are compiled for several instruction sets, and the widest one that simdWidth() tells
// is taken at run time:
//
//   VDB_MADF_KERNEL void add(const int* a, int* sum, size_t count) { ... }
//   atBestLevel([&]() VDB_MADF_INLINE { add(a, sum, count); });
//
// All that is to be compiled so has to be inlined into the lambda. Pass numbers and pointers on as
// arguments: what a lambda captures by reference is read again after each store. All levels give
// the same bits: integer arithmetic, or single operations of floating point, which are rounded
// alike (-ffp-contract=off).

#include <type_traits>

#define VDB_MADF_INLINE __attribute__((always_inline))
#define VDB_MADF_KERNEL [[gnu::always_inline]] inline

// Clang has no such names of levels for run time; its programs have what they are compiled for.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define VDB_MADF_SIMD_LEVELS
#endif

namespace vdb_madf::detail {

/// Levels of x86-64: AVX-512, AVX2, and what the compiler takes without further flags.
enum class SimdLevel { baseline = 0, v3 = 3, v4 = 4 };

/// The widest level of this processor or, if that is lower, the one that the environment variable
/// VDB_MADF_SIMD_LEVEL names: 4, 3 or 0. It is asked for once.
/// @throw InvalidInput if that names no level
SimdLevel bestSimdLevel();

/// Bytes of a vector register, known when compiling.
template <int Bytes>
using VectorBytes = std::integral_constant<int, Bytes>;

template <int Bytes, typename Kernel>
VDB_MADF_KERNEL auto runKernel(const Kernel& kernel) {
  if constexpr (std::is_invocable_v<const Kernel&, VectorBytes<Bytes>>)
    return kernel(VectorBytes<Bytes>());
  else
    return kernel();
}

#ifdef VDB_MADF_SIMD_LEVELS

template <typename Kernel>
__attribute__((target("arch=x86-64-v4"))) auto atLevel4(const Kernel& kernel) {
  return runKernel<64>(kernel);
}
template <typename Kernel>
__attribute__((target("arch=x86-64-v3"))) auto atLevel3(const Kernel& kernel) {
  return runKernel<32>(kernel);
}

/// Runs a kernel, an inlined lambda as above, and returns what it does.
template <typename Kernel>
auto atBestLevel(const Kernel& kernel) {
  switch (bestSimdLevel()) {
    case SimdLevel::v4:
      return atLevel4(kernel);
    case SimdLevel::v3:
      return atLevel3(kernel);
    default:
      return runKernel<16>(kernel);
  }
}

#else

template <typename Kernel>
auto atBestLevel(const Kernel& kernel) {
  return runKernel<16>(kernel);
}

#endif

}  // namespace vdb_madf::detail
