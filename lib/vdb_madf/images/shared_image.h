// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// Writes a part of the slices of an image that one process has made and shares
/// (ImageWriter::share()); others write other slices meanwhile. finish() syncs the part to disk;
/// the image appears when the process that made it finishes it, after all.
/// @param path of the image, which messages name
/// @param first slice of the part
/// @throw IoError if this process does not see the shared file
std::unique_ptr<ImageWriter> joinImage(const std::string& path, const SharedImage& shared,
                                       const ImageInfo& info, int first);

}  // namespace vdb_madf
