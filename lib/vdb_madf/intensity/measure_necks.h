// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/intensity/gray_scan.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/measure/scan_blur.h"

namespace vdb_madf {

/// Sets BondMeasures::neck and Measurements::scan. Blur fills the grooves around necks, so that the
/// necks of a thresholded scan are too large; the gray values still tell how large they are.
///
/// A blur along a plane does not change the sum of the gray values over the plane. So the sums over
/// planes across a bond, in units of the contrast, are the areas of the sections of the two grains,
/// blurred along the bond's normal only: a curve that is fitted (detail/section_fit.h) and whose
/// least value, without the blur, is the area of the neck.
///
/// The normal joins the means of the voxels of both sides within the radius of the bond and three
/// voxels around its centroid. A section is what is connected to the bond within 5 voxels along the
/// normal; voxels further than three blurs and 0.7 voxel from any surface count as all inside or
/// outside, pore voxels go with the nearest grain, and other grains do not count, nor do those that
/// the scan shows and that have no label (any longer): of what is on the grains' side of the middle
/// gray, 27 voxels or more together that far from all labels, with what is as near to these. The
/// grays of inside and outside are those around the bond, if there are 100 voxels of each, else the
/// scan's.
/// A neck is not known, NaN, if its error is over 21 voxel faces and over 0.35 of the bond's area,
/// as beside flat faces and in grooves, or its area over 3 times that of the bond plus 7 faces.
/// A neck is confirmed if its area is at least 7 voxel faces and not below its error. Of others the
/// gap is told: how far apart the tips of the two grains are, by how their sections grow from
/// there.
///
/// Grains may be bright or dark in the scan.
///
/// The scan is read once, twice where no bond tells on which side grains are, in slabs of eight
/// slices. Memory: that, and four bytes for each voxel of the leaf nodes around bonds.
/// @param blur what estimateBlur() says of the scan
/// @param measured what measure() says of these labels
/// @throw InvalidInput, one line that names the scan, if the domain is unknown or the scan's box
///   does not fit (as measureGray()), if voxels are no cubes, or if its grains are elsewhere:
///   around bonds (around some grains where no bond tells) of the voxels of grains and of others
///   less than 65 % in the mean are on their own side of the middle gray, or a voxel or more along
///   an axis from where the labels have them (detail/grains_in_scan.h); IoError; Interrupted.
void measureNecks(const Int32Grid& labels, GrayScan& scan, const ScanBlur& blur,
                  Measurements& measured, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
