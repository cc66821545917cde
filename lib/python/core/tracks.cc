// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>

#include "bindings.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/matching/pair_checks.h"
#include "vdb_madf/matching/track.h"
#include "vdb_madf/samples/evolve.h"

namespace vdb_madf::python {

namespace {

/// An array of texts.
template <typename Items, typename Text>
py::object texts(const Items& items, const Text& text) {
  py::list list;
  for (const auto& item : items) list.append(text(item));
  return py::module_::import("numpy").attr("array")(list, py::arg("dtype") = "U9");
}

py::dict toDict(const std::vector<TrackedGrain>& grains) {
  using G = TrackedGrain;
  py::dict dict;
  dict["id"] = column<int32_t>(grains, [](const G& g) { return g.grain; });
  dict["fate"] = texts(grains, [](const G& g) { return toString(g.fate); });
  dict["track"] = column<int32_t>(grains, [](const G& g) { return g.track; });
  dict["voxels"] = column<int64_t>(grains, [](const G& g) { return g.voxels; });
  dict["shared_voxels"] = column<int64_t>(grains, [](const G& g) { return g.sharedVoxels; });
  dict["links"] = column<int64_t>(grains, [](const G& g) { return g.links; });
  dict["partner"] = column<int32_t>(grains, [](const G& g) { return g.partner; });
  dict["overlap_voxels"] = column<int64_t>(grains, [](const G& g) { return g.overlapVoxels; });
  return dict;
}

py::dict toDict(const std::vector<GrainOverlap>& overlaps) {
  using O = GrainOverlap;
  py::dict dict;
  dict["before"] = column<int32_t>(overlaps, [](const O& o) { return o.before; });
  dict["after"] = column<int32_t>(overlaps, [](const O& o) { return o.after; });
  dict["voxels"] = column<int64_t>(overlaps, [](const O& o) { return o.voxels; });
  dict["link"] = column<bool>(overlaps, [](const O& o) { return o.isLink; });
  return dict;
}

py::dict toDict(const std::vector<TrackedBond>& bonds) {
  using B = TrackedBond;
  py::dict dict;
  dict["first"] = column<int32_t>(bonds, [](const B& b) { return b.first; });
  dict["second"] = column<int32_t>(bonds, [](const B& b) { return b.second; });
  dict["faces"] = column<int64_t>(bonds, [](const B& b) { return b.faces; });
  dict["shared_faces"] = column<int64_t>(bonds, [](const B& b) { return b.sharedFaces; });
  dict["fate"] = texts(bonds, [](const B& b) { return toString(b.fate); });
  return dict;
}

/// Numbers of each grain along z, y and x, or pairs of these axes; NaN where there are none.
template <size_t kSize, typename Numbers>
py::array_t<double> numbers(const std::vector<const GrainMove*>& moves, std::vector<size_t> shape,
                            const Numbers& numbersOf) {
  std::vector<double> all;
  for (const GrainMove* move : moves)
    for (size_t n = 0; n < kSize; ++n) all.push_back(numbersOf(move, int(n)));
  shape.insert(shape.begin(), moves.size());
  return toArray(std::move(all)).reshape(std::vector<py::ssize_t>(shape.begin(), shape.end()));
}

/// With a motion; what was followed has it on either side.
py::dict toDict(const std::vector<TrackedGrain>& grains, const Tracks& tracks) {
  using G = TrackedGrain;
  using M = GrainMove;
  const MoveOf move = moveOf(tracks);
  std::vector<const M*> moves;
  for (const G& grain : grains) moves.push_back(move(grain));
  const double none = std::nan("");
  const auto strains = [&](const auto& of) {
    return [&none, of](const M* m, int n) {
      return m && m->gradient ? of(strainOf(*m->gradient), n) : none;
    };
  };
  py::dict dict;
  dict["id"] = column<int32_t>(grains, [](const G& g) { return g.grain; });
  dict["fate"] = texts(grains, [](const G& g) { return toString(g.fate); });
  dict["track"] = column<int32_t>(grains, [](const G& g) { return g.track; });
  dict["voxels"] = column<int64_t>(grains, [](const G& g) { return g.voxels; });
  dict["partner"] = column<int32_t>(grains, [](const G& g) { return g.partner; });
  dict["confidence"] = column<double>(moves, [&](const M* m) { return m ? m->confidence : none; });
  dict["miss"] = column<double>(moves, [&](const M* m) { return m ? m->miss : none; });
  dict["displacement"] =
      numbers<3>(moves, {3}, [&](const M* m, int n) { return m ? m->displacement[2 - n] : none; });
  dict["cut"] = column<bool>(moves, [](const M* m) { return m && m->isCut; });
  dict["neighbors"] = column<int64_t>(moves, [](const M* m) { return m ? m->neighbors : 0; });
  dict["gradient"] = numbers<9>(moves, {3, 3}, [&](const M* m, int n) {
    return m && m->gradient ? (*m->gradient)(2 - n / 3, 2 - n % 3) : none;
  });
  dict["strain_volumetric"] =
      numbers<1>(moves, {}, strains([](const Strain& s, int) { return s.volumetric; }));
  dict["strain_deviatoric"] =
      numbers<1>(moves, {}, strains([](const Strain& s, int) { return s.deviatoric; }));
  dict["rotation"] =
      numbers<3>(moves, {3}, strains([](const Strain& s, int n) { return s.turn[2 - n]; }));
  return dict;
}

using Rows = std::array<std::array<double, 4>, 3>;  ///< z, y, x; each z, y, x and the shift

Motion toMotion(const Rows& rows) {
  Motion motion;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      motion.linear(2 - row, 2 - column) = rows[size_t(row)][size_t(column)];
    motion.shift[2 - row] = rows[size_t(row)][3];
  }
  return motion;
}

py::object toRows(const std::optional<Motion>& motion) {
  if (!motion) return py::none();
  std::vector<double> rows;
  for (int row = 2; row >= 0; --row) {
    for (int column = 2; column >= 0; --column) rows.push_back(motion->linear(row, column));
    rows.push_back(motion->shift[row]);
  }
  return toArray(std::move(rows)).reshape({3, 4});
}

MatchOptions toOptions(const std::string& kind, const std::optional<Rows>& guess) {
  if (const auto known = motionKindOf(kind))
    return {*known, guess ? std::optional(toMotion(*guess)) : std::nullopt};
  throw InvalidInput("motion is 'rigid', 'affine', 'free' or an array of 3 x 4 numbers, not '" +
                     kind + "'");
}

py::dict trackGrains(const GridPtr& before, const GridPtr& after, const Call& call,
                     const std::optional<Index>& shift, int maxShift, double share,
                     int64_t minFaces, const std::optional<std::string>& motion,
                     const std::optional<Rows>& guess, int gap, int64_t sureFaces) {
  TrackOptions options;
  if (shift) options.shift = toCoord(*shift);
  options.maxShift = maxShift;
  options.share = share;
  options.minFaces = minFaces;
  options.gap = gap;
  options.sureFaces = sureFaces;
  if (motion) options.motion = toOptions(*motion, guess);
  const Int32Grid &first = asLabels(*before), &second = asLabels(*after);
  const PairNames names{"before", "after"};
  checkSameVoxels(first, second, names);
  Int32Grid::Ptr labels;
  const Tracks tracks = withoutLock(call, [&](Interrupter* interrupter) {
    Tracks found = track(first, second, options, interrupter);
    checkAnyCommon(found, names);
    labels = trackedLabels(second, found, interrupter);
    return found;
  });
  py::dict dict;
  dict["labels"] = GridPtr(labels);
  dict["motion"] = toRows(tracks.whole);
  if (tracks.motion)
    dict["shift"] = py::none();
  else
    dict["shift"] = triple(toIndex(tracks.shift));
  dict["voxels_before"] = tracks.voxelsBefore;
  dict["voxels_after"] = tracks.voxelsAfter;
  dict["common_voxels"] = tracks.commonVoxels;
  dict["before"] = tracks.motion ? toDict(tracks.before, tracks) : toDict(tracks.before);
  dict["after"] = tracks.motion ? toDict(tracks.after, tracks) : toDict(tracks.after);
  dict["overlaps"] = toDict(tracks.overlaps);
  dict["bonds_before"] = toDict(tracks.bondsBefore);
  dict["bonds_after"] = toDict(tracks.bondsAfter);
  dict["notes"] = notesOn(tracks, first, second, options, names);
  return dict;
}

py::dict toDict(const EvolvedStep& step) {
  using G = EvolvedGrain;
  using B = EvolvedBond;
  std::vector<double> centers;
  for (const G& grain : step.grains)
    for (int axis = 2; axis >= 0; --axis) centers.push_back(grain.center[axis]);
  py::dict grains, bonds, dict;
  grains["id"] = column<int32_t>(step.grains, [](const G& g) { return g.grain; });
  grains["fate"] = texts(step.grains, [](const G& g) { return toString(g.fate); });
  grains["voxels"] = column<int64_t>(step.grains, [](const G& g) { return g.voxels; });
  grains["center"] = toArray(std::move(centers))
                         .reshape(std::vector<py::ssize_t>{py::ssize_t(step.grains.size()), 3});
  bonds["first"] = column<int32_t>(step.bonds, [](const B& b) { return b.first; });
  bonds["second"] = column<int32_t>(step.bonds, [](const B& b) { return b.second; });
  bonds["fate"] = texts(step.bonds, [](const B& b) { return toString(b.fate); });
  bonds["faces"] = column<int64_t>(step.bonds, [](const B& b) { return b.faces; });
  dict["labels"] = GridPtr(step.labels);
  dict["motion"] = toRows(step.motion);
  dict["grains"] = grains;
  dict["bonds"] = bonds;
  return dict;
}

py::list evolve(const GridPtr& labels, const Call& call, int steps, uint64_t seed, double strain,
                double shear, double turn, const std::array<double, 3>& axis,
                const std::array<double, 3>& drift, bool rigidGrains, double vanish, double enter,
                double breaks, int gap, double growth, double noise) {
  EvolveOptions options;
  options.steps = steps;
  options.seed = seed;
  options.strain = strain;
  options.shear = shear;
  options.degrees = turn;
  options.axis = {axis[2], axis[1], axis[0]};
  options.drift = {drift[2], drift[1], drift[0]};
  options.rigidGrains = rigidGrains;
  options.vanish = vanish;
  options.enter = enter;
  options.breaks = breaks;
  options.gap = gap;
  options.growth = growth;
  options.noise = noise;
  const auto made = withoutLock(call, [&](Interrupter* interrupter) {
    std::vector<EvolvedStep> all;
    const Evolution evolution(asLabels(*labels), options, interrupter);
    for (int step = 0; step <= steps; ++step) all.push_back(evolution.after(step, interrupter));
    return all;
  });
  py::list list;
  for (const EvolvedStep& step : made) list.append(toDict(step));
  return list;
}

}  // namespace

void bindTracks(py::module_& m) {
  m.def("track", trackGrains, py::arg("before"), py::arg("after"), py::arg("call"), py::kw_only(),
        py::arg("shift"), py::arg("max_shift"), py::arg("share"), py::arg("min_faces"),
        py::arg("motion"), py::arg("guess"), py::arg("gap"), py::arg("sure_faces"));
  m.def("evolve", evolve, py::arg("labels"), py::arg("call"), py::kw_only(), py::arg("steps"),
        py::arg("seed"), py::arg("strain"), py::arg("shear"), py::arg("turn"), py::arg("axis"),
        py::arg("drift"), py::arg("rigid_grains"), py::arg("vanish"), py::arg("enter"),
        py::arg("breaks"), py::arg("gap"), py::arg("growth"), py::arg("noise"));
}

}  // namespace vdb_madf::python
