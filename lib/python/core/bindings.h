// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "call.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/method/boundary.h"

// Python counts [z, y, x], the library (x, y, z): what is turned is turned here.

namespace vdb_madf::python {

using GridPtr = openvdb::GridBase::Ptr;
using Index = std::array<int, 3>;  ///< z, y, x

inline Coord toCoord(const Index& zyx) {
  return {zyx[2], zyx[1], zyx[0]};
}
inline Index toIndex(const Coord& xyz) {
  return {xyz.z(), xyz.y(), xyz.x()};
}
template <typename Vector>
std::array<double, 3> reversed(const Vector& xyz) {
  return {xyz[2], xyz[1], xyz[0]};
}
template <typename Vector>
py::tuple triple(const Vector& zyx) {
  return py::make_tuple(zyx[0], zyx[1], zyx[2]);
}

/// @throw InvalidInput if the grid is of another type
const MaskGrid& asMask(const openvdb::GridBase& grid);
const Int32Grid& asLabels(const openvdb::GridBase& grid);

/// The voxels that an array of the grid shows: its domain, or the box of its active voxels.
CoordBBox shownBox(const openvdb::GridBase& grid);

/// What texts name. @throw InvalidInput that says what there is
Boundary boundaryOf(const std::string& name);  ///< "auto", "open", "closed"
SampleType sampleTypeOf(const std::string& name);

/// An array that owns the vector.
template <typename T>
py::array_t<T> toArray(std::vector<T> values) {
  auto owned = std::make_unique<std::vector<T>>(std::move(values));
  const py::capsule owner(owned.get(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
  const std::vector<T>& data = *owned.release();
  return py::array_t<T>(py::ssize_t(data.size()), data.data(), owner);
}

/// An array of number(item) for the items of a list.
template <typename T, typename Items, typename Number>
py::array_t<T> column(const Items& items, const Number& number) {
  py::array_t<T> array{py::ssize_t(items.size())};
  T* to = array.mutable_data();
  for (const auto& item : items) *to++ = T(number(item));
  return array;
}

// What each source adds to the module.
void bindGrids(py::module_& m);
void bindVolumes(py::module_& m);
void bindMethod(py::module_& m);
void bindMeasures(py::module_& m);
void bindLabels(py::module_& m);
void bindTracks(py::module_& m);
void bindFiles(py::module_& m);
void bindSamples(py::module_& m);

}  // namespace vdb_madf::python
