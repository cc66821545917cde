// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/method/merge.h"
#include "vdb_madf/method/tidy.h"
#include "vdb_madf/slabs/scratch.h"

namespace vdb_madf {

/// Gets the labels of a slab, with the metadata of the manifolds brought up to date.
using PutGrain = std::function<void(size_t slab, const Int32Grid::Ptr& grain)>;

/// remerge() for manifolds that need not fit in memory together: the same labels, bit for bit. One
/// slab is worked on at a time; what is known of the others is in `scratch`, which is empty before.
/// @param manifolds those of segmentSlabs(), each with its part of the graph; each is read once
/// @param put is called for each slab, from the lowest on
/// @return the voxels of grain g at g - 1
/// @throw InvalidInput also if a slab carries no part of a graph or does not fit it, if parts are
///   not those of one graph, or if slabs, but for the first and the last, are lower than
///   `tidyRounds`
std::vector<int64_t> remergeSlabs(const LabelSlabs& manifolds, const MergeOptions& options,
                                  int tidyRounds, Scratch& scratch, const PutGrain& put,
                                  Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
