// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/boundary.h"
#include "vdb_madf/slabs/segment_slabs.h"
#include "vdb_madf/slabs/steps/slab_steps.h"

namespace vdb_madf::detail {

/// What is known of the whole object: setUpSlabs() says it, the same to all members.
struct SlabFacts {
  Obstacles obstacles{};
  VoxelWeights weights;
  std::optional<Domain> domain{};
  bool fillsNone = false;              ///< would the cavities be all background?
  int32_t largestSquaredDistance = 0;  ///< of all slabs, once they are measured

  bool inRegion() const { return obstacles.inRegion(); }
};

/// What all steps of segmentSlabs() work with.
struct SlabWork {
  SlabWork(const SlabObject& object, const SegmentOptions& how, Scratch& scratch, Team& members,
           Interrupter* stop)
      : options(how),
        team(members),
        interrupter(stop),
        plan{object, members},
        store(object.slabCount(), scratch, members),
        steps(plan, store, members, isFiltered(), stop) {}

  const SegmentOptions& options;
  Team& team;
  Interrupter* interrupter;
  SlabPlan plan;
  SlabFacts facts;
  SlabStore store;
  SlabSteps steps;

  bool isFiltered() const { return options.gamma > 1; }

  Leaves cavities(size_t slab) const {
    return facts.fillsNone ? Leaves() : store.read(kCavities, slab);
  }
  SlabBody body(size_t slab) const { return SlabBody(plan.object.leaves(slab), cavities(slab)); }
};

}  // namespace vdb_madf::detail
