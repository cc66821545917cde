// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grain_network.h"

#include <cmath>
#include <map>
#include <mutex>

#include "vdb_madf/detail/cubic_transform.h"
#include "vdb_madf/detail/label_blocks.h"
#include "vdb_madf/detail/parallel.h"

namespace vdb_madf {

namespace {

using detail::LabelBlocks;
using openvdb::Vec3d;

constexpr size_t kBlockGrain = 64;

/// Integer sums, so that the order in which they are added does not matter.
struct Sums {
  int64_t count = 0;
  std::array<int64_t, 3> position{};  ///< of voxels; of faces in half voxels

  void add(const Sums& other) {
    count += other.count;
    for (size_t axis = 0; axis < 3; ++axis) position[axis] += other.position[axis];
  }
};

using Pair = std::pair<int32_t, int32_t>;

struct Table {
  std::map<int32_t, Sums> grains;
  std::map<Pair, Sums> bonds;
};

void addVoxel(const Coord& p, const int32_t* at, Table& table) {
  static constexpr int kBack[3] = {100, 10, 1};
  if (at[0]) table.grains[at[0]].add({1, {p.x(), p.y(), p.z()}});
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t below = at[-kBack[axis]];
    if (!at[0] || !below || at[0] == below) continue;
    Sums face{1, {2 * int64_t(p.x()), 2 * int64_t(p.y()), 2 * int64_t(p.z())}};
    --face.position[size_t(axis)];
    table.bonds[std::minmax(at[0], below)].add(face);
  }
}

Table countAll(const LabelBlocks& blocks, Interrupter* interrupter) {
  Table table;
  std::mutex mutex;
  detail::parallelFor(blocks.size(), kBlockGrain, interrupter, [&](size_t begin, size_t end) {
    Table local;
    LabelBlocks::Halo halo;
    for (size_t block = begin; block < end; ++block) {
      blocks.readHalo(block, halo);
      for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
          for (int z = 0; z < 8; ++z)
            addVoxel(blocks.origin(block).offsetBy(x, y, z),
                     &halo[size_t((x + 1) * 100 + (y + 1) * 10 + z + 1)], local);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [grain, sums] : local.grains) table.grains[grain].add(sums);
    for (const auto& [bond, sums] : local.bonds) table.bonds[bond].add(sums);
  });
  return table;
}

Vec3d mean(const Sums& sums, double perVoxel) {
  const double n = double(sums.count) * perVoxel;
  return {double(sums.position[0]) / n, double(sums.position[1]) / n, double(sums.position[2]) / n};
}

}  // namespace

GrainNetwork grainNetwork(const Int32Grid& labels, Interrupter* interrupter) {
  const detail::CubicTransform world = detail::cubicTransform(labels.transform());
  const LabelBlocks blocks(labels);
  const Table table = countAll(blocks, interrupter);

  GrainNetwork network;
  GrainNetwork::Column voxels{"voxels", {}}, volume{"volume", {}},
      diameter{"equivalent_diameter", {}}, coordination{"coordination", {}};
  for (const auto& [grain, sums] : table.grains) {
    network.grains.push_back(grain);
    network.centers.push_back(world.origin + world.edge * mean(sums, 1));
    voxels.values.push_back(double(sums.count));
    volume.values.push_back(double(sums.count) * world.edge * world.edge * world.edge);
    diameter.values.push_back(std::cbrt(6 / M_PI * volume.values.back()));
  }
  coordination.values.resize(network.grains.size());

  GrainNetwork::Column faces{"faces", {}}, area{"face_area", {}}, length{"length", {}};
  std::array<GrainNetwork::Column, 3> center{
      {{"center_x", {}}, {"center_y", {}}, {"center_z", {}}}};
  for (const auto& [pair, sums] : table.bonds) {
    const uint32_t first = blocks.number(pair.first), second = blocks.number(pair.second);
    network.bonds.push_back({first, second});
    ++coordination.values[first];
    ++coordination.values[second];
    faces.values.push_back(double(sums.count));
    area.values.push_back(double(sums.count) * world.edge * world.edge);
    length.values.push_back((network.centers[second] - network.centers[first]).length());
    const Vec3d middle = world.origin + world.edge * mean(sums, 2);
    for (int axis = 0; axis < 3; ++axis) center[size_t(axis)].values.push_back(middle[axis]);
  }
  network.grainColumns = {voxels, volume, diameter, coordination};
  network.bondColumns = {faces, area, length, center[0], center[1], center[2]};
  return network;
}

}  // namespace vdb_madf
