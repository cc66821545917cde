// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_flow.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "vdb_madf/method/cavities.h"
#include "vdb_madf/method/detail/check_background.h"
#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/detail/segment_options.h"
#include "vdb_madf/method/detail/slab_faces.h"
#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/slabs/detail/column_steps.h"
#include "vdb_madf/slabs/detail/site_offers.h"
#include "vdb_madf/slabs/detail/slab_terminals.h"

namespace vdb_madf::detail {

namespace {

class SlabFlow {
 public:
  SlabFlow(SlabWork& work, SlabSegmentation& result)
      : work_(work), result_(result), graph_(work.object.cuts) {}

  SlabGraph run() {
    prepare();
    if (result_.counts.objectVoxels > 0) {
      sendStepsUp();
      sendOffersDown();
      flowUp();
      answerQuestions();
    }
    return std::move(graph_);
  }

 private:
  /// Counts, boundary, cavities, weights.
  void prepare() {
    result_.fillHoles = work_.options.fillHoles.value_or(defaultFillHoles(work_.domain));
    result_.tidy = work_.options.tidy;
    SegmentCounts& counts = result_.counts;
    CoordBBox extent;
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const LeafIndex index(LeafIndex(), work_.object.leaves(s));
      work_.obstacles = resolveBoundary(index, work_.options.boundary, work_.domain);
      counts.objectVoxels += index.voxelCount();
      counts.leaves += int64_t(index.leafCount());
      extent.expand(index.boundingBox());
    }
    result_.open = work_.obstacles.open;
    extent.expand(fillHoles());
    const std::array<double, 3> edges = work_.options.weights
                                            ? std::array<double, 3>{1, 1, 1}
                                            : voxelEdges(work_.object.about->transform());
    const WeightsOfEdges weights = resolveWeights(work_.options.weights, edges, extent.dim());
    result_.weights = weights.weights;
    result_.weightsError = weights.error;
    checkBackground(work_.obstacles, counts.objectVoxels);
  }

  /// Returns the box of what is filled.
  CoordBBox fillHoles() {
    SegmentCounts& counts = result_.counts;
    const __int128 background =
        work_.obstacles.open ? work_.obstacles.domain.voxelCount() - counts.objectVoxels : 0;
    const bool any = result_.fillHoles > 1 && counts.objectVoxels > 0 &&
                     !(work_.obstacles.open && background < result_.fillHoles);
    HoleCount holes;
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      if (!work_.has("cavities", s)) {
        WorkPart part = work_.part(0, 5, s);
        std::vector<LeafIndex::LeafVoxels> found;
        if (any)
          found = slabHoles(work_.object, work_.domain, s, result_.open, result_.fillHoles, &part);
        work_.writeVector("cavities", s, found);
      }
      holes.add(work_.readVector<LeafIndex::LeafVoxels>("cavities", s), work_.begin(s),
                work_.end(s));
    }
    // Not all background may be filled.
    work_.fillsNone = work_.obstacles.open && background == holes.voxels();
    if (work_.fillsNone) return {};
    counts.cavities = holes.count();
    counts.cavityVoxels = holes.voxels();
    return holes.boundingBox();
  }

  SlabFaces faces(size_t slab) const {
    SlabFaces faces;
    faces.begin = work_.begin(slab);
    faces.end = work_.end(slab);
    faces.hasBelow = slab > 0;
    faces.hasAbove = slab + 1 < work_.slabCount();
    return faces;
  }

  void writeSteps(const char* what, size_t slab, const ColumnSteps& steps) {
    ByteWriter bytes;
    bytes.add(steps.leaves());
    bytes.add(steps.rows());
    work_.write(what, slab, bytes);
  }
  ColumnSteps readSteps(const char* what, size_t slab) const {
    ByteReader bytes = work_.read(what, slab);
    auto leaves = bytes.vector<std::array<int, 2>>();
    return {std::move(leaves), bytes.vector<ColumnSteps::Rows>()};
  }

  /// From the lowest slab on, how far the background of each column is below its upper cut.
  void sendStepsUp() {
    for (size_t s = 0; s + 1 < work_.slabCount(); ++s) {
      if (work_.has("below", s + 1) || work_.has("terminals", s + 1)) continue;
      SlabFaces at = faces(s);
      at.below = stepsBelow(s);
      writeSteps("below", s + 1, columnSteps(work_.body(s).index, work_.obstacles, at, false));
    }
  }

  /// From the highest slab on: how far the background is above, and the balls that win below.
  void sendOffersDown() {
    for (size_t s = work_.slabCount(); s-- > 1;) {
      if (work_.has("offered-down", s - 1) || work_.has("terminals", s - 1)) continue;
      WorkPart part = work_.part(5, 30, work_.slabCount() - 1 - s);
      const SlabBody slab = work_.body(s);
      SlabFaces at = faces(s);
      at.below = stepsBelow(s);
      at.above = stepsAbove(s);
      writeSteps("above", s - 1, columnSteps(slab.index, work_.obstacles, at, true));
      const SquaredDistance distance =
          squaredDistanceInSlab(slab.index, work_.obstacles, result_.weights, at, &part);
      work_.writeVector("offered-down", s - 1,
                        siteOffers(slab.index, distance, offersDown(s), at.begin, at.end, false));
    }
  }

  /// What came from the slab below, and from that above; nothing at the ends of the object.
  ColumnSteps stepsBelow(size_t s) const { return s == 0 ? ColumnSteps() : readSteps("below", s); }
  ColumnSteps stepsAbove(size_t s) const {
    return s + 1 == work_.slabCount() ? ColumnSteps() : readSteps("above", s);
  }
  std::vector<ForeignSite> offersUp(size_t s) const {
    if (s == 0) return {};
    return work_.readVector<ForeignSite>("offered-up", s);
  }
  std::vector<ForeignSite> offersDown(size_t s) const {
    if (s + 1 == work_.slabCount()) return {};
    return work_.readVector<ForeignSite>("offered-down", s);
  }

  /// From the lowest slab on: distance, power map, flow.
  void flowUp() {
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      if (!work_.has("terminals", s)) flowIn(s);
      ByteReader bytes = work_.read("terminals", s);
      const SlabTerminals terminals = SlabTerminals::readFrom(bytes);
      graph_.add(terminals);
      result_.counts.medialBalls += terminals.balls;
      result_.counts.largestSquaredDistance = std::max<int64_t>(
          result_.counts.largestSquaredDistance, terminals.largestSquaredDistance);
      for (const char* what : {"below", "above", "offered-down", "offered-up"})
        work_.remove(what, s);
    }
  }

  void flowIn(size_t s) {
    WorkPart part = work_.part(30, 75, s);
    WorkPart measuring(&part, 0, 25), mapping(&part, 25, 70), flowing(&part, 70, 100);
    SlabBody slab = work_.body(s);
    SlabFaces at = faces(s);
    at.below = stepsBelow(s);
    at.above = stepsAbove(s);
    SquaredDistance distance =
        squaredDistanceInSlab(slab.index, work_.obstacles, result_.weights, at, &measuring);
    const int32_t largest = distance.largest;
    const std::vector<ForeignSite> fromBelow = offersUp(s);
    if (at.hasAbove)
      work_.writeVector("offered-up", s + 1,
                        siteOffers(slab.index, distance, fromBelow, at.begin, at.end, true));
    distance.foreign =
        std::make_shared<ForeignSites>(fromBelow, offersDown(s), at.begin, at.end, slab.index);

    PowerMap map = powerMap(slab.index, std::move(distance), &mapping);
    const VoxelSet balls = medialBalls(slab.index, map, &flowing);
    const Flow flowMap = flow(slab.index, std::move(map.site), map.power, balls, &flowing);
    SlabTerminals terminals = slabTerminals(slab.index, flowMap, map.power, balls, slab.cavities,
                                            at.begin, at.end, &flowing);
    terminals.largestSquaredDistance = largest;
    map.power.clear();
    ByteWriter flowBytes, terminalBytes;
    flowBytes.add(flowMap.manifold);
    work_.write("flow", s, flowBytes);
    std::vector<uint64_t> ballWords;
    for (size_t i = 0; i < slab.index.leafCount() * 8; ++i) ballWords.push_back(balls.word(i));
    work_.writeVector("balls", s, ballWords);
    terminals.writeTo(terminalBytes);
    work_.write("terminals", s, terminalBytes);  // the last: the slab is done
  }

  /// Where the balls flow to at which paths leave a slab.
  void answerQuestions() {
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const auto& questions = graph_.questions(s);
      if (!work_.has("answers", s)) work_.writeVector("answers", s, answersTo(questions, s));
      work_.remove("balls", s);
      const auto answers = work_.readVector<Answer>("answers", s);
      for (size_t i = 0; i < questions.size(); ++i) {
        graph_.answer(s, questions[i], answers[i].terminal);
        const bool isRepeated = i > 0 && questions[i - 1].position == questions[i].position;
        if (!answers[i].isOwnBall && !isRepeated) ++result_.counts.medialBalls;
      }
    }
  }

  struct Answer {
    uint32_t terminal;
    uint32_t isOwnBall;  ///< does the slab itself count the ball?
  };
  std::vector<Answer> answersTo(const std::vector<SlabGraph::Question>& questions, size_t s) const {
    std::vector<Answer> answers;
    if (questions.empty()) return answers;
    const SlabBody slab = work_.body(s);
    const auto flowMap = work_.read("flow", s).voxelArray<uint32_t>();
    const auto ballWords = work_.readVector<uint64_t>("balls", s);
    for (const auto& question : questions) {
      const VoxelId id = *slab.index.findVoxel(question.position);
      answers.push_back(
          {flowMap[slab.index.rank(id)], uint32_t(ballWords[id >> 6] >> bitOf(id) & 1)});
    }
    return answers;
  }

  SlabWork& work_;
  SlabSegmentation& result_;
  SlabGraph graph_;
};

}  // namespace

SlabGraph flowInSlabs(SlabWork& work, SlabSegmentation& result) {
  return SlabFlow(work, result).run();
}

}  // namespace vdb_madf::detail
