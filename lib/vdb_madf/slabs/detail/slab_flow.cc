// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_flow.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/slabs/detail/near_cuts.h"
#include "vdb_madf/slabs/detail/slab_filter.h"
#include "vdb_madf/slabs/detail/slab_graph.h"
#include "vdb_madf/slabs/detail/slab_labels.h"
#include "vdb_madf/slabs/detail/slab_region.h"
#include "vdb_madf/slabs/detail/slab_setup.h"
#include "vdb_madf/slabs/detail/slab_terminals.h"

namespace vdb_madf::detail {

namespace {

class SlabFlow {
 public:
  SlabFlow(SlabWork& work, SlabSegmentation& result)
      : work_(work), result_(result), offers_(work, "offers"), completion_(work) {}

  void run() {
    work_.beginStage("cavities");
    setUpSlabs(work_, result_);
    if (result_.counts.objectVoxels == 0) return;
    work_.beginStage("offers");
    if (work_.inRegion()) {
      measureInRegion();
      shareLargest();
      shareBodies(work_, mappedReach(work_));
    } else {
      exchangeColumns(work_);
      work_.forEachSlab([&](size_t s) { offerBalls(s); });
      offers_.passOn();
    }
    if (isFiltered()) {
      work_.beginStage("gamma_filter");
      filterInSlabs(work_, offers_, completion_, result_.counts);
      work_.beginStage("completion");
      completion_.run();
    }
    work_.beginStage("flow");
    work_.forEachSlab([&](size_t s) { flowIn(s); }, [&](size_t s) { forgetMaps(s); });
    if (work_.inRegion())
      forgetBodies(work_);
    else
      shareLargest();
    makeParts(work_, result_.counts);
  }

 private:
  bool isFiltered() const { return work_.options.gamma > 1; }

  void offerBalls(size_t s) {
    WorkPart part = work_.part(5, 10, s);
    const SlabBody slab = work_.body(s);
    const SlabFaces faces = facesOf(work_, s);
    NearCuts cuts(slab.index, work_.obstacles, work_.weights, faces, &part);
    offers_.offer(s, [&](bool isUpper) { return cuts.offers(isUpper); });
  }
  /// In windows that grow until they tell the distances of all slabs. What a slab leaves: the largest
  /// squared distance, and the reach that told it (0: none has yet).
  void measureInRegion() {
    std::vector<int64_t> unknown{1};
    for (int reach = 32; unknown[0] > 0; reach *= 2) {
      shareBodies(work_, reach);
      work_.forEachSlab([&](size_t s) {
        if (work_.has(kLargest, s) && work_.readVector<int32_t>(kLargest, s).at(1) > 0) return;
        WorkPart part = work_.part(5, 10, s);
        const auto largest = largestInRegion(work_, s, reach, &part);
        work_.writeVector(kLargest, s,
                          std::vector<int32_t>{largest.value_or(0), largest ? reach : 0});
      });
      unknown[0] = 0;
      for (size_t s = work_.firstOwn(); s < work_.endOwn(); ++s) {
        const int told = work_.readVector<int32_t>(kLargest, s).at(1);
        unknown[0] += told == 0 || told > reach;  // in a run before, perhaps
      }
      work_.ranks.sum(unknown);
    }
  }
  void shareLargest() {
    std::vector<int64_t> largest{0};
    for (size_t s = work_.firstOwn(); s < work_.endOwn(); ++s)
      largest[0] = std::max<int64_t>(largest[0], work_.readVector<int32_t>(kLargest, s).at(0));
    work_.ranks.max(largest);
    work_.largestSquaredDistance = int32_t(largest[0]);
    result_.counts.largestSquaredDistance = largest[0];
  }

  /// Power map, flow, contacts within the slab.
  void flowIn(size_t s) {
    WorkPart part = work_.part(isFiltered() ? 65 : 10, 75, s);
    WorkPart mapping(&part, 0, 70), flowing(&part, 70, 100);
    SlabBody slab = work_.body(s);
    PowerMap map = isFiltered() ? completion_.completed(s, slab.index)
                                : slabPowerMap(work_, offers_, s, slab.index, &mapping);
    const VoxelSet balls = medialBalls(slab.index, map, &flowing);
    Flow flowMap = flow(slab.index, std::move(map.site), map.power, balls, &flowing);
    const SlabTerminals terminals =
        slabTerminals(slab.index, flowMap, map.power, balls, slab.cavities, work_.begin(s),
                      work_.end(s), &flowing);
    map.power.clear();
    work_.writeVoxels("flow", s, flowMap.manifold);
    writeRims(work_, s, slab, std::move(flowMap.manifold));
    giveTerminals(work_, s, terminals, slab.index, balls);
  }

  void forgetMaps(size_t s) {
    forgetColumns(work_, s);
    offers_.forget(s);
    if (isFiltered()) completion_.forget(s);
  }

  SlabWork& work_;
  SlabSegmentation& result_;
  SlabOffers offers_;
  SlabCompletion completion_;
};

}  // namespace

void flowInSlabs(SlabWork& work, SlabSegmentation& result) {
  SlabFlow(work, result).run();
}

}  // namespace vdb_madf::detail
