// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/pictures/picture.h"

namespace vdb_madf::tools {

/// Writes a PNG, whole or not at all. @throw IoError
void writePng(const std::string& path, const Picture& picture);

}  // namespace vdb_madf::tools
