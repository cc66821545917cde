// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// ITK's exact distance transform (Maurer et al. 2003) as a peer of the distance stage, all threads:
//   vdb_madf_peer_maurer VOLUME.raw NX NY NZ     uint8, x fastest; prints one line of JSON

#include <itkImportImageFilter.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  const size_t size[3] = {size_t(std::atol(argv[2])), size_t(std::atol(argv[3])),
                          size_t(std::atol(argv[4]))};
  std::vector<unsigned char> voxels(size[0] * size[1] * size[2]);
  std::FILE* file = std::fopen(argv[1], "rb");
  if (!file || std::fread(voxels.data(), 1, voxels.size(), file) != voxels.size()) return 1;
  std::fclose(file);

  using Solid = itk::Image<unsigned char, 3>;
  auto import = itk::ImportImageFilter<unsigned char, 3>::New();
  import->SetRegion(Solid::RegionType({size[0], size[1], size[2]}));
  import->SetImportPointer(voxels.data(), voxels.size(), false);
  auto maurer = itk::SignedMaurerDistanceMapImageFilter<Solid, itk::Image<float, 3>>::New();
  maurer->SetInput(import->GetOutput());
  maurer->SquaredDistanceOn();
  maurer->UseImageSpacingOff();
  const auto start = std::chrono::steady_clock::now();
  maurer->Update();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("{\"seconds\": %.6f, \"peak_memory_bytes\": %lld}\n", seconds.count(),
              usage.ru_maxrss * 1024LL);
}
