// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf {

/// Registers OpenVDB's grid types and this library's own metadata type. Call once before any file
/// is read or written, or a grid is given graph metadata. Thread-safe; further calls do nothing.
void initialize();

}  // namespace vdb_madf
