// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/hdf5_voxel_size.h"

#include <cstring>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/files/detail/hdf5_handle.h"
#include "vdb_madf/images/detail/header_checks.h"

namespace vdb_madf::detail {

namespace {

/// Longer texts name no unit.
constexpr size_t kMaxUnit = 64;

std::optional<VoxelSize> elementSize(const std::string& path, hid_t dataset) {
  const char* name = "element_size_um";
  if (H5Aexists(dataset, name) <= 0) return std::nullopt;
  const Hdf5Handle attribute(H5Aopen(dataset, name, H5P_DEFAULT), H5Aclose);
  const Hdf5Handle space(attribute ? H5Aget_space(attribute) : -1, H5Sclose);
  double edges[3] = {};
  if (!space || H5Sget_simple_extent_npoints(space) != 3 ||
      H5Aread(attribute, H5T_NATIVE_DOUBLE, edges) < 0)
    throw IoError(path + ": the attribute element_size_um cannot be read as three numbers");
  const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
  if (type && H5Tget_size(type) == sizeof(float) && !areEdgesOfCube({edges[0], edges[1], edges[2]}))
    for (double& edge : edges) edge = decimalOf(float(edge));  // the ratio of the edges counts
  return checkedVoxelSize(path, {edges[2], edges[1], edges[0]}, unitsPerMetre("um"));
}

/// A text of one piece, of fixed or variable length; else empty.
std::string textAttribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return "";
  const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Hdf5Handle space(attribute ? H5Aget_space(attribute) : -1, H5Sclose);
  const Hdf5Handle type(attribute ? H5Aget_type(attribute) : -1, H5Tclose);
  if (!space || !type || H5Sget_simple_extent_npoints(space) != 1 ||
      H5Tget_class(type) != H5T_STRING)
    return "";
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute, type, &text) < 0 || !text) return "";
    const std::string copy(text, strnlen(text, kMaxUnit));
    H5free_memory(text);
    return copy;
  }
  const size_t size = H5Tget_size(type);
  if (size == 0 || size > kMaxUnit) return "";
  std::string text(size, '\0');
  if (H5Aread(attribute, type, text.data()) < 0) return "";
  return trimmed(text.substr(0, text.find('\0')));
}

/// A number with a unit of length, in meters.
std::optional<double> length(const std::string& path, hid_t file, const std::string& name) {
  if (H5Lexists(file, name.c_str(), H5P_DEFAULT) <= 0) return std::nullopt;
  const Hdf5Handle dataset = openHdf5Dataset(file, name);
  const Hdf5Handle space(dataset ? H5Dget_space(dataset) : -1, H5Sclose);
  if (!space) return std::nullopt;
  const auto unit = unitsPerMetre(textAttribute(dataset, "units"));
  double value = 0;
  if (!unit || H5Sget_simple_extent_npoints(space) != 1) return std::nullopt;
  if (H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) < 0)
    throw IoError(path + ": " + inQuotes(name) + " cannot be read as a number");
  return value / *unit;
}

}  // namespace

std::vector<std::string> hdf5AxisNames(hid_t dataset) {
  const char* const name = "DIMENSION_LABELS";
  if (H5Aexists(dataset, name) <= 0) return {};
  const Hdf5Handle attribute(H5Aopen(dataset, name, H5P_DEFAULT), H5Aclose);
  const Hdf5Handle space(attribute ? H5Aget_space(attribute) : -1, H5Sclose);
  const Hdf5Handle type(attribute ? H5Aget_type(attribute) : -1, H5Tclose);
  const hssize_t count = space ? H5Sget_simple_extent_npoints(space) : 0;
  if (!type || count < 1 || count > H5S_MAX_RANK || H5Tis_variable_str(type) <= 0) return {};
  std::vector<char*> texts(size_t(count), nullptr);
  if (H5Aread(attribute, type, texts.data()) < 0) return {};
  std::vector<std::string> names;
  for (char* const text : texts) {
    names.emplace_back(text ? std::string(text, strnlen(text, kMaxUnit)) : std::string());
    H5free_memory(text);
  }
  return names;
}

std::optional<VoxelSize> hdf5VoxelSize(const std::string& path, hid_t file, hid_t dataset,
                                       const std::vector<std::string>& names) {
  if (const auto size = elementSize(path, dataset)) return size;
  for (const std::string& name : names) {
    const size_t slash = name.rfind('/');
    const std::string group = slash == std::string::npos ? "" : name.substr(0, slash + 1);
    const auto x = length(path, file, group + "x_pixel_size"),
               y = length(path, file, group + "y_pixel_size"),
               z = length(path, file, group + "z_pixel_size");
    if (x && y) return checkedVoxelSize(path, {*x, *y, z.value_or(*x)}, 1.0);
  }
  return std::nullopt;
}

}  // namespace vdb_madf::detail
