// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <openvdb/tools/Dense.h>

#include <cmath>
#include <variant>

#include "bindings.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/voxel_weights.h"

namespace vdb_madf::python {

namespace {

template <typename Grid>
const Grid& as(const openvdb::GridBase& grid, const char* what) {
  if (!grid.isType<Grid>())
    throw InvalidInput("a grid of " + grid.valueType() + " values is no " + what);
  return static_cast<const Grid&>(grid);
}

/// Sets what is inactive in the labels to 0, as their readers have it: OpenVDB copies what is
/// stored there. (vdb_madf::copyToDense() does not, but looks at all leaf nodes, also for a slice.)
template <typename Dense>
void dropInactive(const Int32Grid& grid, Dense& dense) {
  const auto accessor = grid.getConstAccessor();
  const CoordBBox& box = dense.bbox();
  const Coord begin = box.min() & ~7;
  Coord origin;
  for (origin.x() = begin.x(); origin.x() <= box.max().x(); origin.x() += 8)
    for (origin.y() = begin.y(); origin.y() <= box.max().y(); origin.y() += 8)
      for (origin.z() = begin.z(); origin.z() <= box.max().z(); origin.z() += 8) {
        if (const auto* const leaf = accessor.probeConstLeaf(origin)) {
          for (auto off = leaf->cbeginValueOff(); off; ++off)
            if (*off && box.isInside(off.getCoord())) dense.setValue(off.getCoord(), 0);
        } else if (accessor.getValue(origin) && !accessor.isValueOn(origin)) {
          CoordBBox block = CoordBBox::createCube(origin, 8);
          block.intersect(box);
          for (auto p = block.begin(); p; ++p) dense.setValue(*p, 0);
        }
      }
}

/// The values of a box of the array that the grid shows, whose size is that of `out`.
template <typename T, typename Grid>
void read(const Grid& grid, const Index& first, py::array_t<T, py::array::c_style>& out) {
  const Coord lower = shownBox(grid).min() + toCoord(first);
  const Coord size(int(out.shape(2)), int(out.shape(1)), int(out.shape(0)));
  T* const values = out.mutable_data();
  const py::gil_scoped_release release;
  openvdb::tools::Dense<T, openvdb::tools::LayoutXYZ> dense(
      CoordBBox(lower, lower + size.offsetBy(-1)), values);
  openvdb::tools::copyToDense(grid, dense);
  if constexpr (std::is_same_v<Grid, Int32Grid>) dropInactive(grid, dense);
}

template <typename T>
py::object asPython(const T& plain) {
  return py::cast(plain);
}

/// Names of files need not be UTF-8.
py::object asPython(const std::string& text) {
  return py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), py::ssize_t(text.size()), "replace"));
}

/// But for what OpenVDB notes on the file.
py::dict metadataOf(const openvdb::GridBase& grid) {
  py::dict metadata;
  for (auto item = grid.beginMeta(); item != grid.endMeta(); ++item)
    if (const auto value = plainValue(*item->second); value && item->first.rfind("file_", 0) != 0)
      metadata[py::str(item->first)] =
          std::visit([](const auto& plain) { return asPython(plain); }, *value);
  return metadata;
}

py::object voxelSizeOf(const openvdb::GridBase& grid) {
  const auto size = storedVoxelSize(grid);
  return size ? py::object(triple(reversed(size->edges()))) : py::none();
}

/// Places in the world: of the first voxel of the array, and from voxel to voxel.
py::tuple originOf(const openvdb::GridBase& grid) {
  return triple(reversed(grid.indexToWorld(shownBox(grid).min())));
}

py::tuple spacingOf(const openvdb::GridBase& grid) {
  return triple(reversed(grid.voxelSize()));
}

/// The square in the world of a squared length of 1 in the units of the weights.
double squaredUnit(const openvdb::GridBase& grid) {
  return std::pow(grid.voxelSize().z(), 2) / storedWeights(grid).z;
}

int64_t domainVoxels(const openvdb::GridBase& grid) {
  const auto domain = storedDomain(grid);
  return domain ? int64_t(domain->voxelCount()) : int64_t(shownBox(grid).volume());
}

}  // namespace

const MaskGrid& asMask(const openvdb::GridBase& grid) {
  return as<MaskGrid>(grid, "mask");
}

const Int32Grid& asLabels(const openvdb::GridBase& grid) {
  return as<Int32Grid>(grid, "grid of labels");
}

CoordBBox shownBox(const openvdb::GridBase& grid) {
  const CoordBBox box = boxOf(grid);
  return box.empty() ? CoordBBox(Coord(0), Coord(-1)) : box;
}

void bindGrids(py::module_& m) {
  using Base = openvdb::GridBase;
  py::class_<Base, Base::Ptr>(m, "Grid", py::module_local(), "A mask or labels, sparse.")
      .def_property_readonly("name", &Base::getName)
      .def_property_readonly("first",
                             [](const Base& g) { return triple(toIndex(shownBox(g).min())); })
      .def_property_readonly("shape",
                             [](const Base& g) { return triple(toIndex(shownBox(g).dim())); })
      .def_property_readonly("voxel_size", voxelSizeOf)
      .def_property_readonly("unit",
                             [](const Base& g) {
                               const auto size = storedVoxelSize(g);
                               return size ? size->unit() : std::string("voxel");
                             })
      .def_property_readonly("origin", originOf)
      .def_property_readonly("spacing", spacingOf)
      .def_property_readonly("squared_unit", squaredUnit)
      .def_property_readonly("metadata", metadataOf)
      .def_property_readonly("active_voxels", &Base::activeVoxelCount)
      .def_property_readonly("domain_voxels", domainVoxels)
      .def_property_readonly("memory", &Base::memUsage)
      .def(
          "read_labels",
          [](const Base& g, const Index& first, py::array_t<int32_t, py::array::c_style> out) {
            read(asLabels(g), first, out);
          },
          py::arg("first"), py::arg("out").noconvert())
      .def(
          "read_mask",
          [](const Base& g, const Index& first, py::array_t<bool, py::array::c_style> out) {
            read(asMask(g), first, out);
          },
          py::arg("first"), py::arg("out").noconvert());
}

}  // namespace vdb_madf::python
