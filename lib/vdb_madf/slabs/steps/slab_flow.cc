// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_flow.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/slabs/cuts/near_cuts.h"
#include "vdb_madf/slabs/cuts/slab_terminals.h"
#include "vdb_madf/slabs/steps/slab_filter.h"
#include "vdb_madf/slabs/steps/slab_graph.h"
#include "vdb_madf/slabs/steps/slab_labels.h"
#include "vdb_madf/slabs/steps/slab_region.h"
#include "vdb_madf/slabs/steps/slab_setup.h"

namespace vdb_madf::detail {

namespace {

class SlabFlow {
 public:
  SlabFlow(SlabWork& work, SlabSegmentation& result)
      : work_(work), result_(result), offers_(work, kOffersOfAllBalls), completion_(work) {}

  void run() {
    work_.steps.beginStage("cavities");
    setUpSlabs(work_, result_);
    if (result_.counts.objectVoxels == 0) return;
    work_.steps.beginStage("offers");
    if (work_.facts.inRegion()) {
      measureInRegion();
      shareLargest();
      shareBodies(work_, mappedReach(work_));
    } else {
      exchangeColumns(work_);
      work_.steps.forEachSlab(Step::offers, [&](size_t s) { offerBalls(s); });
      offers_.passOn();
    }
    if (work_.isFiltered()) {
      work_.steps.beginStage("gamma_filter");
      filterInSlabs(work_, offers_, completion_, result_.counts);
      work_.steps.beginStage("completion");
      completion_.run();
    }
    work_.steps.beginStage("flow");
    work_.steps.forEachSlab(
        Step::flow, [&](size_t s) { flowIn(s); },
        [&](size_t s) {
          if (work_.isFiltered()) completion_.forget(s);
        });
    if (work_.facts.inRegion())
      forgetBodies(work_);
    else
      shareLargest();
    makeParts(work_, result_.counts);
  }

 private:
  void offerBalls(size_t s) {
    WorkPart part = work_.steps.part(Step::offers, s);
    const SlabBody slab = work_.body(s);
    const SlabFaces faces = facesOf(work_, s);
    NearCuts cuts(slab.index, work_.facts.obstacles, work_.facts.weights, faces, &part);
    offers_.offer(s, [&](bool isUpper) { return cuts.offers(isUpper); });
  }
  /// In windows that grow until they tell the distances of all slabs. What a slab leaves: the
  /// largest squared distance, and the reach that told it (0: none has yet).
  void measureInRegion() {
    std::vector<int64_t> unknown{1};
    for (int reach = 32; unknown[0] > 0; reach *= 2) {
      shareBodies(work_, reach);
      work_.steps.forEachSlab(Step::distances, [&](size_t s) {
        if (work_.store.has(kLargest, s) && work_.store.read(kLargest, s).reach > 0) return;
        WorkPart part = work_.steps.part(Step::distances, s);
        const auto largest = largestInRegion(work_, s, reach, &part);
        work_.store.write(kLargest, s, {largest.value_or(0), largest ? reach : 0});
      });
      unknown[0] = 0;
      for (size_t s = work_.plan.firstOwn(); s < work_.plan.endOwn(); ++s) {
        const int told = work_.store.read(kLargest, s).reach;
        unknown[0] += told == 0 || told > reach;  // in a run before, perhaps
      }
      work_.team.sum(unknown);
    }
  }
  void shareLargest() {
    std::vector<int64_t> largest{0};
    for (size_t s = work_.plan.firstOwn(); s < work_.plan.endOwn(); ++s)
      largest[0] = std::max<int64_t>(largest[0], work_.store.read(kLargest, s).squaredDistance);
    work_.team.max(largest);
    work_.facts.largestSquaredDistance = int32_t(largest[0]);
    result_.counts.largestSquaredDistance = largest[0];
  }

  /// Power map, flow, contacts within the slab.
  void flowIn(size_t s) {
    WorkPart part = work_.steps.part(Step::flow, s);
    WorkPart mapping(&part, 0, 70), flowing(&part, 70, 100);
    SlabBody slab = work_.body(s);
    PowerMap map = work_.isFiltered() ? completion_.completed(s, slab.index)
                                      : slabPowerMap(work_, offers_, s, slab.index, &mapping);
    const VoxelSet balls = medialBalls(slab.index, map, &flowing);
    Flow flowMap = flow(slab.index, std::move(map.site), map.power, balls, &flowing);
    const SlabTerminals terminals =
        slabTerminals(slab.index, flowMap, map.power, balls, slab.cavities, work_.plan.begin(s),
                      work_.plan.end(s), &flowing);
    map.power.clear();
    work_.store.write(kFlow, s, flowMap.manifold);
    writeRims(work_, s, slab, std::move(flowMap.manifold));
    giveTerminals(work_, s, terminals, slab.index, balls);
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
