// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// MetaImage (.mhd with a data file, .mha with the data in it), raw or zlib. Its spacing has no
/// unit; by ITK's convention it is millimeters. A spacing of exactly 1 is what programs write that
/// know nothing better: it gives no physical size.
/// Not read: text data, several channels, data spread over several files.
std::unique_ptr<ImageReader> openMeta(std::unique_ptr<InputFile> file);
/// Finds out before the work. @throw IoError if the .raw file beside an .mhd would replace one that
/// the .mhd there, if any, does not name.
void checkMetaPlace(const std::string& path);
/// .mha: one file. .mhd: the data in a .raw file beside it, which is put in place first.
/// @throw as checkMetaPlace().
std::unique_ptr<ImageWriter> createMeta(const std::string& path, const ImageInfo& info,
                                        const std::array<double, 3>& origin);

/// True for the first bytes of a MetaImage header.
bool isMetaHeader(const std::string& head);

}  // namespace vdb_madf::detail
