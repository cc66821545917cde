// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf {

// Files of ours say by a digest what was written into them. Readers compare it with what they find,
// and refuse a file that differs; files without a digest are read as they are.

/// Whether this process does so. True at first.
bool filesAreVerified();
void setFilesAreVerified(bool verified);

}  // namespace vdb_madf
