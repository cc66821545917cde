// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The squared distance of seung-lab's edt as a peer of the distance stage; its header, src/edt.hpp,
// is not ours to give (LGPL), so `dense` compiles this against a checkout of it.
//   peer_edt VOLUME.raw NX NY NZ THREADS CLOSED     uint8, x fastest; prints one line of JSON
// CLOSED: 1 if what is beyond the volume is background. The time includes the array of the
// distances, as ours does.

#include <sys/resource.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "edt.hpp"

int main(int argc, char** argv) {
  if (argc != 7) return 2;
  const int64_t x = std::atol(argv[2]), y = std::atol(argv[3]), z = std::atol(argv[4]);
  std::vector<uint8_t> voxels(size_t(x * y * z));
  std::FILE* file = std::fopen(argv[1], "rb");
  if (!file || std::fread(voxels.data(), 1, voxels.size(), file) != voxels.size()) return 1;
  std::fclose(file);

  const auto start = std::chrono::steady_clock::now();
  float* const distances = pyedt::_binary_edt3dsq(voxels.data(), x, y, z, 1, 1, 1,
                                                  std::atoi(argv[6]) != 0, std::atoi(argv[5]));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const double sum = std::accumulate(distances, distances + voxels.size(), 0.0);
  delete[] distances;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("{\"seconds\": %.6f, \"sum\": %.0f, \"peak_memory_bytes\": %lld}\n", seconds.count(),
              sum, usage.ru_maxrss * 1024LL);
}
