// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/detail/scan_fit.h"

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

std::string sizeAndPlace(const CoordBBox& box) {
  const Coord size = box.dim(), first = box.min();
  const auto join = [](const Coord& c, const std::string& with) {
    return std::to_string(c.x()) + with + std::to_string(c.y()) + with + std::to_string(c.z());
  };
  return join(size, "x") + " voxels" +
         (first == Coord(0) ? "" : " from " + join(first, ",") + " on");
}

}  // namespace

void checkScanBox(const std::string& path, const CoordBBox& scan, const SampleMeasures& sample) {
  if (!sample.domainKnown)
    throw InvalidInput(path +
                       ": the domain of the labels is unknown, so that nothing tells whether this "
                       "is their scan: give the domain");
  if (fitsScan(sample, scan)) return;
  throw InvalidInput(path + ": has " + sizeAndPlace(scan) +
                     ", and the labels are those of a scan of " + sizeAndPlace(sample.box) +
                     ": give the one that they were made of, cropped as they were");
}

}  // namespace vdb_madf::detail
