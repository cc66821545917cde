// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_flow.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/slabs/detail/slab_filter.h"
#include "vdb_madf/slabs/detail/slab_labels.h"
#include "vdb_madf/slabs/detail/slab_region.h"
#include "vdb_madf/slabs/detail/slab_setup.h"
#include "vdb_madf/slabs/detail/slab_terminals.h"

namespace vdb_madf::detail {

namespace {

class SlabFlow {
 public:
  SlabFlow(SlabWork& work, SlabSegmentation& result)
      : work_(work),
        result_(result),
        offers_(work, "offers"),
        completion_(work),
        graph_(work.object.cuts) {}

  SlabGraph run() {
    work_.beginStage("cavities");
    setUpSlabs(work_, result_);
    if (result_.counts.objectVoxels == 0) return std::move(graph_);
    work_.beginStage("offers");
    if (work_.inRegion()) {
      measureInRegion();
    } else {
      exchangeColumns(work_);
      work_.forEachSlab([&](size_t s) { offerBalls(s); });
      offers_.passOn();
    }
    shareLargest();
    if (work_.inRegion()) shareBodies(work_, mappedReach(work_));
    if (isFiltered()) {
      work_.beginStage("gamma_filter");
      filterInSlabs(work_, offers_, completion_, result_.counts);
      work_.beginStage("completion");
      completion_.run();
    }
    work_.beginStage("flow");
    work_.forEachSlab([&](size_t s) { flowIn(s); }, [&](size_t s) { forgetMaps(s); });
    if (work_.inRegion()) forgetBodies(work_);
    work_.forEachSlab([&](size_t s) { sendContacts(s); }, [&](size_t s) { forgetFaces(s); });
    work_.beginStage("graph");
    if (work_.isRoot()) gather();
    work_.exchange();
    work_.forEachSlab([&](size_t s) { answer(s); }, [&](size_t s) { work_.remove("balls", s); });
    if (work_.isRoot()) takeAnswers();
    return std::move(graph_);
  }

 private:
  bool isFiltered() const { return work_.options.gamma > 1; }

  void offerBalls(size_t s) {
    WorkPart part = work_.part(5, isFiltered() ? 15 : 30, s);
    const LeafIndex index = work_.body(s).index;
    const SquaredDistance distance = slabDistance(work_, s, index, &part);
    offers_.offer(s, index, distance.values);
    work_.writeVector("largest", s, std::vector<int32_t>{distance.largest});
  }
  /// In windows that grow until they tell the distances of all slabs. What a slab leaves: the largest
  /// squared distance, and the reach that told it (0: none has yet).
  void measureInRegion() {
    std::vector<int64_t> unknown{1};
    for (int reach = 32; unknown[0] > 0; reach *= 2) {
      shareBodies(work_, reach);
      work_.forEachSlab([&](size_t s) {
        if (work_.has("largest", s) && work_.readVector<int32_t>("largest", s).at(1) > 0) return;
        WorkPart part = work_.part(5, isFiltered() ? 15 : 30, s);
        const auto largest = largestInRegion(work_, s, reach, &part);
        work_.writeVector("largest", s,
                          std::vector<int32_t>{largest.value_or(0), largest ? reach : 0});
      });
      unknown[0] = 0;
      for (size_t s = work_.firstOwn(); s < work_.endOwn(); ++s) {
        const int told = work_.readVector<int32_t>("largest", s).at(1);
        unknown[0] += told == 0 || told > reach;  // in a run before, perhaps
      }
      work_.ranks.sum(unknown);
    }
  }
  void shareLargest() {
    std::vector<int64_t> largest{0};
    for (size_t s = work_.firstOwn(); s < work_.endOwn(); ++s)
      largest[0] = std::max<int64_t>(largest[0], work_.readVector<int32_t>("largest", s).at(0));
    work_.ranks.max(largest);
    work_.largestSquaredDistance = int32_t(largest[0]);
    result_.counts.largestSquaredDistance = largest[0];
  }

  /// Power map, flow, contacts within the slab.
  void flowIn(size_t s) {
    WorkPart part = work_.part(isFiltered() ? 50 : 30, 75, s);
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
    ByteWriter flowBytes, terminalBytes;
    flowBytes.add(flowMap.manifold);
    work_.write("flow", s, flowBytes);
    writeRims(work_, s, slab, std::move(flowMap.manifold));
    std::vector<uint64_t> ballWords;
    for (size_t i = 0; i < slab.index.leafCount() * 8; ++i) ballWords.push_back(balls.word(i));
    work_.writeVector("balls", s, ballWords);
    work_.writeVector("lowest", s, terminals.lowest);
    if (s + 1 < work_.slabCount()) work_.sendVector("highest", s, s + 1, terminals.highest);
    terminals.writeTo(terminalBytes);
    work_.send("terminals", s, SlabWork::kRoot, terminalBytes);
  }

  void forgetMaps(size_t s) {
    forgetColumns(work_, s);
    offers_.forget(s);
    if (isFiltered()) completion_.forget(s);
  }

  void sendContacts(size_t s) {
    if (s == 0) return;
    using FaceVoxel = SlabTerminals::FaceVoxel;
    work_.sendVector("contacts", s, SlabWork::kRoot,
                     SlabTerminals::contacts(work_.receiveVector<FaceVoxel>("highest", s - 1, s),
                                             work_.readVector<FaceVoxel>("lowest", s)));
  }
  void forgetFaces(size_t s) {
    work_.removeMessage("highest", s - 1, s);
    work_.remove("lowest", s);
  }

  /// At the root: the terminals of all slabs; asks where the balls flow to at which paths leave a slab.
  void gather() {
    SegmentCounts& counts = result_.counts;
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      ByteReader bytes = work_.receive("terminals", s, SlabWork::kRoot);
      const SlabTerminals terminals = SlabTerminals::readFrom(bytes);
      graph_.add(terminals);
      if (!isFiltered()) counts.medialBalls += terminals.balls;
    }
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      std::vector<Coord> places;
      for (const SlabGraph::Question& question : graph_.questions(s))
        places.push_back(question.position);
      work_.sendVector("questions", SlabWork::kRoot, s, places);
    }
  }

  struct Answer {
    uint32_t terminal;
    uint32_t isOwnBall;  ///< does the slab itself count the ball?
  };
  void answer(size_t s) {
    const auto places = work_.receiveVector<Coord>("questions", SlabWork::kRoot, s);
    std::vector<Answer> answers;
    if (!places.empty()) {
      const SlabBody slab = work_.body(s);
      const auto flowMap = work_.read("flow", s).voxelArray<uint32_t>();
      const auto ballWords = work_.readVector<uint64_t>("balls", s);
      for (const Coord& place : places) {
        const VoxelId id = *slab.index.findVoxel(place);
        answers.push_back(
            {flowMap[slab.index.rank(id)], uint32_t(ballWords[id >> 6] >> bitOf(id) & 1)});
      }
    }
    work_.sendVector("answers", s, SlabWork::kRoot, answers);
  }

  void takeAnswers() {
    SegmentCounts& counts = result_.counts;
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const auto& questions = graph_.questions(s);
      const auto answers = work_.receiveVector<Answer>("answers", s, SlabWork::kRoot);
      for (size_t i = 0; i < questions.size(); ++i) {
        graph_.answer(s, questions[i], answers[i].terminal);
        const bool isRepeated = i > 0 && questions[i - 1].position == questions[i].position;
        if (!isFiltered() && !answers[i].isOwnBall && !isRepeated) ++counts.medialBalls;
      }
    }
    if (!isFiltered()) counts.keptBalls = counts.medialBalls;
  }

  SlabWork& work_;
  SlabSegmentation& result_;
  SlabOffers offers_;
  SlabCompletion completion_;
  SlabGraph graph_;
};

}  // namespace

SlabGraph flowInSlabs(SlabWork& work, SlabSegmentation& result) {
  return SlabFlow(work, result).run();
}

}  // namespace vdb_madf::detail
