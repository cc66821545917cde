// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "measurement_tables.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::tools {

namespace {

/// Factors and names of the unit of length.
struct Unit {
  std::string name = "voxel";
  double length = 1;  ///< of a voxel edge

  explicit Unit(const std::optional<VoxelSize>& size) {
    if (!size) return;
    name = size->unit();
    length = size->inUnit();
  }
  double area() const { return length * length; }
  double volume() const { return length * length * length; }
};

/// Rows of comma-separated values. Nine digits; an empty cell where there is no value.
class Csv {
 public:
  void add(double value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value == 0 ? 0.0 : value,
                                   std::chars_format::general, 9);
    add(std::string(text, end.ptr));
  }
  void add(int64_t value) { add(std::to_string(value)); }
  void add(int value) { add(int64_t(value)); }
  void add(const openvdb::Vec3d& vector, double factor = 1) {
    for (int i = 0; i < 3; ++i) add(factor * vector[i]);
  }
  void add(const Coord& coord) {
    for (int i = 0; i < 3; ++i) add(coord[i]);
  }
  void add(const char* cell) { add(std::string(cell)); }
  void add(const std::string& cell) {
    if (!first_) text_ += ',';
    text_ += cell;
    first_ = false;
  }
  void addNames(const std::string& before, const std::string& after = "") {
    for (const char* axis : {"x", "y", "z"}) add(before + "_" + axis + after);
  }
  void addEmpty(int cells) {
    for (int i = 0; i < cells; ++i) add(std::string());
  }
  void endRow() {
    text_ += '\n';
    first_ = true;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  bool first_ = true;
};

void addGrainNames(const std::string& u, Csv& csv) {
  csv.add("id");
  csv.add("voxels");
  csv.add("volume_" + u + "3");
  csv.add("equivalent_diameter_" + u);
  csv.addNames("centroid", "_" + u);
  csv.addNames("representative", "_" + u);
  csv.add("inscribed_radius_" + u);
  for (const char* area : {"area", "free_area", "shared_area", "cut_area"})
    csv.add(std::string(area) + "_" + u + "2");
  csv.add("sphericity");
  for (const char* axis : {"axis1", "axis2", "axis3"}) csv.add(std::string(axis) + "_length_" + u);
  csv.add("aspect_2_to_1");
  csv.add("aspect_3_to_2");
  for (const char* axis : {"axis1", "axis2", "axis3"}) csv.addNames(axis);
  csv.addNames("box_min");
  csv.addNames("box_max");
  csv.add("coordination");
  csv.add("at_domain_face");
  csv.endRow();
}

std::string grainTable(const std::vector<GrainMeasures>& grains, const Unit& unit) {
  Csv csv;
  addGrainNames(unit.name, csv);
  for (const GrainMeasures& grain : grains) {
    csv.add(grain.id);
    csv.add(grain.voxels);
    csv.add(double(grain.voxels) * unit.volume());
    csv.add(grain.equivalentDiameter * unit.length);
    csv.add(grain.centroid, unit.length);
    if (grain.representative) {
      csv.add(grain.representative->asVec3d(), unit.length);
      csv.add(grain.inscribedRadius * unit.length);
    } else {
      csv.addEmpty(4);
    }
    for (const double area : {grain.totalArea(), grain.freeArea, grain.sharedArea, grain.cutArea})
      csv.add(area * unit.area());
    csv.add(grain.sphericity);
    const auto& lengths = grain.ellipsoid.values;
    for (const double length : lengths) csv.add(length * unit.length);
    csv.add(lengths[1] / lengths[0]);
    csv.add(lengths[2] / lengths[1]);
    for (const openvdb::Vec3d& axis : grain.ellipsoid.axes) csv.add(axis);
    csv.add(grain.box.min());
    csv.add(grain.box.max());
    csv.add(grain.coordination);
    csv.add(int(grain.atDomainFace));
    csv.endRow();
  }
  return csv.text();
}

std::string bondTable(const std::vector<BondMeasures>& bonds, const Unit& unit) {
  Csv csv;
  const std::string& u = unit.name;
  for (const std::string& name : {std::string("first"), std::string("second"), std::string("faces"),
                                  "area_" + u + "2", "radius_" + u})
    csv.add(name);
  csv.addNames("centroid", "_" + u);
  csv.addNames("normal");
  for (const std::string& name :
       {"distance_" + u, std::string("cos_alpha"), "flatness_" + u + "2", std::string("patches"),
        std::string("curvature_points"), "mean_curvature_per_" + u, "mean_curvature_sd_per_" + u,
        "gaussian_curvature_per_" + u + "2", "gaussian_curvature_sd_per_" + u + "2",
        "curvature_residual_" + u})
    csv.add(name);
  csv.endRow();
  for (const BondMeasures& bond : bonds) {
    csv.add(bond.first);
    csv.add(bond.second);
    csv.add(bond.faces);
    csv.add(bond.area * unit.area());
    csv.add(bond.equivalentRadius * unit.length);
    csv.add(bond.centroid, unit.length);
    csv.add(bond.normal);
    if (bond.distance) {
      csv.add(*bond.distance * unit.length);
      csv.add(*bond.cosAlpha);
    } else {
      csv.addEmpty(2);
    }
    csv.add(bond.flatness * unit.area());
    csv.add(bond.patches);
    if (const auto& curvature = bond.curvature) {
      csv.add(curvature->points);
      csv.add(curvature->mean / unit.length);
      csv.add(curvature->meanDeviation / unit.length);
      csv.add(curvature->gaussian / unit.area());
      csv.add(curvature->gaussianDeviation / unit.area());
      csv.add(curvature->residual * unit.length);
    } else {
      csv.add(0);
      csv.addEmpty(5);
    }
    csv.endRow();
  }
  return csv.text();
}

Json toJson(const openvdb::Vec3d& vector) {
  return {vector[0], vector[1], vector[2]};
}

Json toJson(const FabricTensor& fabric) {
  const auto& c = fabric.components;
  Json json;
  json["tensor"] = {{c[0], c[3], c[4]}, {c[3], c[1], c[5]}, {c[4], c[5], c[2]}};
  json["eigenvalues"] = fabric.principal.values;
  Json vectors = Json::array();
  for (const openvdb::Vec3d& axis : fabric.principal.axes) vectors.push_back(toJson(axis));
  json["eigenvectors"] = vectors;
  return json;
}

Json sampleJson(const Measurements& m, const Unit& unit, double iceDensity) {
  const SampleMeasures& s = m.sample;
  const std::string& u = unit.name;
  Json json;
  json["length_unit"] = u;
  if (m.voxelSize) json["voxel_size_" + u] = unit.length;
  json["box"] = s.domainKnown ? "domain" : "grains";
  json["box_min"] = {s.box.min().x(), s.box.min().y(), s.box.min().z()};
  json["box_max"] = {s.box.max().x(), s.box.max().y(), s.box.max().z()};
  json["grains"] = m.grains.size();
  json["bonds"] = m.bonds.size();
  json["object_voxels"] = s.objectVoxels;
  json["object_volume_" + u + "3"] = double(s.objectVoxels) * unit.volume();
  json["ice_fraction"] = s.objectFraction;
  json["ice_density_kg_per_m3"] = iceDensity;
  json["density_kg_per_m3"] = iceDensity * s.objectFraction;
  json["free_area_" + u + "2"] = s.freeArea * unit.area();
  json["shared_area_" + u + "2"] = s.sharedArea * unit.area();
  json["area_estimator"] = "voxel faces weighted by local normals";
  json["specific_surface_per_" + u] = s.specificSurface / unit.length;
  if (m.voxelSize)
    json["specific_surface_m2_per_kg"] = s.specificSurface / m.voxelSize->metres / iceDensity;
  Json lengths = Json::array();
  for (const auto& length : s.correlationLengths)
    lengths.push_back(length ? Json(*length * unit.length) : Json());
  json["correlation_length_" + u] = lengths;
  json["euler_characteristic"] = s.eulerCharacteristic;
  json["components"] = s.components;
  json["mean_coordination"] = s.meanCoordination;
  json["coordination_distribution"] = s.coordinations;
  json["bond_to_grain_ratio"] = s.bondToGrainRatio ? Json(*s.bondToGrainRatio) : Json();
  for (const bool byVolume : {false, true}) {
    Json sizes;
    for (const int percent : {5, 10, 25, 50, 75, 90, 95})
      sizes["d" + std::to_string(percent)] =
          diameterPercentile(m.grains, percent / 100.0, byVolume) * unit.length;
    json[std::string("grain_diameter_by_") + (byVolume ? "volume_" : "number_") + u] = sizes;
  }
  json["grain_axis_fabric"] = toJson(s.grainFabric);
  json["bond_normal_fabric"] = toJson(s.bondFabric);
  return json;
}

}  // namespace

std::vector<std::string> MeasurementTables::paths(const std::string& folder) {
  std::vector<std::string> result;
  for (const char* name : {"grains.csv", "bonds.csv", "sample.json"})
    result.push_back((std::filesystem::path(folder) / name).string());
  return result;
}

MeasurementTables::MeasurementTables(const std::string& folder) : folder_(folder) {
  std::error_code error;
  made_ = std::filesystem::create_directory(folder_, error);
  // A folder that is there is no error; a file is.
  if (!std::filesystem::is_directory(folder_))
    throw IoError("cannot write to " + folder_ + ": it is not a folder and cannot be made" +
                  (error ? " (" + error.message() + ")" : "") +
                  "; give a folder, or one to be made in an existing one");
  for (const std::string& path : paths(folder_))
    files_.push_back(std::make_unique<OutputFile>(path));
}

MeasurementTables::~MeasurementTables() {
  files_.clear();
  std::error_code ignored;
  if (made_ && !done_) std::filesystem::remove(folder_, ignored);  // only if it is empty
}

Json MeasurementTables::write(const Measurements& measurements, double iceDensity) {
  const Unit unit(measurements.voxelSize);
  const Json sample = sampleJson(measurements, unit, iceDensity);
  const std::string texts[] = {grainTable(measurements.grains, unit),
                               bondTable(measurements.bonds, unit), sample.dump(2) + "\n"};
  for (size_t i = 0; i < files_.size(); ++i) {
    std::ofstream stream(files_[i]->temporaryPath(), std::ios::binary);
    stream << texts[i];
    stream.close();
    if (!stream) throw IoError(files_[i]->path() + ": cannot be written: is the disk full?");
  }
  for (const auto& file : files_) {
    file->commit();
    done_ = true;
  }
  return sample;
}

}  // namespace vdb_madf::tools
