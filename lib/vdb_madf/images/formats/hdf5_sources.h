// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <hdf5.h>

#include <cstdint>
#include <string>
#include <vector>

namespace vdb_madf::detail {

/// The files that have the samples of a dataset.
struct Hdf5Sources {
  uint64_t bytes = 0;              ///< that files hold of them, compressed or not
  bool isVirtual = false;          ///< put together from parts of other datasets
  std::vector<std::string> files;  ///< all that are read
};

/// Looks up the files of a dataset, be it linked from another file or virtual. The library would
/// take a part of a virtual dataset whose file is missing for zeros: each has to be there, and as
/// large as its part.
/// @param path the file that the user named, for messages
/// @throw IoError if a file or dataset is missing or too small, or the dataset is of a kind that
///     cannot be checked (raw files, a pattern of names)
Hdf5Sources hdf5Sources(const std::string& path, const std::string& name, hid_t dataset);

/// Why a dataset cannot be opened: the file that an external link on its way leads to. Empty if it
/// has none.
std::string missingHdf5Link(hid_t file, const std::string& name);

}  // namespace vdb_madf::detail
