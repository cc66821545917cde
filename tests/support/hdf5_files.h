// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <hdf5.h>

#include <string>
#include <vector>

#include "support/images.h"

// HDF5 files, written by its library.

namespace vdb_madf::test {

struct Hdf5Layout {
  std::vector<hsize_t> shape;  ///< z, y, x
  std::vector<hsize_t> chunk;  ///< empty: contiguous
  hid_t type = -1;             ///< in the file
  hid_t memory = -1;           ///< of the samples
  int deflate = 0;
  std::vector<double> elementSize;
};

/// Adds a dataset, and the groups on its way, to a file, which is made if it is new.
inline void addHdf5(hid_t file, const std::string& name, const Hdf5Layout& layout,
                    const void* samples) {
  const hid_t space = H5Screate_simple(int(layout.shape.size()), layout.shape.data(), nullptr);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE), links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  if (!layout.chunk.empty()) H5Pset_chunk(creation, int(layout.chunk.size()), layout.chunk.data());
  if (layout.deflate) H5Pset_deflate(creation, unsigned(layout.deflate));
  const hid_t dataset =
      H5Dcreate2(file, name.c_str(), layout.type, space, links, creation, H5P_DEFAULT);
  if (samples) H5Dwrite(dataset, layout.memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, samples);
  if (!layout.elementSize.empty()) {
    const hsize_t count = layout.elementSize.size();
    const hid_t points = H5Screate_simple(1, &count, nullptr);
    const hid_t attribute =
        H5Acreate2(dataset, "element_size_um", H5T_IEEE_F64LE, points, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, layout.elementSize.data());
    H5Aclose(attribute);
    H5Sclose(points);
  }
  H5Dclose(dataset);
  H5Pclose(links);
  H5Pclose(creation);
  H5Sclose(space);
}

/// A number with the attribute `units`, unless that is empty.
inline void addHdf5Length(hid_t file, const std::string& name, double value,
                          const std::string& unit) {
  const hid_t space = H5Screate(H5S_SCALAR), text = H5Tcopy(H5T_C_S1);
  const hid_t dataset =
      H5Dcreate2(file, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value);
  if (!unit.empty()) {
    H5Tset_size(text, unit.size());
    const hid_t attribute = H5Acreate2(dataset, "units", text, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, text, unit.data());
    H5Aclose(attribute);
  }
  H5Dclose(dataset);
  H5Tclose(text);
  H5Sclose(space);
}

/// Slices [first, first + count) of a virtual dataset are the dataset "d" of a file.
struct VirtualHdf5Part {
  std::string file;
  hsize_t first, count;
};

/// Adds a virtual dataset of uint8.
inline void addVirtualHdf5(hid_t file, const std::string& name, const std::vector<hsize_t>& shape,
                           const std::vector<VirtualHdf5Part>& parts) {
  const hid_t space = H5Screate_simple(3, shape.data(), nullptr),
              creation = H5Pcreate(H5P_DATASET_CREATE);
  for (const VirtualHdf5Part& part : parts) {
    const hsize_t begin[] = {part.first, 0, 0}, size[] = {part.count, shape[1], shape[2]};
    const hid_t from = H5Screate_simple(3, size, nullptr);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, begin, nullptr, size, nullptr);
    H5Pset_virtual(creation, space, part.file.c_str(), "d", from);
    H5Sclose(from);
  }
  H5Sselect_all(space);
  H5Dclose(H5Dcreate2(file, name.c_str(), H5T_STD_U8LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
  H5Pclose(creation);
  H5Sclose(space);
}

/// Adds a dataset of uint8 with the samples in a raw file.
inline void addHdf5External(hid_t file, const std::string& name, const std::vector<hsize_t>& shape,
                            const std::string& samples) {
  const hid_t space = H5Screate_simple(int(shape.size()), shape.data(), nullptr),
              creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(creation, samples.c_str(), 0, H5F_UNLIMITED);
  H5Dclose(H5Dcreate2(file, name.c_str(), H5T_STD_U8LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
  H5Pclose(creation);
  H5Sclose(space);
}

inline hid_t newHdf5(const std::string& path) {
  return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
}

}  // namespace vdb_madf::test
