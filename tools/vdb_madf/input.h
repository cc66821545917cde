// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/selection.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/squared_distance.h"

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
  std::string phase, threshold, range;
  bool invert = false;
  std::string voxelSizeText, domainText;

  // Filled by parse().
  std::optional<Coord> size;
  std::optional<SampleType> sampleType;
  std::optional<Selection> selection;
  std::optional<VoxelSize> voxelSize;
  std::optional<CoordBBox> domain;

  void addRaw(CLI::App& verb);  ///< and --dataset
  void addSelection(CLI::App& verb);
  void addVoxelSize(CLI::App& verb);
  void addDomain(CLI::App& verb);
  /// Also checks that the outputs overwrite neither the input nor each other. @throw WrongUsage
  void parse();
  std::optional<RawLayout> rawLayout() const;
};

/// Strict parsers; the whole text must be the number. @throw WrongUsage that names the option.
double parseNumber(const std::string& text, const std::string& option);
Coord parseDims(const std::string& text, const std::string& option);
VoxelSize parseVoxelSize(const std::string& text);

/// True if the input is to be read as OpenVDB: by its first bytes, then by its ending.
/// @throw InvalidInput if it is, and a dataset was asked for
bool isVdb(const InputOptions& input);
bool hasVdbEnding(const std::string& path);
bool hasTiffEnding(const std::string& path);
bool hasRawEnding(const std::string& path);
bool hasPngEnding(const std::string& path);

/// Opens an image of which no file is among the outputs. @throw InvalidInput, IoError
std::unique_ptr<ImageReader> openInput(const InputOptions& input);

/// Finds out before the work, not after it, that the output cannot be written. @throw IoError
void checkWritable(const std::string& output);

/// Runs `work`; what the library has to say against the data then names the file, too.
template <typename Work>
auto naming(const std::string& path, const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const InvalidInput& error) {
    const std::string what = error.what();
    if (what.compare(0, path.size(), path) == 0) throw;
    throw InvalidInput(path + ": " + what, error.hint());
  }
}

/// "auto", "open" or "closed".
Boundary parseBoundary(const std::string& boundary);
/// Adds --boundary for what lies beyond the faces of a scan.
void addBoundary(CLI::App& verb, std::string& boundary);
/// What --boundary says of an object: where it is `auto`, what the object's file says.
/// @throw InvalidInput if it is open and the domain is unknown.
Boundary boundaryOf(const std::string& boundary, const InputOptions& input, const MaskGrid& object);

/// What to add to the number of an object's voxels: nothing, if there are any.
const char* hintIfEmpty(int64_t objectVoxels);

/// The object of any readable volume, with domain and voxel size as the options override them.
MaskGrid::Ptr loadObject(const InputOptions& input, Interrupter* interrupter);

/// Labels: the Int32 grid that is named, else `grain`, else `truth`, else the only Int32 grid; or
/// the values of an integer image.
Int32Grid::Ptr loadLabels(const InputOptions& input, const std::string& gridOption,
                          Interrupter* interrupter);

/// The grid of a file that is named, else the first present of `preferred`, else the only one that
/// is usable. @throw InvalidInput that lists the grids.
openvdb::GridBase::Ptr chooseGrid(const std::vector<openvdb::GridBase::Ptr>& grids,
                                  const std::string& path, const std::string& name,
                                  const std::string& gridOption,
                                  const std::vector<std::string>& preferred,
                                  bool (*usable)(const openvdb::GridBase&));
bool isNumericGrid(const openvdb::GridBase& grid);
bool isLabelGrid(const openvdb::GridBase& grid);

}  // namespace vdb_madf::tools
