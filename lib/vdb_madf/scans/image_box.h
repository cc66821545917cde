// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// Voxels along each axis, as grids and as images write it.
inline Coord toCoord(const ImageSize& size) {
  return {size.x, size.y, size.z};
}
inline ImageSize toImageSize(const Coord& size) {
  return {size.x(), size.y(), size.z()};
}

/// The domain of an image: [0, size - 1].
inline CoordBBox imageBox(const ImageSize& size) {
  return {Coord(0), toCoord(size).offsetBy(-1)};
}

}  // namespace vdb_madf
