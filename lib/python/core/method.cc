// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <limits>

#include "bindings.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/method/hierarchy.h"
#include "vdb_madf/segmentation/ball_grids.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/parameter_sweep.h"
#include "vdb_madf/segmentation/remerge.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/segmentation/segment_memory.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf::python {

namespace {

template <typename Enum>
Enum named(const char* argument, const std::string& text,
           std::initializer_list<std::pair<const char*, Enum>> names) {
  std::string all;
  for (const auto& [name, value] : names) {
    if (text == name) return value;
    all += (all.empty() ? "" : ", ") + std::string(name);
  }
  throw InvalidInput(std::string(argument) + "='" + text + "': must be one of " + all);
}

MergeMode mergeMode(const std::string& name) {
  return named<MergeMode>("merge", name,
                          {{"score", MergeMode::score},
                           {"both", MergeMode::both},
                           {"angle", MergeMode::angle},
                           {"neck", MergeMode::neck}});
}

Adjacency adjacencyOf(const std::string& name) {
  return named<Adjacency>("adjacency", name,
                          {{"manifold", Adjacency::manifold}, {"cell", Adjacency::cell}});
}

template <typename Number>
Number wholeNumber(const std::string& name, const py::handle& value) {
  try {
    return value.cast<Number>();
  } catch (const py::cast_error&) {
    throw InvalidInput(name + "=" + py::repr(value).cast<std::string>() +
                       ": must be a whole number");
  }
}

/// The options of merging as Python gives them: None is the default; what belongs to another mode
/// is refused.
MergeOptions mergeOptions(const py::dict& given) {
  MergeOptions options;
  options.mode = mergeMode(given["merge"].cast<std::string>());
  const bool byScore = options.mode == MergeMode::score;
  for (const auto& [key, value] : given) {
    const auto name = key.cast<std::string>();
    if (name == "merge" || value.is_none()) continue;
    if (name == "min_grain") {
      options.minGrain = wholeNumber<int64_t>(name, value);
      continue;
    }
    if (byScore != (name == "strictness"))
      throw InvalidInput(byScore ? name +
                                       ": belongs to merge='both', 'angle' and 'neck'; 'score', "
                                       "the default, has strictness"
                                 : name + ": belongs to merge='score'");
    if (name == "theta") options.theta = value.cast<double>();
    if (name == "adjacency") options.adjacency = adjacencyOf(value.cast<std::string>());
    if (name == "delta") options.delta = wholeNumber<int>(name, value);
    if (name == "strictness") options.strictness = value.cast<double>();
  }
  checkMergeOptions(options);
  return options;
}

/// As mergeOptions() takes them, without what is of another mode.
py::dict toDict(const MergeOptions& options) {
  py::dict dict;
  dict["merge"] = toString(options.mode);
  if (options.mode == MergeMode::score) {
    dict["strictness"] = options.strictness;
  } else {
    dict["theta"] = options.theta;
    dict["adjacency"] = toString(options.adjacency);
    dict["delta"] = options.delta;
  }
  if (options.minGrain > 0) dict["min_grain"] = options.minGrain;
  return dict;
}

template <typename Items, typename Place>
py::array_t<int32_t> places(const Items& items, const Place& place) {
  py::array_t<int32_t> array({py::ssize_t(items.size()), py::ssize_t(3)});
  int32_t* to = array.mutable_data();
  for (const auto& item : items)
    for (const int coordinate : toIndex(place(item))) *to++ = coordinate;
  return array;
}

py::dict toDict(const ManifoldGraph& graph) {
  using Node = ManifoldGraph::Node;
  using Edge = ManifoldGraph::Edge;
  py::dict dict;
  dict["position"] = places(graph.nodes, [](const Node& n) { return n.position; });
  dict["squared_radius"] =
      column<int64_t>(graph.nodes, [](const Node& n) { return n.squaredRadius; });
  dict["reaches_out"] = column<bool>(graph.nodes, [](const Node& n) { return n.doubt > 0; });
  dict["voxels"] = column<int64_t>(graph.nodes, [](const Node& n) { return n.voxels; });
  dict["first"] = column<int32_t>(graph.edges, [](const Edge& e) { return e.first; });
  dict["second"] = column<int32_t>(graph.edges, [](const Edge& e) { return e.second; });
  dict["contact_faces"] =
      column<int64_t>(graph.edges, [](const Edge& e) { return e.contactFaces; });
  dict["saddle_height"] =
      column<int64_t>(graph.edges, [](const Edge& e) { return e.saddleHeight; });
  dict["cells_touch"] = column<bool>(graph.edges, [](const Edge& e) { return e.cellsTouch; });
  return dict;
}

py::dict toDict(const std::vector<MedialBall>& balls) {
  py::dict dict;
  dict["position"] = places(balls, [](const MedialBall& b) { return b.center; });
  dict["squared_radius"] =
      column<int64_t>(balls, [](const MedialBall& b) { return b.squaredRadius; });
  dict["cell_size"] = column<int64_t>(balls, [](const MedialBall& b) { return b.cellSize; });
  return dict;
}

py::dict toDict(const SegmentCounts& c, const LabelFlaws& flaws) {
  py::dict dict;
  dict["object_voxels"] = c.objectVoxels;
  dict["cavities"] = c.cavities;
  dict["cavity_voxels"] = c.cavityVoxels;
  dict["medial_balls"] = c.medialBalls;
  dict["kept_balls"] = c.keptBalls;
  dict["critical_points"] = c.criticalPoints;
  dict["grains"] = c.grains;
  dict["largest_squared_distance"] = c.largestSquaredDistance;
  dict["leaves"] = c.leaves;
  dict["crumbs"] = flaws.crumbs;
  dict["specks"] = flaws.specks;
  dict["slivers"] = flaws.slivers;
  dict["in_pieces"] = flaws.inPieces;
  return dict;
}

py::dict toDict(const Segmentation& s, const SegmentOptions& options) {
  py::dict dict, seconds, used = toDict(options.merge);
  for (const StageTime& stage : s.times) seconds[py::str(stage.stage)] = stage.seconds;
  used["gamma"] = options.gamma;
  used["fill_holes"] = s.fillHoles;
  used["tidy"] = s.tidy;
  used["boundary"] = s.open ? "open" : "closed";
  dict["labels"] = GridPtr(s.grain);
  dict["distance_squared"] = GridPtr(s.distanceSquared);
  dict["power"] = GridPtr(s.power);
  dict["manifold"] = GridPtr(s.manifold);
  dict["balls"] = options.keepBalls ? py::object(toDict(s.balls)) : py::none();
  dict["graph"] = toDict(s.graph);
  dict["counts"] = toDict(s.counts, s.flaws);
  dict["seconds"] = seconds;
  dict["options"] = used;
  return dict;
}

/// What is free, or the rest of what the caller allows for the process, less the mask that is
/// there.
int64_t memoryFor(const MaskGrid& mask, int64_t allowed) {
  if (allowed <= 0) return availableMemory();
  return std::max<int64_t>(1, allowed - int64_t(mask.memUsage()));
}

SegmentOptions segmentOptions(const MaskGrid& mask, int64_t gamma, const std::string& boundary,
                              const MergeOptions& merge, const std::optional<int64_t>& fillHoles,
                              int tidy, const std::vector<std::string>& keep, int64_t maxMemory) {
  SegmentOptions options;
  options.gamma = gamma;
  options.boundary = boundaryOf(boundary);
  if (options.boundary == Boundary::automatic) options.boundary = storedBoundary(mask);
  options.merge = merge;
  options.fillHoles = fillHoles;
  options.tidy = tidy;
  for (const std::string& what : keep) {
    bool SegmentOptions::*const kept =
        named<bool SegmentOptions::*>("keep", what,
                                      {{"distance", &SegmentOptions::keepDistance},
                                       {"power", &SegmentOptions::keepPower},
                                       {"manifold", &SegmentOptions::keepManifold},
                                       {"balls", &SegmentOptions::keepBalls}});
    options.*kept = true;
  }
  options.maxMemory = memoryFor(mask, maxMemory);
  return options;
}

py::dict segmentMask(const GridPtr& object, const Call& call, const py::dict& merging,
                     int64_t gamma, const std::optional<int64_t>& fillHoles, int tidy,
                     const std::string& boundary, const std::vector<std::string>& keep,
                     int64_t maxMemory) {
  const MaskGrid& mask = asMask(*object);
  const SegmentOptions options = segmentOptions(mask, gamma, boundary, mergeOptions(merging),
                                                fillHoles, tidy, keep, maxMemory);
  return toDict(
      withoutLock(call,
                  [&](Interrupter* interrupter) { return segment(mask, options, interrupter); }),
      options);
}

GridPtr remergeManifolds(const GridPtr& manifold, const Call& call, const py::dict& merging,
                         int tidy) {
  const Int32Grid& grid = asLabels(*manifold);
  const MergeOptions options = mergeOptions(merging);
  return withoutLock(call, [&](Interrupter* interrupter) -> GridPtr {
    return remerge(grid, options, tidy, interrupter);
  });
}

py::dict joinsOf(const GridPtr& manifold) {
  const ManifoldGraph graph = requiredGraph(asLabels(*manifold));
  const std::vector<JoinedGrains> joins = joinedGrains(mergeHierarchy(graph));
  py::dict dict;
  dict["score"] = column<double>(joins, [](const JoinedGrains& j) { return j.score; });
  dict["strictness"] = column<double>(joins, [](const JoinedGrains& j) { return j.strictness; });
  dict["grains"] = column<int64_t>(joins, [](const JoinedGrains& j) { return j.grains; });
  dict["first"] = column<int32_t>(joins, [](const JoinedGrains& j) { return j.first; });
  dict["second"] = column<int32_t>(joins, [](const JoinedGrains& j) { return j.second; });
  dict["first_voxels"] =
      column<int64_t>(joins, [](const JoinedGrains& j) { return j.firstVoxels; });
  dict["second_voxels"] =
      column<int64_t>(joins, [](const JoinedGrains& j) { return j.secondVoxels; });
  return dict;
}

py::dict stableOf(const GridPtr& manifold) {
  using Level = StableStrictness::Level;
  const StableStrictness stable =
      stableStrictness(mergeHierarchy(requiredGraph(asLabels(*manifold))));
  py::dict dict;
  dict["strictness"] = stable.strictness;
  dict["plateau"] = stable.plateau
                        ? py::object(py::make_tuple(stable.plateau->first, stable.plateau->second))
                        : py::none();
  dict["levels"] = column<double>(stable.levels, [](const Level& l) { return l.strictness; });
  dict["grains"] = column<int64_t>(stable.levels, [](const Level& l) { return l.grains; });
  dict["stability"] = column<double>(stable.levels, [](const Level& l) { return l.stability; });
  return dict;
}

py::dict toDict(const std::vector<SweepRow>& rows) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto byScore = [](const SweepRow& r) { return r.mode == MergeMode::score; };
  py::dict dict;
  py::list modes;
  for (const SweepRow& row : rows) modes.append(toString(row.mode));
  dict["merge"] = modes;
  dict["delta"] = column<int64_t>(rows, [](const SweepRow& r) { return r.delta; });
  dict["theta"] =
      column<double>(rows, [&](const SweepRow& r) { return byScore(r) ? kNone : r.theta; });
  dict["strictness"] =
      column<double>(rows, [&](const SweepRow& r) { return byScore(r) ? r.strictness : kNone; });
  dict["grains"] = column<int64_t>(rows, [](const SweepRow& r) { return r.grains; });
  dict["median_voxels"] = column<double>(rows, [](const SweepRow& r) { return r.medianVoxels; });
  dict["small_grains"] = column<int64_t>(rows, [](const SweepRow& r) { return r.smallGrains; });
  dict["small_voxels"] = column<int64_t>(rows, [](const SweepRow& r) { return r.smallVoxels; });
  dict["largest_voxels"] = column<int64_t>(rows, [](const SweepRow& r) { return r.largestVoxels; });
  dict["crumbs"] = column<int64_t>(rows, [](const SweepRow& r) { return r.flaws.crumbs; });
  dict["specks"] = column<int64_t>(rows, [](const SweepRow& r) { return r.flaws.specks; });
  dict["slivers"] = column<int64_t>(rows, [](const SweepRow& r) { return r.flaws.slivers; });
  dict["in_pieces"] = column<int64_t>(rows, [](const SweepRow& r) { return r.flaws.inPieces; });
  return dict;
}

py::dict sweepManifolds(const GridPtr& manifold, const Call& call,
                        const std::vector<std::string>& modes, const std::vector<double>& thetas,
                        const std::vector<int>& deltas, const std::vector<double>& strictnesses,
                        const std::string& adjacency, int64_t minGrain, int tidy, int64_t small) {
  const Int32Grid& grid = asLabels(*manifold);
  SweepOptions options;
  options.thetas = thetas;
  options.modes.clear();
  for (const std::string& mode : modes) options.modes.push_back(mergeMode(mode));
  options.deltas = deltas;
  options.strictnesses = strictnesses;
  options.adjacency = adjacencyOf(adjacency);
  options.minGrain = minGrain;
  options.tidy = tidy;
  options.smallVoxels = small;
  return toDict(withoutLock(
      call, [&](Interrupter* interrupter) { return mergingSweep(grid, options, interrupter); }));
}

int64_t memoryOfSegment(const GridPtr& object, int64_t gamma,
                        const std::vector<std::string>& keep) {
  const MaskGrid& mask = asMask(*object);
  const SegmentOptions options =
      segmentOptions(mask, gamma, "auto", {}, std::nullopt, kTidy, keep, 0);
  const py::gil_scoped_release release;
  return segmentMemory(sampledSize(mask, options), options) + int64_t(mask.memUsage());
}

}  // namespace

Boundary boundaryOf(const std::string& name) {
  return named<Boundary>(
      "boundary", name,
      {{"auto", Boundary::automatic}, {"open", Boundary::open}, {"closed", Boundary::closed}});
}

void bindMethod(py::module_& m) {
  m.def(
      "note_on_boundary",
      [](const GridPtr& object, const std::string& boundary) {
        return noteOnBoundary(boundaryOf(boundary), storedDomain(*object));
      },
      py::arg("object"), py::arg("boundary"));
  m.def("segment", segmentMask, py::arg("mask"), py::arg("call"), py::kw_only(), py::arg("merging"),
        py::arg("gamma"), py::arg("fill_holes"), py::arg("tidy"), py::arg("boundary"),
        py::arg("keep"), py::arg("max_memory"));
  m.def("remerge", remergeManifolds, py::arg("manifold"), py::arg("call"), py::kw_only(),
        py::arg("merging"), py::arg("tidy"));
  m.def("merge_options", [](const py::dict& given) { return toDict(mergeOptions(given)); });
  m.def("joins", joinsOf, py::arg("manifold"));
  m.def("stable_strictness", stableOf, py::arg("manifold"));
  m.def("sweep", sweepManifolds, py::arg("manifold"), py::arg("call"), py::kw_only(),
        py::arg("modes"), py::arg("thetas"), py::arg("deltas"), py::arg("strictnesses"),
        py::arg("adjacency"), py::arg("min_grain"), py::arg("tidy"), py::arg("small"));
  m.def("segment_memory", memoryOfSegment, py::arg("mask"), py::kw_only(), py::arg("gamma"),
        py::arg("keep"));
  m.def(
      "ball_grids",
      [](const GridPtr& mask, const Call& call) {
        return withoutLock(call, [&](Interrupter* interrupter) -> GridPtr {
          return closedBalls(asMask(*mask), availableMemory(), interrupter);
        });
      },
      py::arg("mask"), py::arg("call"));
}

}  // namespace vdb_madf::python
