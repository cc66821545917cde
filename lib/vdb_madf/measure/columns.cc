// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/columns.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace vdb_madf {

namespace {

using openvdb::Vec3d;
using Kind = MeasureColumn::Kind;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

bool isNameOf(const MeasureColumn& column, const std::string& name) {
  if (name == column.name) return true;
  for (const char* const unit : {"voxel", "um", "mm"})
    if (column.power != 0 && name == column.name + unitSuffix(column.power, unit)) return true;
  return false;
}

/// True if a column has the numbers of a given one, as tables print them. If that is named with a
/// unit, its numbers may all be as many times larger, which one number alone cannot tell.
bool isSaidBy(const MeasureColumn& column, const MeasureColumn& given) {
  constexpr double kDigits = 1e-5;
  const bool isUnitKnown = given.name == column.name;
  double unit = isUnitKnown ? 1 : 0;  // 0: not known yet
  int compared = 0;
  for (size_t i = 0; i < given.values.size(); ++i) {
    const double own = column.values[i], other = given.values[i];
    if (std::isnan(other) || (own == 0 && other == 0)) continue;
    if (unit == 0) unit = other / own;
    if (!(std::abs(other - unit * own) <= kDigits * std::abs(other))) return false;
    ++compared;
  }
  return isUnitKnown || compared != 1;
}

/// Makes columns of the items of a list, one by one.
template <typename Item>
class ColumnMaker {
 public:
  explicit ColumnMaker(const std::vector<Item>& items) : items_(items) {}

  template <typename Number>
  void add(const std::string& name, int power, const Number& number, Kind kind = Kind::number,
           int axis = 0) {
    MeasureColumn column{name, kind, power, axis, {}};
    column.values.reserve(items_.size());
    for (const Item& item : items_) column.values.push_back(double(number(item)));
    columns_.push_back(std::move(column));
  }
  template <typename Number>
  void addGiven(const std::string& name, const Number& number) {
    add(name, 0, number);
    MeasureColumn& given = columns_.back();
    for (;;) {  // the name that is left may be taken, too
      const auto same = std::find_if(columns_.begin(), columns_.end() - 1, [&](const auto& column) {
        return isNameOf(column, given.name);
      });
      if (same == columns_.end() - 1) return;
      if (isSaidBy(*same, given)) return columns_.pop_back();
      given.name = givenName(given.name);
    }
  }
  template <typename Number>
  void addCount(const std::string& name, const Number& number) {
    add(name, 0, number, Kind::count);
  }
  template <typename Number>
  void addLabel(const std::string& name, const Number& number) {
    add(name, 0, number, Kind::label);
  }
  template <typename Number>
  void addFlag(const std::string& name, const Number& number) {
    add(name, 0, number, Kind::flag);
  }
  /// Three columns.
  template <typename Vector>
  void addVector(const std::string& name, const Vector& vector, Kind kind = Kind::number) {
    for (int axis = 0; axis < 3; ++axis)
      add(
          name + "_" + "xyz"[axis], kind == Kind::place ? 1 : 0,
          [&](const Item& item) { return vector(item)[axis]; }, kind, axis);
  }
  std::vector<MeasureColumn> columns() { return std::move(columns_); }

 private:
  const std::vector<Item>& items_;
  std::vector<MeasureColumn> columns_;
};

void addShape(ColumnMaker<GrainMeasures>& make) {
  using G = GrainMeasures;
  const auto ofShape = [](double GrainShape::*member) {
    return [member](const G& g) { return g.shape ? (*g.shape).*member : kNone; };
  };
  make.add("feret_max", 1, ofShape(&GrainShape::maxFeret));
  make.add("feret_min", 1, ofShape(&GrainShape::minFeret));
  make.add("convex_volume", 3, ofShape(&GrainShape::convexVolume));
  make.add("solidity", 0, [](const G& g) { return g.shape ? g.solidity() : kNone; });
  make.addCount("zingg_class", [](const G& g) { return zinggClass(g.ellipsoid.values); });
}

void addCells(ColumnMaker<GrainMeasures>& make) {
  using G = GrainMeasures;
  make.add("cell_volume", 3, [](const G& g) { return g.cell ? g.cell->volume : kNone; });
  make.add("local_solid_fraction", 0,
           [](const G& g) { return g.cell ? g.localSolidFraction() : kNone; });
  make.addCount("cell_neighbors", [](const G& g) { return g.cell ? g.cell->neighbors : 0; });
  make.addFlag("cell_at_domain_face", [](const G& g) { return g.cell && g.cell->atDomainFace; });
}

/// Adds the columns of grains or bonds.
template <typename Item>
void addGray(ColumnMaker<Item>& make) {
  make.addCount("gray_voxels", [](const Item& item) { return item.gray ? item.gray->voxels : 0; });
  const auto ofGray = [](double GrayValues::*member) {
    return [member](const Item& item) { return item.gray ? (*item.gray).*member : kNone; };
  };
  make.add("gray_mean", 0, ofGray(&GrayValues::mean));
  make.add("gray_sd", 0, ofGray(&GrayValues::deviation));
  make.add("gray_min", 0, ofGray(&GrayValues::minimum));
  make.add("gray_max", 0, ofGray(&GrayValues::maximum));
  make.add("gray_median", 0, ofGray(&GrayValues::median));
}

void addNecks(ColumnMaker<BondMeasures>& make) {
  using B = BondMeasures;
  const auto ofNeck = [](double Neck::*member) {
    return [member](const B& b) { return b.neck ? (*b.neck).*member : kNone; };
  };
  make.add("neck_area", 2, ofNeck(&Neck::area));
  make.add("neck_radius", 1, ofNeck(&Neck::radius));
  make.add("neck_error", 2, ofNeck(&Neck::error));
  make.add("neck_gap", 1, ofNeck(&Neck::gap));
  make.addFlag("neck_confirmed", [](const B& b) { return b.neck && b.neck->confirmed; });
  make.addVector("neck_normal", [](const B& b) { return b.neck ? b.neck->normal : Vec3d(kNone); });
}

/// Adds the columns of grains or bonds.
template <typename Item>
void addRecurrence(ColumnMaker<Item>& make, const std::string& share, const std::string& deviation,
                   int power) {
  const auto number = [](double Recurrence::*member) {
    return [member](const Item& i) { return i.recurrence ? (*i.recurrence).*member : kNone; };
  };
  make.add(share, 0, number(&Recurrence::share));
  make.add(deviation, power, [](const Item& i) {
    return i.recurrence && i.recurrence->share > 0 ? i.recurrence->deviation : kNone;
  });
}

}  // namespace

std::vector<MeasureColumn> grainColumns(const std::vector<GrainMeasures>& grains,
                                        const ExtraMeasures& extra) {
  using G = GrainMeasures;
  ColumnMaker<G> make(grains);
  make.addLabel("id", [](const G& g) { return g.id; });
  make.addCount("voxels", [](const G& g) { return g.voxels; });
  make.add("volume", 3, [](const G& g) { return g.volume; });
  make.add("equivalent_diameter", 1, [](const G& g) { return g.equivalentDiameter; });
  make.addVector(
      "centroid", [](const G& g) { return g.centroid; }, Kind::place);
  make.addVector(
      "representative",
      [](const G& g) { return g.representative ? g.representative->asVec3d() : Vec3d(kNone); },
      Kind::place);
  make.add("inscribed_radius", 1,
           [](const G& g) { return g.representative ? g.inscribedRadius : kNone; });
  make.add("area", 2, [](const G& g) { return g.totalArea(); });
  make.add("free_area", 2, [](const G& g) { return g.freeArea; });
  make.add("shared_area", 2, [](const G& g) { return g.sharedArea; });
  make.add("cut_area", 2, [](const G& g) { return g.cutArea; });
  make.add("sphericity", 0, [](const G& g) { return g.sphericity.value_or(kNone); });
  const std::string axes[] = {"axis1", "axis2", "axis3"};
  for (size_t i = 0; i < 3; ++i)
    make.add(axes[i] + "_length", 1, [i](const G& g) { return g.ellipsoid.values[i]; });
  make.add("aspect_2_to_1", 0,
           [](const G& g) { return g.ellipsoid.values[1] / g.ellipsoid.values[0]; });
  make.add("aspect_3_to_2", 0,
           [](const G& g) { return g.ellipsoid.values[2] / g.ellipsoid.values[1]; });
  for (size_t i = 0; i < 3; ++i)
    make.addVector(axes[i], [i](const G& g) { return g.ellipsoid.axes[i]; });
  make.addVector(
      "box_min", [](const G& g) { return g.box.min(); }, Kind::count);
  make.addVector(
      "box_max", [](const G& g) { return g.box.max(); }, Kind::count);
  make.addCount("coordination", [](const G& g) { return g.coordination; });
  make.addFlag("at_domain_face", [](const G& g) { return g.atDomainFace; });
  if (extra.shape) addShape(make);
  if (extra.gray) addGray(make);
  if (extra.edgeWeights) make.add("edge_weight", 0, [](const G& g) { return g.edgeWeight; });
  if (extra.cells) addCells(make);
  if (extra.sizes)
    make.add("projected_diameter", 1,
             [](const G& g) { return g.shape ? g.shape->projectedDiameter : kNone; });
  if (extra.recurrence) addRecurrence(make, "p_grain", "volume_sd", 3);
  if (extra.stability) {
    make.add("born", 0, [](const G& g) { return g.life.born.value_or(kNone); });
    make.add("dies", 0, [](const G& g) { return g.life.dies.value_or(kNone); });
    make.add("stability", 0, [](const G& g) { return g.life.stability.value_or(kNone); });
  }
  for (const GivenColumn& column : extra.given)
    make.addGiven(column.name, [&](const G& g) {
      const auto value = column.values.find(g.id);
      return value == column.values.end() ? kNone : value->second;
    });
  return make.columns();
}

std::string givenName(const std::string& name) {
  return "given_" + name;
}

std::vector<MeasureColumn> bondColumns(const std::vector<BondMeasures>& bonds,
                                       const ExtraMeasures& extra) {
  using B = BondMeasures;
  ColumnMaker<B> make(bonds);
  make.addLabel("first", [](const B& b) { return b.first; });
  make.addLabel("second", [](const B& b) { return b.second; });
  make.addCount("faces", [](const B& b) { return b.faces; });
  make.add("area", 2, [](const B& b) { return b.area; });
  make.add("radius", 1, [](const B& b) { return b.equivalentRadius; });
  make.addVector(
      "centroid", [](const B& b) { return b.centroid; }, Kind::place);
  make.addVector("normal", [](const B& b) { return b.normal; });
  make.add("distance", 1, [](const B& b) { return b.distance.value_or(kNone); });
  make.add("cos_alpha", 0, [](const B& b) { return b.cosAlpha.value_or(kNone); });
  make.add("flatness", 2, [](const B& b) { return b.flatness; });
  make.addCount("patches", [](const B& b) { return b.patches; });
  make.addCount("curvature_points",
                [](const B& b) { return b.curvature ? b.curvature->points : 0; });
  const auto addCurvature = [&](const std::string& name, int power, auto member) {
    make.add(name, power,
             [member](const B& b) { return b.curvature ? (*b.curvature).*member : kNone; });
  };
  addCurvature("mean_curvature", -1, &InterfaceCurvature::mean);
  addCurvature("mean_curvature_sd", -1, &InterfaceCurvature::meanDeviation);
  addCurvature("gaussian_curvature", -2, &InterfaceCurvature::gaussian);
  addCurvature("gaussian_curvature_sd", -2, &InterfaceCurvature::gaussianDeviation);
  addCurvature("curvature_residual", 1, &InterfaceCurvature::residual);
  if (extra.bondRadii)
    make.add("inscribed_radius", 1, [](const B& b) { return b.inscribedRadius.value_or(kNone); });
  if (extra.gray) addGray(make);
  if (extra.necks) addNecks(make);
  if (extra.stability)
    make.add("vanishes", 0, [](const B& b) { return b.vanishes.value_or(kNone); });
  if (extra.recurrence) addRecurrence(make, "p_bond", "area_sd", 2);
  if (extra.crossings) {
    make.addVector(
        "cut",
        [](const B& b) { return b.crossing ? Vec3d(b.crossing->inCut.data()) : Vec3d(kNone); },
        Kind::flag);
    make.addVector("current", [](const B& b) {
      return b.crossing ? Vec3d(b.crossing->current.data()) : Vec3d(kNone);
    });
  }
  return make.columns();
}

std::vector<MeasureColumn> bridgeColumns(const std::vector<Bridge>& bridges) {
  ColumnMaker<Bridge> make(bridges);
  make.addLabel("first", [](const Bridge& b) { return b.first; });
  make.addLabel("second", [](const Bridge& b) { return b.second; });
  make.addFlag("bonded", [](const Bridge& b) { return b.bonded; });
  make.addCount("voxels", [](const Bridge& b) { return b.voxels; });
  make.add("volume", 3, [](const Bridge& b) { return b.volume; });
  make.add("section_area", 2, [](const Bridge& b) { return b.section; });
  make.add("section_radius", 1, [](const Bridge& b) { return b.sectionRadius; });
  make.add("first_cover_area", 2, [](const Bridge& b) { return b.firstCover; });
  make.add("second_cover_area", 2, [](const Bridge& b) { return b.secondCover; });
  make.add("first_cover_share", 0, [](const Bridge& b) { return b.firstShare; });
  make.add("second_cover_share", 0, [](const Bridge& b) { return b.secondShare; });
  return make.columns();
}

std::string unitSuffix(int power, const std::string& unit) {
  if (power == 0) return "";
  const int size = std::abs(power);
  return (power < 0 ? "_per_" : "_") + unit + (size == 1 ? "" : std::to_string(size));
}

double scaled(double value, int power, double edge) {
  double factor = 1;
  for (int i = 0; i < std::abs(power); ++i) factor *= edge;
  return power < 0 ? value / factor : value * factor;
}

double scaled(const MeasureColumn& column, double value, const Vec3d& edges) {
  const double edge =
      column.kind == Kind::place ? edges[column.axis] : std::min({edges[0], edges[1], edges[2]});
  return scaled(value, column.power, edge);
}

}  // namespace vdb_madf
