// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/intensity/gray_scan.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

/// Sets the gray values of grains (of all their voxels) and of bonds (of the voxels of either grain
/// that have a face towards the other, each once). NaN and infinite values do not count.
///
/// The scan is read in slabs of eight slices, those without labels not at all. It is placed by
/// placeScan(). Of integers mean and deviation are taken of exact sums; of other numbers the sums
/// are those of one order. Either way they are the same bits for any number of threads. Memory: a
/// slab, and a sample for each labeled voxel and for each voxel beside a bond.
/// @param measured what measure() says of these labels
/// @throw InvalidInput, one line that names the scan, if the domain is unknown, or the scan's box
///   does not fit; InvalidInput if `measured` is of other labels; IoError; Interrupted.
void measureGray(const Int32Grid& labels, GrayScan& scan, Measurements& measured,
                 Interrupter* interrupter = nullptr);

/// Labels in slabs are read once, and give the same bits. Memory: two slabs of labels, and a sample
/// for each voxel of the grains that have voxels in slabs read and in slabs to come.
/// @throw as above; what reading throws
void measureGray(const LabelSlabs& labels, GrayScan& scan, Measurements& measured,
                 Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
