// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/samples/sample.h"

namespace vdb_madf {

/// What makes a sample of cubes look like a scan of real particles, in this order; lengths in
/// voxels. Beyond a face the object goes on as its voxels at the face.
struct ScanOptions {
  uint64_t seed = 1;

  /// The surface is moved outwards by a Gaussian random field of this standard deviation (0..8;
  /// no place moves farther than four of them), whose correlation falls to 1/e at `surfaceLength`
  /// (1..32). Voxel p stays or becomes object if its distance from the surface, negative inside, is
  /// at most the field at p: the distance to the nearest voxel of the other kind, less a half.
  double surface = 0;
  double surfaceLength = 8;

  /// The gray values of a scan: 1 in the object and 0 in the air, blurred by a Gaussian of standard
  /// deviation `blur` (0..8), plus noise of standard deviation `noise` (0..1), which is white or
  /// whose correlation falls to 1/e at `noiseLength` (0..32; 0: white). Object is what reaches 0.5.
  double blur = 0;
  double noise = 0;
  double noiseLength = 0;
};

/// @throw InvalidInput for options out of range.
void checkScan(const ScanOptions& options);

/// The sample as a scan shows it. Voxels that stay keep their true grain. One that is new gets the
/// grain of the nearest true voxel (tie: the smaller number); if noise made it and no true voxel
/// lies within 2 voxels, it is object without a true grain: inactive in the truth. Grains that have
/// lost all voxels leave no gap in the numbers.
/// @throw InvalidInput for options out of range, or voxels that are no cubes; Interrupted.
Sample scanned(const Sample& sample, const ScanOptions& options,
               Interrupter* interrupter = nullptr);

/// The gray values of a scan of the sample's bodies in a box of voxels, x fastest: 10000 in the air
/// and 30000 in the bodies, in between by the share of the voxel that lies in them; then blur and
/// noise as above (noise 0.1 has standard deviation 2000), rounded, and cut at 0 and 65535. Unlike
/// an object, which goes on as its voxels at the face, balls and particles lie beyond the faces as
/// they are; a sintered bed goes on as its voxels do.
///
/// Shares are counted over 8 x 8 x 8 points in each voxel that a surface crosses. That of a plane
/// is off by 0.004 in the root of the mean square over all places and directions, and by up to 1/16
/// where the plane lies along two axes. The surfaces of sintered balls and beds are those of fields
/// that are linear along each axis between the centers of voxels.
/// @throw InvalidInput as scanned(), for a surface, or a sample without bodies; Interrupted.
std::vector<uint16_t> grayValues(const Sample& sample, const ScanOptions& options,
                                 const CoordBBox& box, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
