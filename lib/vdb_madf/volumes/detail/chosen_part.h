// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <optional>
#include <string>

#include "vdb_madf/scans/detail/cylinder_axis.h"
#include "vdb_madf/volumes/volume.h"

namespace vdb_madf::detail {

/// What is known of a scan before its region is chosen.
struct ScanExtent {
  std::optional<Domain> domain;
  CoordBBox box;  ///< where the domain is unknown: of its voxels
  /// As farthestFromAxis().
  std::function<double(const CylinderAxis&)> farthestFromAxis;
};

/// The part of the scan in the file at `path` that the options choose. Says what was fitted.
/// @throw InvalidInput that names the file if there is none, a mask does not cover the scan, or a
///   radius cannot be fitted; as loadObject() for a mask.
ScanPart chosenPart(const std::string& path, const VolumeOptions& options, const ScanExtent& extent,
                    Interrupter* interrupter);

}  // namespace vdb_madf::detail
