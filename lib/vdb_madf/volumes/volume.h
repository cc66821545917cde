// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/grids/selection.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/scans/image_object.h"
#include "vdb_madf/scans/scan_region.h"

namespace vdb_madf {

/// What a note is about: a program with options can add the one that matters.
enum class NoteAbout { file, voxelSize, labels };

/// Any readable file, OpenVDB or an image of openImage(), as one volume. The defaults suit every
/// file that describes itself and holds one volume.
struct VolumeOptions {
  std::string grid;                    ///< name of the grid of a VDB file; empty: see GridUse
  std::string dataset;                 ///< array of a Zarr group or an HDF5 file: see openImage()
  std::optional<RawLayout> raw;        ///< of a file without a header
  std::optional<Selection> selection;  ///< object only: by value; default: see loadObject()
  GrayOptions gray;                    ///< object only: filters and thresholds of a gray image
  std::optional<VoxelSize> voxelSize;  ///< instead of the file's
  std::optional<CoordBBox> domain;     ///< of the scan, in voxels, instead of the file's
  RegionOptions region;                ///< the part of that to work on
  /// Files that the caller will write: an image that has samples in one of them is refused.
  std::vector<std::string> outputs;
  /// An image of more voxels along an axis is refused before its samples are read. 0: any.
  int longestSide = 0;
  TakeLayer takeLayer;  ///< object only: gets the voxels, and the grid has none; see imageObject()
  /// With takeLayer: gives one of so many parts of the layers of leaf nodes. Of an image that is an equal
  /// part of the slices, which alone are read; it has to be read by value then, with no more than filters.
  /// What a region leaves out is not counted then. Slabs of a folder are dealt. A .vdb is read by all.
  struct Share {
    int part = 0, parts = 1;
  } share;
  /// Is told what a user should know of the volume though it is no error: one line that names it.
  std::function<void(const std::string& text, NoteAbout about)> note;
};

/// What a grid is wanted for. Where none is named, it is the first that is there of the names in
/// parentheses, else the only one of a type that can be used. The region of another grid is taken
/// only by its name.
enum class GridUse {
  object,  ///< a mask, bool, int32, int64, float or double ("object")
  labels,  ///< int32 ("grain", "truth")
  values   ///< the types of `object` ("grain", "truth", "object")
};

/// Several grids can be used, and none was named.
class AmbiguousGrid : public InvalidInput {
 public:
  AmbiguousGrid(const std::string& path, const std::string& grids);
  /// The grids of the file with their types: "a (int32), b (int32)".
  const std::string& grids() const { return grids_; }

 private:
  std::string grids_;
};

/// True if the file is OpenVDB by its first bytes; where they do not tell, by the ending .vdb. So is a
/// folder of slabs (slab_folder.h).
/// A file that is missing is judged by its ending.
bool isVdbFile(const std::string& path);

/// One of the grids of the file at `path`, which the messages name.
/// @param name of the grid; empty: see GridUse
/// @throw InvalidInput if there is no such grid or it cannot be used; AmbiguousGrid.
openvdb::GridBase::Ptr chooseGrid(const std::vector<openvdb::GridBase::Ptr>& grids,
                                  const std::string& path, GridUse use,
                                  const std::string& name = "");

/// Gives a grid of the file at `path` the domain and the voxel size of the options, if they have
/// any. A voxel size that differs by more than 1 % from the file's is worth a note.
void overrideFile(openvdb::GridBase& grid, const std::string& path, const VolumeOptions& options);

/// openImage() with `raw` and `dataset` of the options. Also says its notes, and that the voxel size
/// of the options differs by more than 1 % from the file's.
/// @throw InvalidInput if it has samples in one of the outputs or is longer than allowed; IoError.
std::unique_ptr<ImageReader> openVolumeImage(const std::string& path,
                                             const VolumeOptions& options = {});

/// The object in a volume, as a grid "object" with domain and voxel size, as far as the file or the
/// options tell them: of a grid as objectMask(), of an image as imageObject(). With a region the
/// domain is what of it lies in the region, object outside is left out, and a note says how much,
/// and what was fitted. (An inverted selection is one of that domain.)
/// Peak memory: see readVdb() and imageObject().
/// @throw InvalidInput, one line that names the file, for a volume that does not fit the options
///   (also AmbiguousGrid); IoError; Interrupted.
MaskGrid::Ptr loadObject(const std::string& path, const VolumeOptions& options = {},
                         Interrupter* interrupter = nullptr);

/// The labels in a volume, an int32 grid or an image of integers: active where they are not 0.
/// (Of a VDB file: the grid as it is.) With a region as loadObject().
/// @throw as loadObject(); InvalidInput if a value is no integer or beyond int32.
Int32Grid::Ptr loadLabels(const std::string& path, const VolumeOptions& options = {},
                          Interrupter* interrupter = nullptr);

/// The same of a folder of slabs (slab_folder.h), one by one; without a region.
/// @throw as loadLabels()
LabelSlabs openLabelSlabs(const std::string& path, const VolumeOptions& options = {},
                          Interrupter* interrupter = nullptr);

/// Opens an image, for each pass over it anew.
using ImageOpener = std::function<std::unique_ptr<ImageReader>()>;

/// The same of an image that is no file, such as an array that is read slab by slab. Its path is what
/// messages and the metadata `madf_source` name. Of the options, what concerns files has no meaning:
/// grid, dataset, raw and outputs.
MaskGrid::Ptr loadObject(const ImageOpener& open, const VolumeOptions& options = {},
                         Interrupter* interrupter = nullptr);
Int32Grid::Ptr loadLabels(const ImageOpener& open, const VolumeOptions& options = {},
                          Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
