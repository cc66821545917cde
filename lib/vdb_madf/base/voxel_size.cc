// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/voxel_size.h"

namespace vdb_madf {

namespace {

/// Below this edge, millimetres would make a voxel volume that OpenVDB's transforms refuse.
constexpr double kMinMetresInMillimetres = 20e-9;

}  // namespace

std::string VoxelSize::unit() const {
  return metres < kMinMetresInMillimetres ? "um" : "mm";
}

double VoxelSize::inUnit() const {
  return metres * (metres < kMinMetresInMillimetres ? 1e6 : 1e3);
}

}  // namespace vdb_madf
