// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/grid_metadata.h"
#include "vdb_madf/grid_types.h"
#include "vdb_madf/image_file.h"
#include "vdb_madf/selection.h"

namespace vdb_madf::tools {

/// What the command line says of a volume to read. The text of each option is checked by parse().
struct InputOptions {
  std::string path;
  std::string gridName;
  std::string dims, type;  ///< of a RAW file; `type` of the output if the input is not RAW
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

  void addRaw(CLI::App& verb);
  void addSelection(CLI::App& verb);
  void addVoxelSize(CLI::App& verb);
  void addDomain(CLI::App& verb);
  /// @throw WrongUsage
  void parse();
  std::optional<RawLayout> rawLayout() const;
};

/// Strict parsers; the whole text must be the number. @throw WrongUsage that names the option.
double parseNumber(const std::string& text, const std::string& option);
Coord parseDims(const std::string& text, const std::string& option);
VoxelSize parseVoxelSize(const std::string& text);

/// True if the file is an OpenVDB file, by its first bytes.
bool isVdb(const std::string& path);
bool hasVdbEnding(const std::string& path);
bool hasRawEnding(const std::string& path);

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

/// The output must not be the input. @throw WrongUsage
void checkOutputIsNotInput(const std::string& input, const std::string& output);

}  // namespace vdb_madf::tools
