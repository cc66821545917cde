// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "bindings.h"
#include "mesh_options.h"
#include "vdb_madf/edits/edit_labels.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/labels/label_digest.h"
#include "vdb_madf/labels/label_sizes.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/labels/select_grains.h"
#include "vdb_madf/shapes/grain_mesh.h"
#include "vdb_madf/shapes/world_points.h"

namespace vdb_madf::python {

namespace {

/// Labels above 0, ascending, with their numbers of voxels.
py::tuple labelSizes(const GridPtr& labels, const Call& call) {
  const auto voxels = withoutLock(call, [&](Interrupter* interrupter) {
    return vdb_madf::labelSizes(asLabels(*labels), interrupter);
  });
  return py::make_tuple(column<int32_t>(voxels, [](const auto& item) { return item.first; }),
                        column<int64_t>(voxels, [](const auto& item) { return item.second; }));
}

/// The box of the voxels with a label, as in the array of the grid: first and last.
py::tuple boxOfLabel(const GridPtr& labels, int32_t label) {
  const Int32Grid& grid = asLabels(*labels);
  const Coord lower = shownBox(grid).min();
  CoordBBox box;
  {
    const py::gil_scoped_release release;
    box = selectGrains(grid, {label})->evalActiveVoxelBoundingBox();
  }
  return py::make_tuple(triple(toIndex(box.min() - lower)), triple(toIndex(box.max() - lower)));
}

GridPtr selected(const GridPtr& labels, const std::vector<int32_t>& ids, const Call& call) {
  return withoutLock(call, [&](Interrupter* interrupter) -> GridPtr {
    return selectGrains(asLabels(*labels), ids, interrupter);
  });
}

GridPtr reduce(const GridPtr& labels, int factor, const Call& call) {
  return withoutLock(call, [&](Interrupter* interrupter) -> GridPtr {
    return reduceLabels(asLabels(*labels), factor, interrupter);
  });
}

/// @param edits a line an edit
GridPtr edit(const GridPtr& labels, const std::string& edits,
             const std::optional<GridPtr>& manifold, const Call& call) {
  const Int32Grid* manifolds = manifold ? &asLabels(**manifold) : nullptr;
  return withoutLock(call, [&](Interrupter* interrupter) -> GridPtr {
    return editLabels(asLabels(*labels), parseEdits(edits), manifolds, interrupter).labels;
  });
}

std::string digest(const GridPtr& labels, const Call& call) {
  return withoutLock(
      call, [&](Interrupter* interrupter) { return labelDigest(asLabels(*labels), interrupter); });
}

py::tuple colors(const GridPtr& labels, const Call& call) {
  GrainColors found = withoutLock(
      call, [&](Interrupter* interrupter) { return grainColors(asLabels(*labels), interrupter); });
  py::array_t<uint8_t> rgb({py::ssize_t(found.colors.size()), py::ssize_t(3)});
  uint8_t* to = rgb.mutable_data();
  for (const Rgb& color : found.colors)
    for (const uint8_t channel : color) *to++ = channel;
  return py::make_tuple(toArray(std::move(found.labels)), rgb);
}

/// The arrays show the mesh's own memory, which lives as long as one of them.
py::dict toDict(GrainMesh mesh) {
  auto owned = std::make_unique<GrainMesh>(std::move(mesh));
  const py::capsule owner(owned.get(), [](void* p) { delete static_cast<GrainMesh*>(p); });
  const GrainMesh& m = *owned.release();
  const auto list = [&](const auto& vector) {
    using T = std::decay_t<decltype(vector[0])>;
    return py::array_t<T>(py::ssize_t(vector.size()), vector.data(), owner);
  };
  const auto triples = [&](const auto& vector, auto number) {
    using T = decltype(number);
    static_assert(sizeof(vector[0]) == 3 * sizeof(T));
    return py::array_t<T>({py::ssize_t(vector.size()), py::ssize_t(3)},
                          reinterpret_cast<const T*>(vector.data()), owner);
  };
  py::dict dict;
  dict["ids"] = list(m.labels);
  dict["points"] = triples(m.points, float{});
  dict["triangles"] = triples(m.triangles, uint32_t{});
  dict["point_offsets"] = list(m.firstPoint);
  dict["triangle_offsets"] = list(m.firstTriangle);
  return dict;
}

py::dict mesh(const GridPtr& labels, const Call& call, int smoothing,
              const std::optional<int64_t>& triangles,
              const std::optional<std::vector<int32_t>>& ids) {
  return toDict(withoutLock(call, [&](Interrupter* interrupter) {
    const GrainMeshOptions options = meshOptions(smoothing, triangles);
    Int32Grid::ConstPtr grid = openvdb::gridConstPtrCast<Int32Grid>(labels);
    asLabels(*labels);
    if (ids) grid = selectGrains(*grid, *ids, interrupter);
    GrainMesh made = grainMesh(*grid, options, interrupter);
    made.points = worldPoints(made, grid->transform());
    return made;
  }));
}

}  // namespace

void bindLabels(py::module_& m) {
  m.def("label_sizes", labelSizes, py::arg("labels"), py::arg("call"));
  m.def("box_of_label", boxOfLabel, py::arg("labels"), py::arg("label"));
  m.def("select", selected, py::arg("labels"), py::arg("ids"), py::arg("call"));
  m.def("reduce", reduce, py::arg("labels"), py::arg("factor"), py::arg("call"));
  m.def("edit", edit, py::arg("labels"), py::arg("edits"), py::arg("manifold"), py::arg("call"));
  m.def("digest", digest, py::arg("labels"), py::arg("call"));
  m.def("colors", colors, py::arg("labels"), py::arg("call"));
  m.def("mesh", mesh, py::arg("labels"), py::arg("call"), py::kw_only(), py::arg("smoothing"),
        py::arg("triangles"), py::arg("ids"));
}

}  // namespace vdb_madf::python
