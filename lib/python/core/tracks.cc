// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "bindings.h"
#include "vdb_madf/matching/pair_checks.h"
#include "vdb_madf/matching/track.h"

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

py::dict trackGrains(const GridPtr& before, const GridPtr& after, const Call& call,
                     const std::optional<Index>& shift, int maxShift, double share,
                     int64_t minFaces) {
  TrackOptions options;
  if (shift) options.shift = toCoord(*shift);
  options.maxShift = maxShift;
  options.share = share;
  options.minFaces = minFaces;
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
  dict["shift"] = triple(toIndex(tracks.shift));
  dict["voxels_before"] = tracks.voxelsBefore;
  dict["voxels_after"] = tracks.voxelsAfter;
  dict["common_voxels"] = tracks.commonVoxels;
  dict["before"] = toDict(tracks.before);
  dict["after"] = toDict(tracks.after);
  dict["overlaps"] = toDict(tracks.overlaps);
  dict["bonds_before"] = toDict(tracks.bondsBefore);
  dict["bonds_after"] = toDict(tracks.bondsAfter);
  dict["notes"] = notesOn(tracks, first, second, options, names);
  return dict;
}

}  // namespace

void bindTracks(py::module_& m) {
  m.def("track", trackGrains, py::arg("before"), py::arg("after"), py::arg("call"), py::kw_only(),
        py::arg("shift"), py::arg("max_shift"), py::arg("share"), py::arg("min_faces"));
}

}  // namespace vdb_madf::python
