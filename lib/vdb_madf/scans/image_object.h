// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/domain.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/selection.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// Which values of an image are object has to be said; what() says it without options.
class SelectionNeeded : public InvalidInput {
 public:
  explicit SelectionNeeded(const std::string& what, bool orCylinder = false)
      : InvalidInput(what), orCylinder_(orCylinder) {}
  /// True if a cylinder as the region would do, too.
  bool orCylinder() const { return orCylinder_; }

 private:
  bool orCylinder_;
};

enum class AutomaticThreshold { none, otsu, valley };

/// What is done to a gray image, besides a selection, to make an object of it; in this order.
struct GrayOptions {
  int median = 0;     ///< radius of the cube, voxels: see medianImage(); 0: none
  double smooth = 0;  ///< standard deviation, voxels: see smoothedImage(); 0: none
  /// Takes the place of the selection's threshold: see otsuThreshold(), valleyThreshold().
  AutomaticThreshold automatic = AutomaticThreshold::none;
  /// Hysteresis: the selection is a threshold, and voxels from `low` on are object, too, if they
  /// are 6-connected with one that it selects by others such as they.
  std::optional<double> low;
  int64_t despeckle = 0;  ///< see despeckle(); it works on any object
};

/// The part of a scan that is looked at.
struct ScanPart {
  CoordBBox box = CoordBBox::inf();  ///< what lies outside is left out without a word
  Domain domain;                     ///< of the object: the rest of it is left out
};

/// The object in an image, and what is worth knowing of how it was found.
struct ImageObject {
  MaskGrid::Ptr mask;
  /// Voxels of the box that were selected and do not lie in the domain (0 for an inverted
  /// selection; with hysteresis those from the lower threshold on).
  int64_t leftOut = 0;
  /// No values were chosen, and the image is one of labels, which are all in one mask now.
  bool fromLabels = false;
  /// The one value at the four corners of all slices of a gray image, as around a round field of
  /// view: of kCornerSlices and more that were read whole, or of a box with padding at a corner.
  std::optional<double> corner = std::nullopt;
  int64_t nans = 0;        ///< voxels of the domain that are NaN; none is object
  int64_t infinities = 0;  ///< voxels of the domain that are infinite; they count by their sign
};

/// In fewer slices all corners may well have one value by chance.
constexpr int kCornerSlices = 8;

/// Gets an object in layers of leaf nodes, ascending in z; those without voxels may be left out.
/// What is taken is not kept, so the object need not fit in memory.
using TakeLayer = std::function<void(MaskTree& layer)>;

/// Hands over the layers of an object that is in memory. The tree is empty then.
void takeLayers(MaskTree& object, const TakeLayer& take);

/// True if anything but despeckling is asked for, which images alone take.
bool readsGray(const GrayOptions& gray);

/// The image behind the median and the Gaussian that are asked for.
std::unique_ptr<ImageReader> filteredImage(std::unique_ptr<ImageReader> image,
                                           const GrayOptions& gray);

/// The object of an image, as readMask() makes it, with all steps. How it was made is said by
/// `madf_object`, if one of the gray options was used, `madf_threshold` and `madf_threshold_low`.
/// Peak memory: the mask (three with hysteresis), what despeckle() needs, and one slab with as many
/// slices on either side as the filters reach. An automatic threshold takes two passes.
/// @param open called for each pass over the image
/// @param part absent: all of the image. Thresholds are found, and voxels connected, within its
///   domain alone; filters look beyond it.
/// @param take gets the voxels, and the mask has none. With hysteresis and despeckle the whole of
///   the mask is made first.
/// @param selection absent: what is not 0. That, inverted or not, is taken of masks and label
///   images alone (see kindOf()): other images need a selection by value.
/// @throw SelectionNeeded, one line that names the file, for a gray image or one of phases without
///   one, and for a histogram without a valley; InvalidInput; IoError; Interrupted.
ImageObject imageObject(const std::function<std::unique_ptr<ImageReader>()>& open,
                        const std::optional<Selection>& selection, const GrayOptions& gray = {},
                        const std::optional<ScanPart>& part = std::nullopt,
                        Interrupter* interrupter = nullptr, const TakeLayer& take = nullptr);

/// How the object of an image was found.
struct StoredReading {
  Selection selection;  ///< a threshold
  GrayOptions gray;     ///< none is automatic
};
/// What imageObject() wrote onto a mask, which its labels have, too; none if the object was not
/// found by a threshold.
std::optional<StoredReading> storedReading(const openvdb::MetaMap& metadata);

/// Despeckles the object and adds that to what it says of itself.
void despeckleObject(MaskGrid& object, int64_t voxels, Interrupter* interrupter);

}  // namespace vdb_madf
