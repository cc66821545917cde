// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/measurement_files.h"

#include <openvdb/Metadata.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "vdb_madf/base/version.h"
#include "vdb_madf/exports/detail/grain_table.h"
#include "vdb_madf/exports/detail/hdf5_tables.h"
#include "vdb_madf/files/csv_cell.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/files/output_file.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/files/written_together.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/measure/edge_weights.h"
#include "vdb_madf/measure/size_biases.h"
#include "vdb_madf/measure/table_unit.h"

namespace vdb_madf {

namespace {

using Json = nlohmann::ordered_json;

/// Comma-separated values.
std::string table(const std::vector<MeasureColumn>& columns, const TableUnit& unit,
                  const std::string& sample) {
  const std::string first = sample.empty() ? "" : csvCell(sample) + ",";
  std::string text = sample.empty() ? "" : "sample,";
  for (const MeasureColumn& column : columns)
    text += (&column == &columns.front() ? "" : ",") + column.name +
            unitSuffix(column.power, unit.name);
  text += '\n';
  for (size_t row = 0; row < columns.front().values.size(); ++row) {
    text += first;
    for (const MeasureColumn& column : columns) {
      if (&column != &columns.front()) text += ',';
      text += detail::measureText(column, row, unit.edges);
    }
    text += '\n';
  }
  return text;
}

Json toJson(const openvdb::Vec3d& vector) {
  return {vector[0], vector[1], vector[2]};
}

Json toJson(const SymmetricTensor& tensor) {
  Json json;
  for (int row = 0; row < 3; ++row)
    json["tensor"].push_back({tensor.at(row, 0), tensor.at(row, 1), tensor.at(row, 2)});
  json["eigenvalues"] = tensor.principal.values;
  Json vectors = Json::array();
  for (const openvdb::Vec3d& axis : tensor.principal.axes) vectors.push_back(toJson(axis));
  json["eigenvectors"] = vectors;
  return json;
}

/// How the labels were made, as their grid tells it. Of the voxel size the tables say more.
Json segmentationJson(const openvdb::MetaMap& metadata) {
  const std::string prefix = "madf_";
  Json json = Json::object();
  for (auto item = metadata.beginMeta(); item != metadata.endMeta(); ++item) {
    const std::string& key = item->first;
    if (key.compare(0, prefix.size(), prefix) != 0 || key == kVoxelSizeKey ||
        key == "madf_length_unit")
      continue;
    if (const auto value = plainValue(*item->second))
      std::visit([&](const auto& plain) { json[key.substr(prefix.size())] = plain; }, *value);
  }
  return json;
}

Json orNull(const std::optional<double>& value, int power, double length) {
  return value ? Json(scaled(*value, power, length)) : Json();
}

/// Percentiles by diameterOf(share, byVolume), in voxels.
template <typename DiameterOf>
void addDiameters(const std::string& stem, const TableUnit& unit, const DiameterOf& diameterOf,
                  Json& json) {
  for (const bool byVolume : {false, true}) {
    Json sizes;
    for (const int percent : {5, 10, 25, 50, 75, 90, 95})
      sizes["d" + std::to_string(percent)] = diameterOf(percent / 100.0, byVolume) * unit.length;
    json[stem + (byVolume ? "volume_" : "number_") + unit.name] = sizes;
  }
}

void addEdgeCorrected(const Measurements& m, const TableUnit& unit, Json& json) {
  const EdgeCorrected corrected = edgeCorrected(m.grains);
  const auto add = [&](const char* name, const std::optional<double>& value, int power) {
    json[name + unitSuffix(power, unit.name)] = orNull(value, power, unit.length);
  };
  json["grains_at_faces"] = corrected.leftOut;
  json["corrected_grains"] = corrected.grains;
  add("grain_diameter_mean", meanDiameter(m.grains), 1);
  add("corrected_grain_diameter_mean", corrected.meanDiameter, 1);
  add("grain_volume_mean", meanVolume(m.grains), 3);
  add("corrected_grain_volume_mean", corrected.meanVolume, 3);
  add("corrected_mean_coordination", corrected.meanCoordination, 0);
  addDiameters(
      "corrected_grain_diameter_by_", unit,
      [&](double share, bool byVolume) {
        return correctedDiameterPercentile(m.grains, share, byVolume);
      },
      json);
}

void addIntervals(const std::vector<MeanInterval>& intervals, const std::string& ending,
                  const TableUnit& unit, Json& json) {
  for (const MeanInterval& mean : intervals) {
    Json interval;
    interval["mean"] = orNull(mean.mean, mean.power, unit.length);
    interval["low"] = orNull(mean.low, mean.power, unit.length);
    interval["high"] = orNull(mean.high, mean.power, unit.length);
    json[mean.name + ending + unitSuffix(mean.power, unit.name)] = interval;
  }
}

void addScan(const Measurements& m, const TableUnit& unit, Json& json) {
  const ConfirmedNecks necks = confirmedNecks(m);
  json["scan_blur_" + unit.name] = m.scan->sigma * unit.length;
  json["scan_noise_of_contrast"] = m.scan->noise;
  json["scan_gray_inside"] = m.scan->inside;
  json["scan_gray_outside"] = m.scan->outside;
  json["necks_confirmed"] = necks.count;
  json["neck_area_" + unit.name + "2"] = necks.area * unit.area();
  json["contact_gap_" + unit.name] = kContactGap * unit.length;
  json["contact_coordination"] = contactCoordination(m);
}

void addSensitivity(const Measurements& m, const TableUnit& unit, Json& json) {
  const Sensitivity& s = *m.sensitivity;
  const auto range = [](const VariedRange& varied) { return Json{varied.low, varied.high}; };
  json["sensitivity_runs"] = s.runs;
  json["sensitivity_threshold"] = range(s.threshold);
  json["sensitivity_smooth_voxels"] = range(s.smooth);
  json["sensitivity_strictness"] = range(s.strictness);
  json["sensitivity_gamma"] = range(s.gamma);
  addIntervals(s.intervals, "_sensitivity", unit, json);
}

void addCrossings(const Crossings& crossings, const TableUnit& unit, Json& json) {
  for (size_t axis = 0; axis < 3; ++axis) {
    const Crossing& crossing = crossings.along[axis];
    const std::string name = std::string("_") + "xyz"[axis];
    json["minimum_cut_area" + name + "_" + unit.name + "2"] =
        orNull(crossing.cutArea, 2, unit.length);
    json["minimum_cut_share" + name] =
        crossing.cutArea ? Json(*crossing.cutArea / crossing.section) : Json();
    json["minimum_cut_bonds" + name] = crossing.cutArea ? Json(crossing.cutBonds) : Json();
    json["bond_conductivity" + name] = crossing.conductivity;
  }
  json["bond_conductivity_tensor"] = toJson(crossings.conductivity);
}

Json sampleJson(const Measurements& m, const TableUnit& unit, const TableOptions& options) {
  const SampleMeasures& s = m.sample;
  const std::string& u = unit.name;
  Json json;
  if (!options.sample.empty()) json["sample"] = options.sample;
  json["version"] = kVersion;
  if (!options.labels.empty()) json["labels"] = options.labels;
  if (!m.gridName.empty()) json["grid"] = m.gridName;
  json["labels_digest"] = m.labelDigest;
  json["segmentation"] = segmentationJson(m.metadata);
  json["boundary"] = m.open ? "open" : "closed";
  json["length_unit"] = u;
  if (m.voxelSize)
    json["voxel_size_" + u] = m.voxelSize->isCube() ? Json(unit.length) : Json(unit.voxel);
  json["box"] = s.regionVoxels ? "region" : s.domainKnown ? "domain" : "grains";
  json["box_min"] = {s.box.min().x(), s.box.min().y(), s.box.min().z()};
  json["box_max"] = {s.box.max().x(), s.box.max().y(), s.box.max().z()};
  if (s.regionVoxels) json["domain_voxels"] = *s.regionVoxels;
  json["grains"] = m.grains.size();
  json["bonds"] = m.bonds.size();
  json["bonds_without_curvature"] = s.bondsWithoutCurvature;
  json["min_faces"] = m.minFaces;
  json["contacts_left_out"] = s.contactsLeftOut;
  json["contacts_left_out_area_" + u + "2"] = s.areaLeftOut * unit.area();
  json["object_voxels"] = s.objectVoxels;
  json["object_volume_" + u + "3"] = s.objectVolume * unit.volume();
  json["solid_fraction"] = s.objectFraction;
  if (options.density) {
    json["solid_density_kg_per_m3"] = *options.density;
    json["bulk_density_kg_per_m3"] = *options.density * s.objectFraction;
  }
  json["free_area_" + u + "2"] = s.freeArea * unit.area();
  json["shared_area_" + u + "2"] = s.sharedArea * unit.area();
  json["area_estimator"] = "voxel faces weighted by local normals";
  json["specific_surface_per_" + u] = s.specificSurface / unit.length;
  if (m.voxelSize && options.density)
    json["specific_surface_m2_per_kg"] =
        s.specificSurface / m.voxelSize->shortestEdge() / *options.density;
  Json lengths = Json::array();
  for (const auto& length : s.correlationLengths)
    lengths.push_back(length ? Json(*length * unit.length) : Json());
  json["correlation_length_" + u] = lengths;
  json["euler_characteristic"] = s.eulerCharacteristic;
  json["components"] = s.components;
  json["mean_coordination"] = s.meanCoordination;
  json["coordination_distribution"] = s.coordinations;
  json["bond_to_grain_ratio"] = s.bondToGrainRatio ? Json(*s.bondToGrainRatio) : Json();
  addDiameters(
      "grain_diameter_by_", unit,
      [&](double share, bool byVolume) { return diameterPercentile(m.grains, share, byVolume); },
      json);
  json["grain_axis_fabric"] = toJson(s.grainFabric);
  json["bond_normal_fabric"] = toJson(s.bondFabric);
  if (m.extra.edgeWeights) addEdgeCorrected(m, unit, json);
  if (m.replicates > 0) {
    json["bootstrap_replicates"] = m.replicates;
    addIntervals(m.intervals, "_interval", unit, json);
  }
  if (m.binder) {
    json["binder_volume_" + u + "3"] = m.binder->volume * unit.volume();
    json["binder_loose_volume_" + u + "3"] = m.binder->looseVolume * unit.volume();
    json["bridges"] = m.binder->bridges.size();
  }
  for (const SizeDeviation& deviation : m.sizeDeviations)
    json["size_curve_rms_percent"][deviation.size] =
        std::isnan(deviation.percent) ? Json() : Json(deviation.percent);
  if (m.crossings) addCrossings(*m.crossings, unit, json);
  if (m.scan) addScan(m, unit, json);
  if (m.sensitivity) addSensitivity(m, unit, json);
  for (const SizeBias& bias : sizeBiases(m))
    json["expected_bias_percent"][bias.number] = int(std::round(100 * bias.expected));
  return json;
}

/// A file name need not be UTF-8: what is not is replaced.
std::string jsonText(const Json& sample) {
  return sample.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

MeasurementTexts measurementTexts(const Measurements& m, const TableOptions& options) {
  const TableUnit unit(m, options.unit);
  return {table(grainColumns(m.grains, m.extra), unit, options.sample),
          table(bondColumns(m.bonds, m.extra), unit, options.sample),
          jsonText(sampleJson(m, unit, options))};
}

SizeReference readSizeReference(const std::string& path) {
  constexpr uint64_t kMostBytes = 1 << 20;
  const std::string text = readText(path, kMostBytes);
  try {
    return parseSizeReference(text);
  } catch (const InvalidInput& error) {
    throw InvalidInput(path + ": " + error.what());
  }
}

std::string sizeCurveText(const Measurements& m, const TableOptions& options) {
  return table(sizeCurve(m), TableUnit(m, options.unit), options.sample);
}

std::string bridgesText(const Measurements& m, const TableOptions& options) {
  return table(bridgeColumns(m.binder.value().bridges), TableUnit(m, options.unit), options.sample);
}

std::vector<std::string> MeasurementTables::paths(const std::string& folder) {
  if (detail::isHdf5Tables(folder)) return {folder};
  std::vector<std::string> result;
  for (const char* name : {"grains.csv", "bonds.csv", "sample.json"})
    result.push_back((std::filesystem::path(folder) / name).string());
  return result;
}

MeasurementTables::MeasurementTables(const std::string& folder) {
  if (detail::isHdf5Tables(folder)) {
    detail::checkHdf5Tables(folder);
    file_ = folder;
    return;
  }
  folder_.emplace(folder);
  const std::vector<std::string> files = paths(folder);
  removeLeftovers(files);
  checkWrittenTogether(files[2], {files[0], files[1]});
  checkWrittenTogether(files[0], {files[2]});
  for (const std::string& path : paths(folder))
    files_.push_back(std::make_unique<detail::OutputStream>(path));
}

MeasurementTables::~MeasurementTables() = default;

void MeasurementTables::write(const Measurements& measurements, const TableOptions& options) {
  if (!file_.empty()) {
    const TableUnit unit(measurements, options.unit);
    return detail::writeHdf5Tables(
        file_, {unit.name, unit.edges, grainColumns(measurements.grains, measurements.extra),
                bondColumns(measurements.bonds, measurements.extra),
                sampleJson(measurements, unit, options)});
  }
  const MeasurementTexts texts = measurementTexts(measurements, options);
  files_.at(0)->text(texts.grains);
  files_.at(1)->text(texts.bonds);
  files_.at(2)->text(texts.sample);
  OutputSet set;
  for (const auto& file : files_) file->commit();
  set.commit();
}

}  // namespace vdb_madf
