// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/scans/detail/histogram_builder.h"
#include "vdb_madf/scans/image_object.h"

namespace vdb_madf::detail {

/// The box that is read of an image of this size. @throw InvalidInput if that is nothing.
CoordBBox boxOf(const ScanPart& part, const ImageSize& size);

/// Leaves a grid the active voxels of the part, and tells it its domain.
/// @return how many of the box were left out
int64_t cutTo(const ScanPart& part, MaskGrid& mask);
int64_t cutTo(const ScanPart& part, Int32Grid& labels);

/// The parts of the rows of such an image that lie in the domain.
RowParts rowsOf(const ScanPart& part, const ImageSize& size);

/// The histogram of the voxels of an image that lie in the domain; slices without any are not read.
/// @param padding as of CountedImage. @throw as histogramOf()
Histogram histogramIn(const ScanPart& part, ImageReader& image, const PaddedImage& padding,
                      Interrupter* interrupter);

}  // namespace vdb_madf::detail
