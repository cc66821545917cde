// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/scans/image_object.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/volumes/choose_grid.h"
#include "vdb_madf/volumes/volume.h"

namespace vdb_madf::detail {

/// True if the file is read as OpenVDB.
/// @throw InvalidInput if the options name a part that only other files have
bool isReadAsVdb(const std::string& path, const VolumeOptions& options);

/// Reads the chosen grid and not the others of the file.
VdbReadOptions readingAlone(const openvdb::GridBase& chosen);

/// Chooses by name and type first: the other grids of the file are not loaded.
openvdb::GridBase::Ptr readGrid(const std::string& path, GridUse use, const VolumeOptions& options,
                                Interrupter* interrupter);

/// Checks an image against the options, and says what a user should know of it.
std::unique_ptr<ImageReader> checkedImage(std::unique_ptr<ImageReader> image,
                                          const VolumeOptions& options);

/// Runs `work`; what is wrong with the data then names the file, too, unless it names a mask.
template <typename Work>
auto naming(const std::string& path, const std::string& mask, const Work& work)
    -> decltype(work()) {
  try {
    return work();
  } catch (const SelectionNeeded&) {
    throw;
  } catch (const AmbiguousGrid&) {
    throw;
  } catch (const InvalidInput& error) {
    const std::string what = error.what();
    if (what.find(path) == 0 || (!mask.empty() && what.find(mask) == 0)) throw;
    throw InvalidInput(path + ": " + what, error.hint());
  }
}

}  // namespace vdb_madf::detail
