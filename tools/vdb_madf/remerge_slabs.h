// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "command.h"
#include "input_options.h"
#include "vdb_madf/method/merge.h"

namespace vdb_madf::tools {

/// The manifolds in a folder of slabs. @throw InvalidInput if it has none
LabelSlabs openManifoldSlabs(const InputOptions& input, Progress* progress);

/// What `remerge` does from a folder of slabs to another one, slab by slab; OUT.slabs appears whole.
void remergeInSlabs(const InputOptions& input, const std::string& out, const MergeOptions& merge,
                    int tidy, const Common& common);

}  // namespace vdb_madf::tools
