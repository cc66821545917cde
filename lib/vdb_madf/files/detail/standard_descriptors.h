// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf::detail {

// Descriptors that the caller closes; standard_streams.cc.

/// A descriptor of what keepStandardInput() kept, which this calls. @throw IoError
int openStandardInput();
/// @throw IoError if standard output is closed or a terminal.
int openStandardOutput();

}  // namespace vdb_madf::detail
