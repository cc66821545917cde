// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>

#include "vdb_madf/images/image.h"

namespace vdb_madf {

// Images that filter another one while they are read. They hold the slices that are asked for and,
// on either side, as many as the filter reaches. Beyond its faces an image goes on as its mirror
// image (c b a | a b c). The same bits for any number of threads, and however it is read.

constexpr int kMaxMedianRadius = 3;
constexpr double kMinSmoothing = 0.1, kMaxSmoothing = 20;

/// The median of the cube of 2 radius + 1 voxels around each: scipy.ndimage.median_filter() of that
/// size. The sample type stays. NaN stays NaN; beside it the median is that of the numbers in the
/// cube, of an even count of them the lower middle one.
/// @throw InvalidInput unless 1 <= radius <= kMaxMedianRadius
std::unique_ptr<ImageReader> medianImage(std::unique_ptr<ImageReader> image, int radius);

/// The convolution with a Gaussian of standard deviation `sigma` voxels, cut at
/// int(4 sigma + 0.5) voxels: scipy.ndimage.gaussian_filter() of the image as float32 (as float64,
/// if its samples have 32 bits and are integers, or 64). Sums are in double precision, and rounded
/// after each axis: z, y, x. NaN stays NaN; beside it the sum is that of the numbers alone, divided
/// by their weights.
/// @throw InvalidInput unless kMinSmoothing <= sigma <= kMaxSmoothing
std::unique_ptr<ImageReader> smoothedImage(std::unique_ptr<ImageReader> image, double sigma);

}  // namespace vdb_madf
