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

inline hid_t newHdf5(const std::string& path) {
  return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
}

}  // namespace vdb_madf::test
