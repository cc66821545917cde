// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vdb_madf::tools {

/// All files that the outputs are written to: an .mhd has its samples in a file beside it, an .obj
/// its materials. Empty names and "-" are none.
std::vector<std::string> filesOf(const std::vector<std::string>& outputs);
/// @throw WrongUsage if the outputs would overwrite the input or each other, or replace the folder
///   that it lies in, or standard output cannot take them
void checkOutputs(const std::vector<std::string>& outputs, const std::string& input);
/// The path of a file or a folder, whether or not it is there; it ends with a slash.
std::filesystem::path placeOf(const std::string& path);
/// True if a path is that of a folder, or of something in it, be it through links.
bool isWithin(const std::string& path, const std::string& folder);
/// True if the output goes to standard output: "-", or "npy:-" and the like (standard_streams.h).
bool isOnStandardOutput(const std::string& output);
/// Finds out before the work, not after it, that the output cannot be written or would replace what
/// is not its own; clears away what killed runs left there. @throw IoError
void checkWritable(const std::string& output);

bool hasVdbEnding(const std::string& path);
bool hasTiffEnding(const std::string& path);
bool hasRawEnding(const std::string& path);
bool hasPngEnding(const std::string& path);
/// True for a folder of slabs.
bool hasSlabsEnding(const std::string& path);
/// A table goes to a .csv or to "-". @throw WrongUsage
void checkTableEnding(const std::string& path);

}  // namespace vdb_madf::tools
