// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/domain.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/intensity/gray_scan.h"
#include "vdb_madf/measure/scan_blur.h"

namespace vdb_madf {

/// What the edges of a gray scan say of its blur and noise: of the middle of the image, up to
/// 512 x 512 x 48 voxels.
///
/// Object is what Otsu's threshold leaves of the image smoothed once by (1 2 1)/4 along each axis;
/// voxels that have one value with all corners of the slices do not count. Let f be 0 far outside
/// and 1 far inside: across a straight edge with a Gaussian blur the integral of f (1 - f) is
/// sigma / sqrt(pi) per area, and sqrt(sigma^2 + 1/2) / sqrt(pi) after the smoothing, so that their
/// ratio tells sigma without the area. Noise adds its variance to each, which is known from the
/// voxels more than five voxels from any edge (four or three, if there are too few). Edges count
/// that have such voxels right across on both sides: in the grooves around contacts f falls to 0
/// late, which is no blur. Nor do voxels count within five voxels of a face, beyond which there may
/// be edges.
///
/// Memory: 24 bytes a voxel of the middle.
/// @return none if fewer than 500 voxels of either material are so far from edges, or the edges
///   tell no blur, or one of more than 2.5 voxels (a mask, labels, a scan without two materials).
/// @throw IoError; Interrupted.
std::optional<ScanBlur> estimateBlur(ImageReader& image, Interrupter* interrupter = nullptr);
/// The blur and noise of a scan by the voxels of a domain alone, that of labels: around it, where a
/// container may be, none counts.
/// @param domain absent: all of the scan
/// @throw as placeScan(), too
std::optional<ScanBlur> estimateBlur(GrayScan scan, const std::optional<Domain>& domain,
                                     Interrupter* interrupter = nullptr);

/// A sentence on a scan whose values may have been cut off (a twentieth of them or more are at one
/// end, ScanBlur::atEnds), or which shows more than two materials (ScanBlur::unlike). Of others it
/// is empty.
std::string noteOn(const ScanBlur& blur);

/// What estimateBlur() says, where a blur is needed.
/// @throw InvalidInput, one line that names the image, if none is found; as above
ScanBlur blurOf(GrayScan scan, const std::optional<Domain>& domain,
                Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
