// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/scans/scan_region.h"

namespace vdb_madf::tools {

// Strict: the whole text must be what is asked for. Each function throws a WrongUsage that names
// the option.

/// Finite.
double parseNumber(const std::string& text, const std::string& option);
/// What `--ice` or `--density` says, in kg/m3. @throw WrongUsage for both, and for one under 10,
/// which no material has that grains are made of (0.917 is in g/cm3)
std::optional<double> parseDensity(bool ice, const std::string& density);
/// "301x301x251", each from 1 to kMaxImageSide.
Coord parseDims(const std::string& text, const std::string& option);
/// "x0,y0,z0:x1,y1,z1", both corners inclusive.
CoordBBox parseBox(const std::string& text, const std::string& option);
/// "x,y,z" in whole voxels, within +-kMaxExtent.
Coord parseShift(const std::string& text, const std::string& option);
/// --roi: "cylinder", "cylinder:z:CX,CY:RADIUS" with as many parts as one likes, or a file.
RegionOptions parseRoi(const std::string& text);
/// --voxel-size and others: as voxelSizeFromText().
VoxelSize parseVoxelSize(const std::string& text, const std::string& option = "--voxel-size");
/// A whole number >= 0.
int64_t parseCount(const std::string& text, const std::string& option);
/// "3,17,25": numbers of grains; none for an empty text.
std::vector<int32_t> parseGrains(const std::string& text, const std::string& option);
/// --max-memory: as bytesFromText().
int64_t parseMemory(const std::string& text);

/// "auto", "open" or "closed"; does not throw.
Boundary parseBoundary(const std::string& text);
/// The parts between separators, also empty ones; at least one.
std::vector<std::string> split(const std::string& text, char separator);

}  // namespace vdb_madf::tools
