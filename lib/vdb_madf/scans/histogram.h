// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// How often the values of an image occur, in at most 65536 bins. The width of a bin is the least
/// power of two that suffices, but 1 or more for integers: images of 8 and 16 bits have one bin a
/// value. The bins depend on the least and greatest value alone, so one pass over the image makes
/// them. NaN and infinities are counted apart.
struct Histogram {
  SampleType type = SampleType::uint8;
  double width = 1;
  int64_t first = 0;            ///< bin i holds the values with floor(value / width) = first + i
  std::vector<int64_t> counts;  ///< neither first nor last is 0; empty if no value is finite
  std::vector<int64_t> runs;    ///< how many runs of equal values, along x, these voxels make
  double min = 0, max = 0;      ///< finite values
  int64_t finite = 0, notFinite = 0;  ///< voxels
  bool whole = true;                  ///< all finite values are whole numbers
  /// All finite values, ascending, if there are at most kFewValues; else the least that were met.
  std::vector<double> few;
  std::vector<int64_t> fewCounts;  ///< how many voxels have each of them
  bool onlyFew = true;             ///< `few` has all values
  /// The one value at the four corners of all slices, as around a round field of view.
  std::optional<double> corner;
  int64_t padding = 0;  ///< voxels of this value between an end of a row and the first of another
  /// The histogram without the padding and what filters mix with it; none if nothing is left, or
  /// left out.
  std::shared_ptr<const Histogram> inside;

  double lowerEdge(size_t bin) const { return double(first + int64_t(bin)) * width; }
};

/// An image with this many values at most has phases.
constexpr size_t kFewValues = 4;

/// @throw IoError; Interrupted.
Histogram histogramOf(ImageReader& image, Interrupter* interrupter = nullptr);

/// What an image seems to be.
enum class ImageKind {
  mask,    ///< 0 and another value, or one value alone
  phases,  ///< at most kFewValues values, whole numbers
  labels,  ///< whole numbers, and half of the bins without 0 hold runs of three voxels on average
  gray     ///< anything else
};
ImageKind kindOf(const Histogram& histogram);

/// How many voxels along x have the same value, on average; 0 is not counted. 1 if there is no
/// other.
double meanRun(const Histogram& histogram);

/// How far apart the voxels of a value lie, on average of the values but 0 that have several: the
/// length of their box as a part of the image's, 0 to 1, the mean of its axes. It is 1/3 or more of
/// values that are strewn at random, and small of labels of many grains; 1 if no value has several.
/// The values are whole numbers. Of a large image some slices are looked at, 2^26 voxels in all.
/// @throw IoError; Interrupted.
double valueSpread(ImageReader& image, Interrupter* interrupter = nullptr);

/// How many values but 0 there are, all of which are whole numbers. Takes another pass over the
/// image where a bin holds several values; memory is that of the values. @throw IoError;
/// Interrupted.
int64_t countLabels(const Histogram& histogram, ImageReader& image,
                    Interrupter* interrupter = nullptr);

/// Otsu's threshold: the one with the largest variance between the voxels below and the others
/// (the least, if several are equal), put into the middle of the empty bins above the last bin
/// below. With one bin a value the voxels at or above it are those above scikit-image's
/// threshold_otsu(). None if there is but one bin.
std::optional<double> otsuThreshold(const Histogram& histogram);

/// The deepest place between two modes: the histogram, gathered into 256 bins from the least to the
/// greatest value if it has more, is smoothed (by means of three bins, at most 10000 times) until
/// it has two maxima; the threshold is the least bin between them, as scikit-image's
/// threshold_minimum() finds it: with one bin a value the next value, else the middle of the bin.
/// None if there are no two maxima.
std::optional<double> valleyThreshold(const Histogram& histogram);

/// Voxels at or above a threshold (one of those above, or any edge of a bin).
int64_t voxelsFrom(const Histogram& histogram, double threshold);

/// Voxels in the bin that holds this value.
int64_t voxelsAround(const Histogram& histogram, double value);

/// The value below which a share of the voxels lies, to the edge of a bin.
double quantile(const Histogram& histogram, double share);

/// Counts gathered into `bins` equal parts from `low` to `high`; what lies outside is left out.
std::vector<double> gathered(const Histogram& histogram, double low, double high, size_t bins);

/// A line of characters from ' ' to '@' that grow with the square root of the counts, between the
/// values of a thousandth and of 999 thousandths of the voxels: "1210 |.:=@*:.| 43000".
std::string histogramLine(const Histogram& histogram, size_t characters = 40);

}  // namespace vdb_madf
