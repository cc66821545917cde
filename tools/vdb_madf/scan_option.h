// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "input_options.h"
#include "vdb_madf/intensity/gray_scan.h"

namespace vdb_madf::tools {

/// A scan beside the labels that are the input.
struct ScanOption {
  std::string path;    ///< empty: none
  std::string grid;    ///< of a VDB, or the array of a Zarr or HDF5 file
  std::string option;  ///< "--name" of the path; that of the grid is "--name-grid"

  /// Adds both options. @param help that of the path; the grid is one "of that scan"
  void add(Verb verb, const std::string& help, const std::string& ofWhat = "of that scan");
};

/// What can be said of the option before the work. @throw WrongUsage
void checkScan(const ScanOption& scan, const InputOptions& labels);

/// The voxels of a map of phases that have this value. @throw as loadObject()
MaskGrid::Ptr loadPhase(const ScanOption& map, int64_t value, const InputOptions& labels,
                        Progress* progress);
/// @param labels the scan must not be one of its outputs
/// @throw InvalidInput, IoError: one line that names the file and what to do.
GrayScan openScan(const ScanOption& scan, const InputOptions& labels, Progress* progress);

/// Tells what noteOn() or noteOnScan() says of a scan, if anything.
void noteOfScan(const std::string& path, const std::string& note, Progress* progress);

}  // namespace vdb_madf::tools
