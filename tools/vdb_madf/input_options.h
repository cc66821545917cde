// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command_line.h"
#include "progress.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/selection.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/volumes/choose_grid.h"
#include "vdb_madf/volumes/load_labels.h"
#include "vdb_madf/volumes/load_object.h"

namespace vdb_madf::tools {

/// What the command line says of a volume to read. The text of each option is checked by parse().
struct InputOptions {
  std::string path;
  std::vector<std::string> outputs;  ///< what the verb will write; empty names and "-" are none
  std::string gridName;
  std::string dataset;        ///< of a Zarr group or an HDF5 file
  std::string dims, type;     ///< of a RAW file; `type` of the output if the input is not RAW
  bool typeIsOfInput = true;  ///< nothing but a RAW input takes a `type`
  bool bigEndian = false;
  std::string skip;  ///< of a RAW file, bytes before its samples
  std::string phase, threshold, range;
  bool invert = false;
  std::string median, smooth, despeckle;
  int longestSide = 0;     ///< see VolumeOptions
  bool areLabels = false;  ///< so is this
  std::string voxelSizeText, domainText, roi, cropText;

  // Filled by parse().
  std::optional<Coord> size;
  std::optional<SampleType> sampleType;
  uint64_t bytesToSkip = 0;
  std::optional<Selection> selection;
  GrayOptions gray;
  std::optional<VoxelSize> voxelSize;
  std::optional<CoordBBox> domain;
  RegionOptions region;

  void addRaw(Verb verb);  ///< and --dataset
  void addSelection(Verb verb);
  void addVoxelSize(Verb verb);
  void addDomain(Verb verb);
  void addRegion(Verb verb);  ///< --roi and --crop
  /// Reads the texts. Also checks that the outputs overwrite neither the input nor each other.
  /// @throw WrongUsage
  void parse();
  /// The options of the library; their notes go to `progress`, which has to live as long as they
  /// come.
  VolumeOptions volume(Progress* progress) const;

 private:
  void parseRegion();
  void parseSelection();
  void parseGray();
};

/// True if the input is to be read as OpenVDB.
/// @throw InvalidInput if it is, and a dataset was asked for
bool isVdb(const InputOptions& input);
/// Checks an input that is no VDB file. @throw InvalidInput if a grid was asked for
void checkNoGrid(const InputOptions& input, const std::string& gridOption);

// The functions of the room volumes; messages name the options.
openvdb::GridBase::Ptr chooseGrid(const InputOptions& input,
                                  const std::vector<openvdb::GridBase::Ptr>& grids,
                                  GridUse use = GridUse::values);
MaskGrid::Ptr loadObject(const InputOptions& input, Progress* progress);
MaskGrid::Ptr streamObject(const InputOptions& input, const TakeLayer& take,
                           const ObjectShare& share, Progress* progress);
Int32Grid::Ptr loadLabels(const InputOptions& input, const std::string& gridOption,
                          Progress* progress);
LabelSlabs openLabelSlabs(const InputOptions& input, const std::string& gridOption,
                          Progress* progress);
/// Opens a folder of slabs whose domain is a box, so that they can be taken one by one; none of
/// other labels.
std::optional<LabelSlabs> openBoxSlabs(const InputOptions& input, const std::string& gridOption,
                                       Progress* progress);
/// Labels that can be taken so, or else whole.
AnyLabels loadAnyLabels(const InputOptions& input, const std::string& gridOption,
                        Progress* progress);
/// True if it is a folder of slabs, which can be taken one by one.
bool isInSlabs(const InputOptions& input);
/// True if a gray image is cut into object and pores: by a threshold, or after a filter.
bool cutsGray(const InputOptions& input);

/// Runs `work`; what the library has to say against the data then names the file, too.
template <typename Work>
auto withFileName(const std::string& path, const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const InvalidInput& error) {
    const std::string what = error.what();
    if (what.compare(0, path.size(), path) == 0) throw;
    throw InvalidInput(path + ": " + what, error.hint());
  }
}

/// Adds --boundary for what lies beyond the faces of a scan.
void addBoundary(Verb verb, std::string& boundary);
/// What --boundary says of an object: where it is `auto`, what the object's file says.
/// @throw InvalidInput if it is open and the domain is unknown.
Boundary boundaryOf(const std::string& boundary, const InputOptions& input, const MaskGrid& object,
                    Progress* progress);

/// Adds --density and --ice, for parseDensity().
void addDensity(Verb verb, std::string& density, bool& ice);

/// How an object was made of a gray image, as its metadata tell; empty if it was not.
std::string objectSteps(const openvdb::GridBase& grid);
/// "3 of 4 voxels of the box": how large a domain is that is no box.
std::string regionText(const Domain& domain);
/// What to add to the number of an object's voxels: nothing, if there are any.
const char* hintIfEmpty(int64_t objectVoxels);

}  // namespace vdb_madf::tools
