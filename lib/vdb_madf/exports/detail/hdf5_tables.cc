// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/hdf5_tables.h"

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/output_file.h"

#ifdef VDB_MADF_HDF5
#include <algorithm>
#include <cmath>
#include <limits>

#include "vdb_madf/files/detail/hdf5_output.h"
#endif

namespace vdb_madf::detail {

bool isHdf5Tables(const std::string& path) {
  const std::string ending = fileEnding(path);
  return ending == ".h5" || ending == ".hdf5";
}

#ifndef VDB_MADF_HDF5

void checkHdf5Tables(const std::string& path) {
  throw IoError(path +
                ": HDF5 cannot be written by this program: install libhdf5-dev, then configure and "
                "build it again");
}

void writeHdf5Tables(const std::string& path, const Hdf5Tables&) {
  checkHdf5Tables(path);
}

#else

namespace {

using Json = nlohmann::ordered_json;

/// The numbers of a list in lists, all of one length a level.
struct Numbers {
  std::vector<hsize_t> shape;
  std::vector<double> values;  ///< NaN: null
  std::vector<int64_t> whole;  ///< the same, if all are integers
  bool areWhole = true;

  /// False if there is something else in it.
  bool add(const Json& json, size_t depth = 0) {
    if (!json.is_array()) {
      if (depth != shape.size() || !(json.is_number() || json.is_null())) return false;
      areWhole = areWhole && json.is_number_integer();
      values.push_back(json.is_null() ? std::numeric_limits<double>::quiet_NaN()
                                      : json.get<double>());
      whole.push_back(areWhole ? json.get<int64_t>() : 0);
      return true;
    }
    if (depth == shape.size() && values.empty()) shape.push_back(json.size());
    return depth < shape.size() && json.size() == shape[depth] &&
           std::all_of(json.begin(), json.end(),
                       [&](const Json& item) { return add(item, depth + 1); });
  }
};

class TableWriter {
 public:
  explicit TableWriter(const std::string& path) : file_(path) {}

  void write(const Hdf5Tables& tables) {
    addTable("grains", tables.grains, tables);
    addTable("bonds", tables.bonds, tables);
    addMembers(file_.id(), "sample", tables.sample);
    file_.commit();
  }

 private:
  /// Its members are kept in the order in which they were written.
  Hdf5Handle group(hid_t parent, const std::string& name) const {
    const Hdf5Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    H5Pset_obj_track_times(creation, false);
    H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    return file_.checked(
        Hdf5Handle(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose));
  }

  /// @param shape none: a single value
  Hdf5Handle addValues(hid_t parent, const std::string& name, hid_t type, hid_t memory,
                       const std::vector<hsize_t>& shape, const void* values) const {
    const Hdf5Handle creation = timelessDataset();
    const Hdf5Handle space(shape.empty()
                               ? H5Screate(H5S_SCALAR)
                               : H5Screate_simple(int(shape.size()), shape.data(), nullptr),
                           H5Sclose);
    Hdf5Handle dataset = file_.checked(Hdf5Handle(
        H5Dcreate2(parent, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
        H5Dclose));
    const bool isEmpty = std::count(shape.begin(), shape.end(), hsize_t(0)) > 0;
    file_.check(isEmpty || H5Dwrite(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    return dataset;
  }

  Hdf5Handle addNumbers(hid_t parent, const std::string& name, const std::vector<hsize_t>& shape,
                        const std::vector<double>& values) const {
    return addValues(parent, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, shape, values.data());
  }
  Hdf5Handle addIntegers(hid_t parent, const std::string& name, const std::vector<hsize_t>& shape,
                         const std::vector<int64_t>& values) const {
    return addValues(parent, name, H5T_STD_I64LE, H5T_NATIVE_INT64, shape, values.data());
  }

  static Hdf5Handle textType(const std::string& text) {
    Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, std::max<size_t>(text.size(), 1));
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    H5Tset_cset(type, H5T_CSET_UTF8);
    return type;
  }

  void addTable(const std::string& name, const std::vector<MeasureColumn>& columns,
                const Hdf5Tables& tables) const {
    const Hdf5Handle table = group(file_.id(), name);
    for (const MeasureColumn& column : columns) {
      std::vector<double> values = column.values;
      const bool areKnown = std::none_of(values.begin(), values.end(),
                                         [](double value) { return std::isnan(value); });
      if (column.isWhole() && areKnown) {
        addIntegers(table, column.name, {values.size()}, {values.begin(), values.end()});
        continue;
      }
      for (double& value : values) value = scaled(column, value, tables.edges);
      const Hdf5Handle dataset = addNumbers(table, column.name, {values.size()}, values);
      if (column.power != 0) addUnit(dataset, unitText(column.power, tables.unit));
    }
  }

  static std::string unitText(int power, const std::string& unit) {
    const int size = std::abs(power);
    return (power < 0 ? "1/" : "") + unit + (size == 1 ? "" : "^" + std::to_string(size));
  }

  void addUnit(hid_t dataset, const std::string& text) const {
    const Hdf5Handle type = textType(text), space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Handle attribute = file_.checked(
        Hdf5Handle(H5Acreate2(dataset, "units", type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose));
    file_.check(H5Awrite(attribute, type, text.data()) >= 0);
  }

  void addMembers(hid_t parent, const std::string& name, const Json& json) const {
    const Hdf5Handle members = group(parent, name);
    for (const auto& [key, value] : json.items()) add(members, nameOf(key), value);
  }

  /// What a file of labels says may have any name; here a slash would be a group.
  static std::string nameOf(std::string key) {
    std::replace(key.begin(), key.end(), '/', '_');
    return key.empty() || key == "." ? "_" + key : key;
  }

  void add(hid_t parent, const std::string& name, const Json& json) const {
    Numbers numbers;
    if (json.is_object()) {
      addMembers(parent, name, json);
    } else if (numbers.add(json)) {
      if (numbers.areWhole)
        addIntegers(parent, name, numbers.shape, numbers.whole);
      else
        addNumbers(parent, name, numbers.shape, numbers.values);
    } else if (json.is_boolean()) {
      addIntegers(parent, name, {}, {json.get<bool>() ? 1 : 0});
    } else {
      const std::string text = json.is_string()
                                   ? json.get<std::string>()
                                   : json.dump(-1, ' ', false, Json::error_handler_t::replace);
      const Hdf5Handle type = textType(text);
      addValues(parent, name, type, type, {}, text.data());
    }
  }

  Hdf5Output file_;
};

}  // namespace

void checkHdf5Tables(const std::string& path) {
  removeLeftovers({path});
  const OutputFile probe(path);
}

void writeHdf5Tables(const std::string& path, const Hdf5Tables& tables) {
  const Hdf5Turn turn;
  TableWriter(path).write(tables);
}

#endif

}  // namespace vdb_madf::detail
