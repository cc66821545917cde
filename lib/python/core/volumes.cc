// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <array>
#include <optional>

#include "array_source.h"
#include "bindings.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/volumes/load_labels.h"
#include "vdb_madf/volumes/load_object.h"

namespace vdb_madf::python {

namespace {

void select(VolumeOptions& options, const Selection& selection) {
  const bool invert = options.selection && options.selection->invert;
  options.selection = selection;
  options.selection->invert = invert;
}

void selectAutomatically(VolumeOptions& options, const std::string& method) {
  if (method == "otsu")
    options.gray.automatic = AutomaticThreshold::otsu;
  else if (method == "valley")
    options.gray.automatic = AutomaticThreshold::valley;
  else
    throw InvalidInput("threshold '" + method + "': must be a number, 'otsu' or 'valley'");
  select(options, Selection::threshold(0));  // to be replaced
}

void invert(VolumeOptions& options) {
  if (!options.selection) options.selection = Selection{};
  options.selection->invert = true;
}

/// The axis is that of the array.
void setCylinder(VolumeOptions& options, int axis,
                 const std::optional<std::array<double, 2>>& center,
                 const std::optional<double>& radius) {
  CylinderOptions cylinder;
  cylinder.axis = 2 - axis;
  if (center) cylinder.center = {(*center)[1], (*center)[0]};
  cylinder.radius = radius;
  options.region.cylinder = cylinder;
}

void bindOptions(py::module_& m) {
  using Box = std::pair<Index, Index>;
  const auto toBox = [](const Box& box) {
    return CoordBBox(toCoord(box.first), toCoord(box.second));
  };
  py::class_<VolumeOptions>(m, "VolumeOptions", "How a volume is read.")
      .def(py::init<>())
      .def_readwrite("grid", &VolumeOptions::grid)
      .def_readwrite("dataset", &VolumeOptions::dataset)
      .def("select_phases",
           [](VolumeOptions& o, const std::vector<double>& values) {
             select(o, Selection::phases(values));
           })
      .def("select_from",
           [](VolumeOptions& o, double value) { select(o, Selection::threshold(value)); })
      .def("select_hysteresis",
           [](VolumeOptions& o, double low, double high) {
             select(o, Selection::threshold(high));
             o.gray.low = low;
           })
      .def("select_automatically", selectAutomatically)
      .def("select_range", [](VolumeOptions& o, double low,
                              double high) { select(o, Selection::range(low, high)); })
      .def("invert", invert)
      .def("filter",
           [](VolumeOptions& o, int median, double smooth, int64_t despeckle) {
             o.gray.median = median;
             o.gray.smooth = smooth;
             o.gray.despeckle = despeckle;
           })
      .def("set_voxel_size",
           [](VolumeOptions& o, const std::array<double, 3>& meters) {
             o.voxelSize = VoxelSize(reversed(meters));
           })
      .def("set_domain", [=](VolumeOptions& o, const Box& box) { o.domain = toBox(box); })
      .def("set_crop", [=](VolumeOptions& o, const Box& box) { o.region.crop = toBox(box); })
      .def("set_region_file",
           [](VolumeOptions& o, const std::string& path) { o.region.mask = path; })
      .def("set_region",
           [](VolumeOptions& o, const GridPtr& mask) {
             o.region.grid = openvdb::gridConstPtrCast<MaskGrid>(mask);
           })
      .def("set_cylinder", setCylinder);
}

using Loaded = std::pair<GridPtr, std::vector<std::string>>;  // with notes

/// load(options, interrupter) with notes that are gathered, each once.
template <typename Load>
Loaded withNotes(VolumeOptions options, const Call& call, const Load& load) {
  std::vector<std::string> notes;
  options.note = [&notes](const std::string& said, NoteAbout about) {
    const std::string text = said + (about == NoteAbout::cylinder ? " (roi='cylinder')" : "");
    if (std::find(notes.begin(), notes.end(), text) == notes.end()) notes.push_back(text);
  };
  const GridPtr grid = withoutLock(
      call, [&](Interrupter* interrupter) -> GridPtr { return load(options, interrupter); });
  return {grid, notes};
}

template <typename Load>
Loaded loadMask(const std::string& name, const VolumeOptions& options, const Call& call,
                const Load& load) {
  Loaded loaded = withNotes(options, call, [&](const VolumeOptions& o, Interrupter* interrupter) {
    const auto mask = load(o, interrupter);
    if (o.domain) checkWithin(mask->evalActiveVoxelBoundingBox(), *o.domain);
    return mask;
  });
  if (options.selection && openvdb::gridConstPtrCast<MaskGrid>(loaded.first)->empty())
    loaded.second.push_back(name + ": nothing is selected (see phase, threshold, range, invert)");
  return loaded;
}

Loaded loadMaskFile(const std::string& path, const VolumeOptions& options, const Call& call) {
  return loadMask(path, options, call, [&](const VolumeOptions& o, Interrupter* interrupter) {
    return loadObject(path, o, interrupter);
  });
}

/// Labels of an image, as `vdb_madf convert --labels` names them.
Int32Grid::Ptr named(Int32Grid::Ptr labels) {
  if (labels->getName().empty()) labels->setName("grain");
  return labels;
}

Loaded loadLabelFile(const std::string& path, const VolumeOptions& options, const Call& call) {
  return withNotes(options, call, [&](const VolumeOptions& o, Interrupter* interrupter) {
    return named(loadLabels(path, o, interrupter));
  });
}

Loaded loadMaskArray(const ArraySource& source, const VolumeOptions& options, const Call& call) {
  return loadMask(
      source.name, options, call, [&](const VolumeOptions& o, Interrupter* interrupter) {
        return loadObject([&] { return std::make_unique<ArrayReader>(source); }, o, interrupter);
      });
}

Loaded loadLabelArray(const ArraySource& source, const VolumeOptions& options, const Call& call) {
  return withNotes(options, call, [&](const VolumeOptions& o, Interrupter* interrupter) {
    return named(loadLabels([&] { return std::make_unique<ArrayReader>(source); }, o, interrupter));
  });
}

}  // namespace

SampleType sampleTypeOf(const std::string& name) {
  const auto type = sampleTypeFromName(name);
  if (!type) throw InvalidInput("there is no sample type " + name);
  return *type;
}

void bindVolumes(py::module_& m) {
  bindOptions(m);
  py::class_<ArraySource>(m, "ArraySource", "An array that is read in slabs of slices.")
      .def(py::init([](const std::string& name, const Index& shape, const std::string& type,
                       const py::object& read, const std::optional<std::array<double, 3>>& voxel) {
             ArraySource source{name, {shape[2], shape[1], shape[0]}, sampleTypeOf(type), {}, read};
             if (voxel) source.voxelSize = VoxelSize({(*voxel)[2], (*voxel)[1], (*voxel)[0]});
             return source;
           }),
           py::arg("name"), py::arg("shape"), py::arg("type"), py::arg("read"),
           py::arg("voxel") = std::nullopt);
  m.def("load_mask", loadMaskFile, py::arg("source"), py::arg("options"), py::arg("call"));
  m.def("load_mask", loadMaskArray, py::arg("source"), py::arg("options"), py::arg("call"));
  m.def("load_labels", loadLabelFile, py::arg("source"), py::arg("options"), py::arg("call"));
  m.def("load_labels", loadLabelArray, py::arg("source"), py::arg("options"), py::arg("call"));
  m.def(
      "mask_of_labels",
      [](const GridPtr& labels) -> GridPtr {
        const py::gil_scoped_release release;
        const MaskGrid::Ptr mask = objectMask(*labels);
        mask->setName("object");
        return mask;
      },
      py::arg("labels"));
}

}  // namespace vdb_madf::python
