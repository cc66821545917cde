// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf {

/// Version of the library and the command; CMake reads it from here.
constexpr char kVersion[] = "0.1.0";

}  // namespace vdb_madf
