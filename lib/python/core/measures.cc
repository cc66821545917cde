// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <limits>
#include <map>

#include "array_source.h"
#include "bindings.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/estimate_blur.h"
#include "vdb_madf/intensity/measure_gray.h"
#include "vdb_madf/intensity/measure_necks.h"
#include "vdb_madf/intensity/measure_sensitivity.h"
#include "vdb_madf/matching/compare.h"
#include "vdb_madf/matching/pair_checks.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/measure/edge_weights.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/measure/measure_binder.h"
#include "vdb_madf/measure/measure_stability.h"
#include "vdb_madf/measure/size_biases.h"
#include "vdb_madf/measure/table_unit.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/volumes/choose_grid.h"
#include "vdb_madf/volumes/load_object.h"

namespace vdb_madf::python {

namespace {

/// "mm^2" or "1/mm"; nothing of 0.
std::string powerOf(const TableUnit& unit, int exponent) {
  if (exponent == 0) return "";
  const std::string positive =
      unit.name + (std::abs(exponent) == 1 ? "" : "^" + std::to_string(std::abs(exponent)));
  return (exponent < 0 ? "1/" : "") + positive;
}

py::object columnArray(const MeasureColumn& c, const TableUnit& unit) {
  using Kind = MeasureColumn::Kind;
  if (c.kind == Kind::flag) return column<bool>(c.values, [](double v) { return v != 0; });
  if (c.kind == Kind::label) return column<int32_t>(c.values, [](double v) { return v; });
  if (c.kind == Kind::count) return column<int64_t>(c.values, [](double v) { return v; });
  return column<double>(c.values, [&](double v) { return scaled(c, v, unit.edges) + 0.0; });
}

py::dict table(const std::vector<MeasureColumn>& columns, const TableUnit& unit, py::dict& units) {
  py::dict dict;
  for (const MeasureColumn& c : columns) {
    dict[py::str(c.name)] = columnArray(c, unit);
    units[py::str(c.name)] = powerOf(unit, c.power);
  }
  return dict;
}

/// A symmetric tensor, [z, y, x].
py::array_t<double> tensor(const SymmetricTensor& of) {
  py::array_t<double> array({py::ssize_t(3), py::ssize_t(3)});
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) array.mutable_at(2 - i, 2 - j) = of.at(i, j);
  return array;
}

double orNan(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

/// diameterOf(share), in voxels
template <typename DiameterOf>
py::dict percentiles(double length, const DiameterOf& diameterOf) {
  py::dict dict;
  for (const int percent : {5, 10, 25, 50, 75, 90, 95})
    dict[py::int_(percent)] = diameterOf(percent / 100.0) * length;
  return dict;
}

void addEdgeCorrected(const Measurements& m, const TableUnit& unit, py::dict& dict,
                      py::dict& units) {
  const EdgeCorrected corrected = edgeCorrected(m.grains);
  const auto add = [&](const char* name, const std::optional<double>& value, int power) {
    dict[name] = scaled(orNan(value), power, unit.length);
    units[name] = powerOf(unit, power);
  };
  dict["grains_at_faces"] = corrected.leftOut;
  dict["corrected_grains"] = corrected.grains;
  add("grain_diameter_mean", meanDiameter(m.grains), 1);
  add("corrected_grain_diameter_mean", corrected.meanDiameter, 1);
  add("grain_volume_mean", meanVolume(m.grains), 3);
  add("corrected_grain_volume_mean", corrected.meanVolume, 3);
  add("corrected_mean_coordination", corrected.meanCoordination, 0);
  for (const bool byVolume : {false, true}) {
    const char* name = byVolume ? "corrected_diameter_by_volume" : "corrected_diameter_by_number";
    dict[name] = percentiles(unit.length, [&](double share) {
      return correctedDiameterPercentile(m.grains, share, byVolume);
    });
    units[name] = powerOf(unit, 1);
  }
}

py::dict intervalsOf(const std::vector<MeanInterval>& list, const TableUnit& unit,
                     py::dict& units) {
  py::dict intervals;
  for (const MeanInterval& mean : list) {
    py::dict interval;
    interval["mean"] = scaled(orNan(mean.mean), mean.power, unit.length);
    interval["low"] = scaled(orNan(mean.low), mean.power, unit.length);
    interval["high"] = scaled(orNan(mean.high), mean.power, unit.length);
    intervals[py::str(mean.name)] = interval;
    units[py::str(mean.name)] = powerOf(unit, mean.power);
  }
  return intervals;
}

py::dict sensitivityOf(const Sensitivity& s, const TableUnit& unit, py::dict& units) {
  const auto range = [](const VariedRange& varied) {
    return py::make_tuple(varied.low, varied.high);
  };
  py::dict dict;
  dict["runs"] = s.runs;
  dict["threshold"] = range(s.threshold);
  dict["smooth_voxels"] = range(s.smooth);
  dict["strictness"] = range(s.strictness);
  dict["gamma"] = range(s.gamma);
  dict["intervals"] = intervalsOf(s.intervals, unit, units);
  return dict;
}

/// How far choices are varied, by name; what is not named has its default.
void setVaried(const std::map<std::string, double>& vary, SensitivityOptions& options) {
  for (const auto& [name, value] : vary)
    if (!options.vary(name, std::min(value, 1e18)))
      throw InvalidInput("vary: '" + name + "' is none of threshold, smooth, strictness, gamma");
}

/// Numbers along z, y, x.
void addCrossings(const Crossings& crossings, const TableUnit& unit, py::dict& dict,
                  py::dict& units) {
  const auto add = [&](const char* name, const auto& number) {
    const auto& [x, y, z] = crossings.along;
    dict[name] = py::make_tuple(number(z), number(y), number(x));
  };
  add("minimum_cut_area", [&](const Crossing& c) { return orNan(c.cutArea) * unit.area(); });
  units["minimum_cut_area"] = powerOf(unit, 2);
  add("minimum_cut_share", [](const Crossing& c) { return orNan(c.cutArea) / c.section; });
  add("minimum_cut_bonds", [](const Crossing& c) {
    return c.cutArea ? py::object(py::int_(c.cutBonds)) : py::float_(orNan(c.cutArea));
  });
  add("bond_conductivity", [](const Crossing& c) { return c.conductivity; });
  dict["bond_conductivity_tensor"] = tensor(crossings.conductivity);
}

py::dict sampleOf(const Measurements& m, const TableUnit& unit, py::dict& units) {
  const SampleMeasures& s = m.sample;
  py::dict dict;
  const auto add = [&](const char* name, double value, int power) {
    dict[name] = scaled(value, power, unit.length);
    units[name] = powerOf(unit, power);
  };
  dict["grains"] = m.grains.size();
  dict["bonds"] = m.bonds.size();
  dict["box"] = s.regionVoxels ? "region" : s.domainKnown ? "domain" : "grains";
  dict["box_min"] = triple(toIndex(s.box.min()));
  dict["box_max"] = triple(toIndex(s.box.max()));
  dict["boundary"] = m.open ? "open" : "closed";
  dict["object_voxels"] = s.objectVoxels;
  add("object_volume", s.objectVolume, 3);
  dict["solid_fraction"] = s.objectFraction;
  add("free_area", s.freeArea, 2);
  add("shared_area", s.sharedArea, 2);
  add("specific_surface", s.specificSurface, -1);
  py::list lengths;
  for (int axis : {2, 1, 0})
    lengths.append(orNan(s.correlationLengths[size_t(axis)]) * unit.length);
  dict["correlation_length"] = py::tuple(lengths);
  units["correlation_length"] = powerOf(unit, 1);
  dict["euler_characteristic"] = s.eulerCharacteristic;
  dict["components"] = s.components;
  dict["mean_coordination"] = s.meanCoordination;
  dict["coordinations"] = column<int64_t>(s.coordinations, [](int64_t n) { return n; });
  dict["min_faces"] = m.minFaces;
  dict["contacts_left_out"] = s.contactsLeftOut;
  add("area_left_out", s.areaLeftOut, 2);
  dict["bonds_without_curvature"] = s.bondsWithoutCurvature;
  dict["bond_to_grain_ratio"] = orNan(s.bondToGrainRatio);
  dict["grain_fabric"] = tensor(s.grainFabric);
  dict["bond_fabric"] = tensor(s.bondFabric);
  for (const bool byVolume : {false, true})
    dict[byVolume ? "diameter_by_volume" : "diameter_by_number"] = percentiles(
        unit.length, [&](double share) { return diameterPercentile(m.grains, share, byVolume); });
  units["diameter_by_number"] = powerOf(unit, 1);
  units["diameter_by_volume"] = powerOf(unit, 1);
  dict["labels_digest"] = m.labelDigest;
  if (m.extra.edgeWeights) addEdgeCorrected(m, unit, dict, units);
  if (m.crossings) addCrossings(*m.crossings, unit, dict, units);
  if (m.replicates > 0) dict["intervals"] = intervalsOf(m.intervals, unit, units);
  if (!m.sizeDeviations.empty()) {
    py::dict deviations;
    for (const SizeDeviation& deviation : m.sizeDeviations)
      deviations[py::str(deviation.size)] = deviation.percent;
    dict["size_curve_rms_percent"] = deviations;
  }
  if (m.binder) {
    add("binder_volume", m.binder->volume, 3);
    add("binder_loose_volume", m.binder->looseVolume, 3);
    dict["bridges"] = m.binder->bridges.size();
  }
  if (m.scan) {
    add("scan_blur", m.scan->sigma, 1);
    dict["scan_noise_of_contrast"] = m.scan->noise;
    dict["scan_gray_inside"] = m.scan->inside;
    dict["scan_gray_outside"] = m.scan->outside;
    const ConfirmedNecks necks = confirmedNecks(m);
    dict["necks_confirmed"] = necks.count;
    add("neck_area", necks.area, 2);
    add("contact_gap", kContactGap, 1);
    dict["contact_coordination"] = contactCoordination(m);
  }
  if (m.sensitivity) dict["sensitivity"] = sensitivityOf(*m.sensitivity, unit, units);
  py::dict biases;
  for (const SizeBias& bias : sizeBiases(m)) biases[bias.number.c_str()] = bias.expected;
  dict["expected_bias"] = biases;
  return dict;
}

/// A path or an array; none: no scan.
std::optional<GrayScan> openScan(const py::object& source, const std::string& part) {
  if (source.is_none()) return std::nullopt;
  if (!py::isinstance<py::str>(source))
    return GrayScan{std::make_unique<ArrayReader>(source.cast<const ArraySource&>()), Coord(0)};
  const auto path = source.cast<std::string>();
  VolumeOptions options;
  (isVdbFile(path) ? options.grid : options.dataset) = part;
  const py::gil_scoped_release release;
  return openGrayScan(path, options);
}

/// The binder of a map of phases, a path or an array.
MaskGrid::Ptr loadBinder(const py::object& source, const std::string& part, int64_t value) {
  VolumeOptions options;
  options.selection = Selection::phase(double(value));
  if (!py::isinstance<py::str>(source)) {
    const auto& array = source.cast<const ArraySource&>();
    const py::gil_scoped_release release;
    return loadObject([&] { return std::make_unique<ArrayReader>(array); }, options);
  }
  const auto path = source.cast<std::string>();
  (isVdbFile(path) ? options.grid : options.dataset) = part;
  const py::gil_scoped_release release;
  return loadObject(path, options);
}

py::dict measureLabels(const GridPtr& labels, const Call& call, const std::string& boundary,
                       int64_t minFaces, bool shape, const py::object& intensity,
                       const std::string& intensityGrid, const py::object& gray,
                       const std::string& grayGrid, bool edgeWeights, bool crossing, bool voronoi,
                       bool sizeCurve, const std::string& sizeReference, const py::object& phases,
                       const std::string& phasesGrid, int64_t binder, const GridPtr& manifold,
                       int bootstrap, int sensitivity, const std::map<std::string, double>& vary,
                       const std::string& unitName) {
  const Int32Grid& grid = asLabels(*labels);
  requireTableUnit(unitName, storedVoxelSize(grid));
  MeasureOptions options;
  options.minFaces = minFaces;
  options.shape = shape;
  options.edgeWeights = edgeWeights;
  options.crossings = crossing;
  options.cells = voronoi;
  options.sizes = sizeCurve;
  if (!sizeReference.empty()) options.sizeReference = readSizeReference(sizeReference);
  options.bootstrap = bootstrap;
  if (const Boundary given = boundaryOf(boundary); given != Boundary::automatic)
    options.boundary = given;
  std::optional<GrayScan> scan = openScan(intensity, intensityGrid);
  std::optional<GrayScan> edges = openScan(gray, grayGrid), sections = openScan(gray, grayGrid);
  const MaskGrid::Ptr third = phases.is_none() ? nullptr : loadBinder(phases, phasesGrid, binder);
  SensitivityOptions again;
  again.runs = sensitivity;
  again.measure = options;
  setVaried(vary, again);
  const auto openAgain = [&] {
    const py::gil_scoped_acquire lock;
    return std::move(*openScan(gray, grayGrid));
  };
  std::optional<ManifoldGraph> graph;
  if (manifold) graph = requiredGraph(asLabels(*manifold));
  std::vector<std::string> notes;
  const auto noteOf = [&](const std::string& scanName, const std::string& note) {
    if (!note.empty()) notes.push_back(scanName + ": " + note);
  };
  noteOf("labels", noteOnPlaces(grid));
  if (scan) noteOf("intensity", noteOnScan(*scan, grid));
  if (edges) noteOf("gray", noteOnScan(*edges, grid));
  if (const auto domain = third ? storedDomain(*third) : std::nullopt)
    noteOf("phases", noteOnScan("phases", domain->box(), storedVoxelSize(*third), grid));
  const Measurements measured = withoutLock(call, [&](Interrupter* interrupter) {
    Measurements result = measure(grid, options, interrupter);
    if (graph) measureStability(*graph, result);
    if (scan) measureGray(grid, *scan, result, interrupter);
    if (third) measureBinder(grid, *third, options, result, interrupter);
    if (third) noteOf("phases", noteOn(*result.binder, binder));
    if (edges) {
      const auto domain = storedDomain(grid);
      const auto blur = sensitivity > 0 ? estimateBlur(std::move(*edges), domain, interrupter)
                                        : blurOf(std::move(*edges), domain, interrupter);
      noteOf("gray",
             blur ? noteOn(*blur) : "the scan's edges tell no blur: necks are not measured");
      if (blur) measureNecks(grid, *sections, *blur, result, interrupter);
    }
    if (sensitivity > 0) measureSensitivity(grid, openAgain, again, result, interrupter);
    return result;
  });
  if (measured.grains.size() == 1)
    noteOf("labels", "there is 1 grain: is this a mask? segment it first");
  const TableUnit unit(measured, unitName);
  py::dict dict, units;
  dict["grains"] = table(grainColumns(measured.grains, measured.extra), unit, units);
  dict["bonds"] = table(bondColumns(measured.bonds, measured.extra), unit, units);
  dict["sample"] = sampleOf(measured, unit, units);
  if (measured.binder)
    dict["bridges"] = table(bridgeColumns(measured.binder->bridges), unit, units);
  if (sizeCurve) dict["sample"]["size_curve"] = table(vdb_madf::sizeCurve(measured), unit, units);
  dict["unit"] = unit.name;
  dict["units"] = units;
  dict["notes"] = notes;
  return dict;
}

py::dict matches(const std::vector<GrainMatch>& list) {
  py::dict dict;
  dict["id"] = column<int32_t>(list, [](const GrainMatch& g) { return g.grain; });
  dict["voxels"] = column<int64_t>(list, [](const GrainMatch& g) { return g.voxels; });
  dict["partner"] = column<int32_t>(list, [](const GrainMatch& g) { return g.partner; });
  dict["overlap_voxels"] =
      column<int64_t>(list, [](const GrainMatch& g) { return g.overlapVoxels; });
  dict["intersection_over_union"] =
      column<double>(list, [](const GrainMatch& g) { return g.intersectionOverUnion; });
  dict["pieces"] = column<int64_t>(list, [](const GrainMatch& g) { return g.pieces; });
  return dict;
}

py::dict compareLabels(const GridPtr& truth, const GridPtr& test, const Call& call) {
  const Int32Grid &truths = asLabels(*truth), &tests = asLabels(*test);
  const PairNames names{"truth", "test"};
  checkSameVoxels(truths, tests, names);
  const Comparison c = withoutLock(
      call, [&](Interrupter* interrupter) { return compare(truths, tests, interrupter); });
  checkAnyCommon(c, names);
  py::dict dict, overlaps;
  dict["truth_grains"] = c.truthGrains;
  dict["test_grains"] = c.testGrains;
  dict["common_voxels"] = c.commonVoxels;
  dict["truth_only_voxels"] = c.truthOnlyVoxels;
  dict["test_only_voxels"] = c.testOnlyVoxels;
  dict["misclassified_percent"] = c.misclassifiedPercent;
  dict["mirror_misclassified_percent"] = c.mirrorMisclassifiedPercent;
  dict["adjusted_rand_index"] = c.adjustedRandIndex;
  dict["variation_of_information"] = c.variationOfInformation;
  dict["variation_split"] = c.variationSplit;
  dict["variation_merge"] = c.variationMerge;
  dict["found_grains"] = c.foundGrains;
  dict["mean_intersection_over_union"] = c.meanIntersectionOverUnion;
  dict["splits"] = c.splits;
  dict["merges"] = c.merges;
  dict["truth_matches"] = matches(c.truthMatches);
  dict["test_matches"] = matches(c.testMatches);
  overlaps["truth"] = column<int32_t>(c.overlaps, [](const Overlap& o) { return o.truth; });
  overlaps["test"] = column<int32_t>(c.overlaps, [](const Overlap& o) { return o.test; });
  overlaps["voxels"] = column<int64_t>(c.overlaps, [](const Overlap& o) { return o.voxels; });
  dict["overlaps"] = overlaps;
  dict["notes"] = notesOn(c, truths, tests);
  return dict;
}

}  // namespace

void bindMeasures(py::module_& m) {
  m.def("measure", measureLabels, py::arg("labels"), py::arg("call"), py::kw_only(),
        py::arg("boundary"), py::arg("min_faces"), py::arg("shape"), py::arg("intensity"),
        py::arg("intensity_grid"), py::arg("gray"), py::arg("gray_grid"), py::arg("edge_weights"),
        py::arg("crossing"), py::arg("voronoi"), py::arg("size_curve"), py::arg("size_reference"),
        py::arg("phases"), py::arg("phases_grid"), py::arg("binder"), py::arg("manifold"),
        py::arg("bootstrap"), py::arg("sensitivity"), py::arg("vary"), py::arg("unit"));
  m.def("compare", compareLabels, py::arg("truth"), py::arg("test"), py::arg("call"));
}

}  // namespace vdb_madf::python
