// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/palabos_file.h"

#include <openvdb/tools/Dense.h>

#include <algorithm>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"

namespace vdb_madf {

namespace {

constexpr int kSlices = 8;  // across x, that are written together

/// Does no fluid flow there? z fastest, as in the file.
using Slices = openvdb::tools::Dense<bool, openvdb::tools::LayoutZYX>;

enum Cell : char { fluid = '0', wall = '1', inside = '2' };

/// The grains, and what lies outside of a region: fluid would flow around the core there.
MaskGrid::Ptr solidOf(const Int32Grid& labels, const CoordBBox& box) {
  const MaskGrid::Ptr solid = objectMask(labels);
  const auto domain = storedDomain(labels);
  if (!domain || domain->isBox()) return solid;
  MaskTree outside;
  outside.denseFill(box, true, true);  // (A union activates tiles, but leaves their values.)
  outside.topologyDifference(*domain->region());
  solid->tree().topologyUnion(outside);
  return solid;
}

/// \p slices have the neighbors of p, as far as they lie in the box.
Cell cellOf(const Slices& slices, const CoordBBox& box, const Coord& p) {
  if (!slices.getValue(p)) return fluid;
  for (const int dx : {-1, 0, 1})
    for (const int dy : {-1, 0, 1})
      for (const int dz : {-1, 0, 1}) {
        const Coord q = p.offsetBy(dx, dy, dz);
        if (!box.isInside(q) || !slices.getValue(q)) return wall;
      }
  return inside;
}

}  // namespace

void writePalabos(const std::string& path, const Int32Grid& labels, const CoordBBox& box,
                  Interrupter* interrupter) {
  if (box.empty()) throw InvalidInput(path + ": there is no box to write");
  const MaskGrid::Ptr solid = solidOf(labels, box);
  detail::OutputStream out(path, interrupter);
  for (int begin = box.min().x(); begin <= box.max().x(); begin += kSlices) {
    const int end = std::min(begin + kSlices, box.max().x() + 1);
    CoordBBox around = box;
    around.min().x() = std::max(begin - 1, box.min().x());
    around.max().x() = std::min(end, box.max().x());
    Slices slices(around);
    openvdb::tools::copyToDense(*solid, slices);
    Coord p;
    for (p.x() = begin; p.x() < end; ++p.x())
      for (p.y() = box.min().y(); p.y() <= box.max().y(); ++p.y()) {
        for (p.z() = box.min().z(); p.z() <= box.max().z(); ++p.z()) {
          out.value(char(cellOf(slices, box, p)));
          out.value(p.z() == box.max().z() ? '\n' : ' ');
        }
      }
  }
  out.commit();
}

}  // namespace vdb_madf
