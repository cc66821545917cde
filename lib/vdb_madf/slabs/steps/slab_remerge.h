// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/slabs/steps/slab_labels.h"

namespace vdb_madf::detail {

/// The manifolds of slabs as an object, whose leaves are in scratch once they were read.
SlabObject manifoldObject(const LabelSlabs& manifolds, const Scratch& scratch);

/// The steps of remergeSlabs(). `work` has the options, for manifoldObject().
class SlabRemerge {
 public:
  SlabRemerge(const LabelSlabs& manifolds, SlabWork& work);

  /// The first step, which leaves in scratch what does not depend on how manifolds are merged, but
  /// on the rounds of tidying.
  void read();
  /// Does all other steps. How many grains there are is known before the first slab is put:
  /// result.counts
  void merge(SlabSegmentation& result, const PutLabels& put);

 private:
  void take(size_t s);
  void sendHoles(size_t s, const LeafIndex& index, const ManifoldGraph& graph);

  const LabelSlabs& manifolds_;
  SlabWork& work_;
};

}  // namespace vdb_madf::detail
