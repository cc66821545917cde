// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/grain_network.h"

#include <algorithm>
#include <set>
#include <utility>

#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/measure/columns.h"

namespace vdb_madf {

namespace {

using detail::WorldTransform;

/// In world units, without the columns that `leftOut` holds.
std::vector<GrainNetwork::Column> inWorld(std::vector<MeasureColumn> columns,
                                          const std::set<std::string>& leftOut,
                                          const WorldTransform& world) {
  std::vector<GrainNetwork::Column> result;
  for (MeasureColumn& column : columns) {
    if (leftOut.count(column.name)) continue;
    const bool isBox = column.name.compare(0, 4, "box_") == 0;  // voxels, in the tables
    const bool isPlace = isBox || column.kind == MeasureColumn::Kind::place;
    for (double& value : column.values) {
      value = isBox ? value * world.edges[column.axis] : scaled(column, value, world.edges);
      if (isPlace) value += world.origin[column.axis];
    }
    const bool isCount = !isPlace && column.isWhole();
    result.push_back({std::move(column.name), std::move(column.values), isCount});
  }
  return result;
}

uint32_t position(const std::vector<int32_t>& labels, int32_t label) {
  return uint32_t(detail::sortedIndex(labels, label));
}

/// @param labels a grid or slabs
/// @param about has their transform
template <typename Labels>
GrainNetwork networkOf(const Labels& labels, const Int32Grid& about, MeasureOptions options,
                       Interrupter* interrupter) {
  options.bondRadii = true;
  const WorldTransform world = detail::worldTransform(about.transform());
  const double shortest = std::min({world.edges[0], world.edges[1], world.edges[2]});
  const Measurements measured = measure(labels, options, interrupter);

  GrainNetwork network;
  network.contactsLeftOut = measured.sample.contactsLeftOut;
  if (measured.voxelSize) network.unit = measured.voxelSize->unit();
  for (const GrainMeasures& grain : measured.grains) {
    network.grains.push_back(grain.id);
    network.centers.push_back(world.origin + world.edges * grain.centroid);
  }
  GrainNetwork::Column faceArea{"face_area", {}, false}, length{"length", {}, false};
  for (const BondMeasures& bond : measured.bonds) {
    const uint32_t first = position(network.grains, bond.first),
                   second = position(network.grains, bond.second);
    network.bonds.push_back({first, second});
    faceArea.values.push_back(scaled(bond.faceArea, 2, shortest));
    length.values.push_back((network.centers[second] - network.centers[first]).length());
  }
  const GrainColors colors = grainColors(labels, interrupter);
  for (const int32_t label : network.grains) network.colors.push_back(colors.colorOf(label));
  network.grainColumns = inWorld(grainColumns(measured.grains, measured.extra), {"id"}, world);
  network.bondColumns =
      inWorld(bondColumns(measured.bonds, measured.extra), {"first", "second"}, world);
  network.bondColumns.push_back(std::move(faceArea));
  network.bondColumns.push_back(std::move(length));
  return network;
}

}  // namespace

GrainNetwork grainNetwork(const Int32Grid& labels, const MeasureOptions& options,
                          Interrupter* interrupter) {
  return networkOf(labels, labels, options, interrupter);
}

GrainNetwork grainNetwork(const LabelSlabs& labels, const MeasureOptions& options,
                          Interrupter* interrupter) {
  return networkOf(labels, *labels.about, options, interrupter);
}

}  // namespace vdb_madf
