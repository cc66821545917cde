// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/grain_network.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

namespace {

using Columns = std::vector<GrainNetwork::Column>;
using detail::CubicTransform;
using openvdb::Vec3d;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Makes columns of the items of a list, one by one. Lengths in voxels become lengths in the world.
template <typename Item>
class ColumnMaker {
 public:
  ColumnMaker(const std::vector<Item>& items, const CubicTransform& world, Columns& columns)
      : items_(items), world_(world), columns_(columns) {}

  /// \p power: of the length that the number is measured in.
  template <typename Number>
  void add(const std::string& name, int power, const Number& number) {
    const double factor = std::pow(world_.edge, power);
    GrainNetwork::Column column{name, {}};
    column.values.reserve(items_.size());
    for (const Item& item : items_) column.values.push_back(factor * double(number(item)));
    columns_.push_back(std::move(column));
  }
  /// Three columns. \p vector: without unit.
  template <typename Vector>
  void addAxes(const std::string& name, const Vector& vector) {
    for (int axis = 0; axis < 3; ++axis)
      add(name + "_" + "xyz"[axis], 0, [&](const Item& item) { return vector(item)[axis]; });
  }
  /// Three columns, in the world; \p place: a place in voxels, or none.
  template <typename Place>
  void addPlace(const std::string& name, const Place& place) {
    addAxes(name, [&](const Item& item) {
      const std::optional<Vec3d> p = place(item);
      return p ? world_.origin + world_.edge * *p : Vec3d(kNone);
    });
  }

 private:
  const std::vector<Item>& items_;
  const CubicTransform& world_;
  Columns& columns_;
};

Columns grainColumns(const std::vector<GrainMeasures>& grains, const CubicTransform& world) {
  using G = GrainMeasures;
  Columns columns;
  ColumnMaker<G> make(grains, world, columns);
  make.add("voxels", 0, [](const G& g) { return g.voxels; });
  make.add("volume", 3, [](const G& g) { return g.voxels; });
  make.add("equivalent_diameter", 1, [](const G& g) { return g.equivalentDiameter; });
  make.add("coordination", 0, [](const G& g) { return g.coordination; });
  make.addPlace("representative", [](const G& g) {
    return g.representative ? std::optional(g.representative->asVec3d()) : std::nullopt;
  });
  make.add("inscribed_radius", 1,
           [](const G& g) { return g.representative ? g.inscribedRadius : kNone; });
  make.add("area", 2, [](const G& g) { return g.totalArea(); });
  make.add("free_area", 2, [](const G& g) { return g.freeArea; });
  make.add("shared_area", 2, [](const G& g) { return g.sharedArea; });
  make.add("cut_area", 2, [](const G& g) { return g.cutArea; });
  make.add("sphericity", 0, [](const G& g) { return g.sphericity; });
  for (const size_t i : {0u, 1u, 2u}) {
    const std::string axis = "axis" + std::to_string(i + 1);
    make.add(axis + "_length", 1, [i](const G& g) { return g.ellipsoid.values[i]; });
    make.addAxes(axis, [i](const G& g) { return g.ellipsoid.axes[i]; });
  }
  make.add("aspect_2_to_1", 0,
           [](const G& g) { return g.ellipsoid.values[1] / g.ellipsoid.values[0]; });
  make.add("aspect_3_to_2", 0,
           [](const G& g) { return g.ellipsoid.values[2] / g.ellipsoid.values[1]; });
  make.addAxes("box_min", [](const G& g) { return g.box.min(); });
  make.addAxes("box_max", [](const G& g) { return g.box.max(); });
  make.add("at_domain_face", 0, [](const G& g) { return g.atDomainFace; });
  return columns;
}

Columns bondColumns(const std::vector<BondMeasures>& bonds, const CubicTransform& world) {
  using B = BondMeasures;
  Columns columns;
  ColumnMaker<B> make(bonds, world, columns);
  make.add("faces", 0, [](const B& b) { return b.faces; });
  make.add("face_area", 2, [](const B& b) { return b.faces; });
  make.addPlace("center", [](const B& b) { return std::optional(b.centroid); });
  make.add("area", 2, [](const B& b) { return b.area; });
  make.add("radius", 1, [](const B& b) { return b.equivalentRadius; });
  make.addAxes("normal", [](const B& b) { return b.normal; });
  make.add("distance", 1, [](const B& b) { return b.distance.value_or(kNone); });
  make.add("cos_alpha", 0, [](const B& b) { return b.cosAlpha.value_or(kNone); });
  make.add("flatness", 2, [](const B& b) { return b.flatness; });
  make.add("patches", 0, [](const B& b) { return b.patches; });
  make.add("curvature_points", 0,
           [](const B& b) { return b.curvature ? double(b.curvature->points) : 0.0; });
  const auto addCurvature = [&](const std::string& name, int power, auto member) {
    make.add(name, power,
             [member](const B& b) { return b.curvature ? (*b.curvature).*member : kNone; });
  };
  addCurvature("mean_curvature", -1, &InterfaceCurvature::mean);
  addCurvature("mean_curvature_sd", -1, &InterfaceCurvature::meanDeviation);
  addCurvature("gaussian_curvature", -2, &InterfaceCurvature::gaussian);
  addCurvature("gaussian_curvature_sd", -2, &InterfaceCurvature::gaussianDeviation);
  addCurvature("curvature_residual", 1, &InterfaceCurvature::residual);
  return columns;
}

uint32_t position(const std::vector<int32_t>& labels, int32_t label) {
  return uint32_t(std::lower_bound(labels.begin(), labels.end(), label) - labels.begin());
}

}  // namespace

GrainNetwork grainNetwork(const Int32Grid& labels, Interrupter* interrupter) {
  const CubicTransform world = detail::cubicTransform(labels.transform());
  const Measurements measured = measure(labels, {}, interrupter);

  GrainNetwork network;
  for (const GrainMeasures& grain : measured.grains) {
    network.grains.push_back(grain.id);
    network.centers.push_back(world.origin + world.edge * grain.centroid);
  }
  GrainNetwork::Column length{"length", {}};
  for (const BondMeasures& bond : measured.bonds) {
    const uint32_t first = position(network.grains, bond.first),
                   second = position(network.grains, bond.second);
    network.bonds.push_back({first, second});
    length.values.push_back((network.centers[second] - network.centers[first]).length());
  }
  network.grainColumns = grainColumns(measured.grains, world);
  network.bondColumns = bondColumns(measured.bonds, world);
  network.bondColumns.push_back(std::move(length));
  return network;
}

}  // namespace vdb_madf
