// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/musen_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/files/detail/output_stream.h"

namespace vdb_madf {

namespace {

using openvdb::Vec3d;

// What the numbers at the beginning of a line, and before its parts, mean.
enum MusenKey {
  object = 0,
  type = 1,
  atTime = 2,
  geometry = 5,
  place = 12,
  domain = 22,
  compound = 23,
  activeFromTo = 24,
  turn = 31,
  newCompound = 32
};
enum MusenType { sphere = 1, solidBond = 9 };

const std::vector<double>& valuesOf(const std::vector<GrainNetwork::Column>& columns,
                                    const char* name) {
  const auto found =
      std::find_if(columns.begin(), columns.end(),
                   [&](const GrainNetwork::Column& column) { return column.name == name; });
  if (found == columns.end()) throw InvalidInput(std::string("the network has no column ") + name);
  return found->values;
}

std::string placeText(const Vec3d& place) {
  return fmt::format("{} {} {}", place.x(), place.y(), place.z());
}

}  // namespace

void writeMusen(const std::string& path, const GrainNetwork& network, Interrupter* interrupter) {
  const auto unitsPerM = unitsPerMetre(network.unit);
  if (!unitsPerM)
    throw InvalidInput(path + ": MUSEN has lengths in meters, and the voxel size is not known");
  const auto& diameters = valuesOf(network.grainColumns, "equivalent_diameter");
  const auto& radii = valuesOf(network.bondColumns, "radius");
  const auto& lengths = valuesOf(network.bondColumns, "length");
  openvdb::BBoxd box;
  for (size_t i = 0; i < network.grains.size(); ++i)
    for (const int side : {-1, 1})
      box.expand((network.centers[i] + Vec3d(side * diameters[i] / 2)) / *unitsPerM);
  detail::OutputStream out(path, interrupter);
  if (!network.grains.empty())
    out.text(fmt::format("{} {} {}\n", int(domain), placeText(box.min()), placeText(box.max())));
  out.text(fmt::format("{0} GRAIN grain\n{0} BOND bond\n", int(newCompound)));
  const std::string always = fmt::format("{} 0 1e+300 {} 0", int(activeFromTo), int(atTime));
  for (size_t i = 0; i < network.grains.size(); ++i) {
    const double radius = diameters[i] / 2 / *unitsPerM;  // twice: also that of contact
    out.text(fmt::format("{} {} {} {} {} {} {} {} GRAIN {} {} {} {} 1 0 0 0\n", int(object),
                         network.grains[i], int(type), int(sphere), int(geometry), radius, radius,
                         int(compound), always, int(place),
                         placeText(network.centers[i] / *unitsPerM), int(turn)));
  }
  int64_t number = network.grains.empty() ? 0 : network.grains.back();
  for (size_t i = 0; i < network.bonds.size(); ++i)
    out.text(fmt::format(
        "{} {} {} {} {} {} {} {} {} {} BOND {}\n", int(object), ++number, int(type), int(solidBond),
        int(geometry), network.grains[network.bonds[i][0]], network.grains[network.bonds[i][1]],
        2 * radii[i] / *unitsPerM, lengths[i] / *unitsPerM, int(compound), always));
  out.commit();
}

}  // namespace vdb_madf
