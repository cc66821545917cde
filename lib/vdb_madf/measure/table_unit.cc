// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/table_unit.h"

#include <fmt/core.h>

#include <algorithm>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

namespace vdb_madf {

void requireTableUnit(const std::string& wanted, const std::optional<VoxelSize>& size) {
  if (!wanted.empty() && wanted != "mm" && wanted != "um")
    throw InvalidInput("the unit of length " + wanted + ": must be mm or um");
  if (!size && !wanted.empty())
    throw InvalidInput(
        "the voxel size is unknown, so that lengths cannot be in " + wanted + ": give it",
        Hint::voxelSize);
}

TableUnit::TableUnit(const Measurements& measured, const std::string& wanted) {
  const std::optional<VoxelSize>& size = measured.voxelSize;
  requireTableUnit(wanted, size);
  for (int axis = 0; axis < 3; ++axis) voxel[size_t(axis)] = measured.edges[axis];
  if (size) {
    name = wanted.empty() ? size->unit() : wanted;
    voxel = size->edges();
    for (double& edge : voxel) edge *= name == "um" ? 1e6 : 1e3;
    length = *std::min_element(voxel.begin(), voxel.end());
  }
  edges = length * measured.edges;
}

std::string noteOnPlaces(const openvdb::GridBase& labels) {
  const openvdb::Vec3d first = labels.transform().indexToWorld(openvdb::Vec3d(0));
  const auto size = storedVoxelSize(labels);
  if (!size || first == openvdb::Vec3d(0)) return "";
  return fmt::format(
      "places in the tables count from voxel 0,0,0, whose center is at {:.6g},{:.6g},{:.6g} {}: "
      "meshes and networks have that added",
      first[0], first[1], first[2], size->unit());
}

}  // namespace vdb_madf
