// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/segment_slabs.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/cavities.h"
#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/detail/manifold_labels.h"
#include "vdb_madf/method/detail/segment_options.h"
#include "vdb_madf/method/detail/slab_faces.h"
#include "vdb_madf/method/detail/tidy_steps.h"
#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/slabs/detail/column_steps.h"
#include "vdb_madf/slabs/detail/site_offers.h"
#include "vdb_madf/slabs/detail/slab_body.h"
#include "vdb_madf/slabs/detail/slab_graph.h"
#include "vdb_madf/slabs/detail/slab_pieces.h"
#include "vdb_madf/slabs/detail/slab_smoothing.h"
#include "vdb_madf/slabs/detail/slab_terminals.h"

namespace vdb_madf {

namespace {

using detail::ByteReader;
using detail::ByteWriter;
using detail::ForeignSite;
using detail::SlabBody;

using PutLabels =
    std::function<void(size_t slab, const LeafIndex& index, const VoxelArray<uint32_t>& labels)>;

void checkSlabOptions(const SlabObject& object, const SegmentOptions& options) {
  detail::checkSegmentOptions(options);
  if (options.gamma > 1)
    throw InvalidInput("the filter by cells (gamma) does not work in slabs yet: leave it out");
  if (options.keepDistance || options.keepPower || options.keepManifold || options.keepBalls)
    throw InvalidInput("slabs give labels alone: keep no other grids");
  if (object.domain && !object.domain->isBox())
    throw InvalidInput("a region cannot be cut into slabs yet: take a box as domain");
  const std::vector<int>& cuts = object.cuts;
  for (size_t i = 0; i < cuts.size(); ++i)
    if ((cuts[i] & 7) != 0 || (i > 0 && cuts[i] <= cuts[i - 1]))
      throw InvalidInput("slabs are cut at ascending multiples of 8 along z");
  for (size_t s = 0; s < object.slabCount(); ++s)
    if (object.slabCount() > 1 && cuts[s + 1] - cuts[s] < options.tidy)
      throw InvalidInput("interfaces are smoothed in " + std::to_string(options.tidy) +
                         " rounds: take slabs at least as many voxels high");
}

/// The stages, slab after slab. What they leave in scratch has the name of what it is and the
/// number of the slab.
class SlabMethod {
 public:
  SlabMethod(const SlabObject& object, const SegmentOptions& options, Scratch& scratch,
             Interrupter* interrupter)
      : object_(object),
        options_(options),
        scratch_(scratch),
        interrupter_(interrupter),
        graph_(object.cuts) {}

  SlabSegmentation run(const PutLabels& put) {
    prepare();
    if (result_.counts.objectVoxels == 0) return std::move(result_);
    sendStepsUp();
    sendOffersDown();
    flowUp();
    answerQuestions();
    mergeGraph();
    label(put);
    return std::move(result_);
  }

 private:
  size_t slabCount() const { return object_.slabCount(); }
  int begin(size_t slab) const { return object_.cuts[slab]; }
  int end(size_t slab) const { return object_.cuts[slab + 1]; }

  void write(const char* what, size_t slab, const ByteWriter& bytes) {
    scratch_.write(what + std::to_string(slab), bytes.bytes());
  }
  ByteReader read(const char* what, size_t slab) const {
    return ByteReader(scratch_.read(what + std::to_string(slab)));
  }
  void remove(const char* what, size_t slab) { scratch_.remove(what + std::to_string(slab)); }

  template <typename T>
  void writeVector(const char* what, size_t slab, const std::vector<T>& values) {
    ByteWriter bytes;
    bytes.add(values);
    write(what, slab, bytes);
  }
  template <typename T>
  std::vector<T> readVector(const char* what, size_t slab) const {
    return read(what, slab).vector<T>();
  }

  void writeSteps(const char* what, size_t slab, const detail::ColumnSteps& steps) {
    ByteWriter bytes;
    bytes.add(steps.leaves());
    bytes.add(steps.rows());
    write(what, slab, bytes);
  }
  detail::ColumnSteps readSteps(const char* what, size_t slab) const {
    ByteReader bytes = read(what, slab);
    auto leaves = bytes.vector<std::array<int, 2>>();
    return {std::move(leaves), bytes.vector<detail::ColumnSteps::Rows>()};
  }

  /// Counts, boundary, cavities, weights.
  void prepare() {
    result_.fillHoles = options_.fillHoles.value_or(defaultFillHoles(object_.domain));
    result_.tidy = options_.tidy;
    SegmentCounts& counts = result_.counts;
    for (size_t s = 0; s < slabCount(); ++s) {
      const LeafIndex index(LeafIndex(), object_.leaves(s));
      obstacles_ = resolveBoundary(index, options_.boundary, object_.domain);
      counts.objectVoxels += index.voxelCount();
      counts.leaves += int64_t(index.leafCount());
    }
    result_.open = obstacles_.open;
    fillHoles();
    CoordBBox extent;
    for (size_t s = 0; s < slabCount(); ++s) extent.expand(body(s).index.boundingBox());
    const WeightsOfEdges weights =
        detail::resolveWeights(options_.weights, object_.edges, extent.dim());
    result_.weights = weights.weights;
    result_.weightsError = weights.error;
    if (obstacles_.open && counts.objectVoxels > 0 &&
        counts.objectVoxels == obstacles_.domain.voxelCount())
      throw InvalidInput(
          "the object fills the whole domain, so there is no background to measure distances from; "
          "choose by value what is object, with a threshold or a phase");
  }

  void fillHoles() {
    SegmentCounts& counts = result_.counts;
    const __int128 background =
        obstacles_.open ? obstacles_.domain.voxelCount() - counts.objectVoxels : 0;
    const bool any = result_.fillHoles > 1 && counts.objectVoxels > 0 &&
                     !(obstacles_.open && background < result_.fillHoles);
    detail::HoleCount holes;
    for (size_t s = 0; s < slabCount(); ++s) {
      std::vector<LeafIndex::LeafVoxels> cavities;
      if (any)
        cavities = detail::slabHoles(object_, s, result_.open, result_.fillHoles, interrupter_);
      holes.add(cavities, begin(s), end(s));
      writeVector("cavities", s, cavities);
    }
    if (obstacles_.open && background == holes.voxels()) {
      for (size_t s = 0; s < slabCount(); ++s)
        writeVector("cavities", s, std::vector<LeafIndex::LeafVoxels>());
      return;
    }
    counts.cavities = holes.count();
    counts.cavityVoxels = holes.voxels();
  }

  SlabBody body(size_t slab) const {
    return SlabBody(object_.leaves(slab), readVector<LeafIndex::LeafVoxels>("cavities", slab));
  }

  detail::SlabFaces faces(size_t slab) const {
    detail::SlabFaces faces;
    faces.begin = begin(slab);
    faces.end = end(slab);
    faces.hasBelow = slab > 0;
    faces.hasAbove = slab + 1 < slabCount();
    return faces;
  }

  /// From the lowest slab on, how far the background of each column is below its upper cut.
  void sendStepsUp() {
    detail::ColumnSteps below;
    for (size_t s = 0; s < slabCount(); ++s) {
      writeSteps("below", s, below);
      detail::SlabFaces at = faces(s);
      at.below = std::move(below);
      below = detail::columnSteps(body(s).index, obstacles_, at, false);
    }
  }

  /// From the highest slab on: how far the background is above, and the balls that win below. These
  /// and those stay for flowUp().
  void sendOffersDown() {
    detail::ColumnSteps above;
    std::vector<ForeignSite> offered;
    for (size_t s = slabCount(); s-- > 0;) {
      const SlabBody slab = body(s);
      detail::SlabFaces at = faces(s);
      at.below = readSteps("below", s);
      at.above = std::move(above);
      writeSteps("above", s, at.above);
      writeVector("offered", s, offered);
      above = detail::columnSteps(slab.index, obstacles_, at, true);
      if (s == 0) break;
      const SquaredDistance distance =
          squaredDistanceInSlab(slab.index, obstacles_, result_.weights, at, interrupter_);
      offered = siteOffers(slab.index, distance, offered, at.begin, at.end, false);
    }
  }

  /// From the lowest slab on: distance, power map, flow, contacts.
  void flowUp() {
    std::vector<ForeignSite> offered;
    std::vector<detail::SlabTerminals::FaceVoxel> below;
    for (size_t s = 0; s < slabCount(); ++s) {
      SlabBody slab = body(s);
      detail::SlabFaces at = faces(s);
      at.below = readSteps("below", s);
      at.above = readSteps("above", s);
      SquaredDistance distance =
          squaredDistanceInSlab(slab.index, obstacles_, result_.weights, at, interrupter_);
      result_.counts.largestSquaredDistance =
          std::max<int64_t>(result_.counts.largestSquaredDistance, distance.largest);
      const std::vector<ForeignSite> onward =
          siteOffers(slab.index, distance, offered, at.begin, at.end, true);
      distance.foreign = std::make_shared<detail::ForeignSites>(
          offered, readVector<ForeignSite>("offered", s), at.begin, at.end, slab.index);
      offered = onward;

      PowerMap map = powerMap(slab.index, std::move(distance), interrupter_);
      const VoxelSet balls = medialBalls(slab.index, map, interrupter_);
      const Flow flowMap = flow(slab.index, std::move(map.site), map.power, balls, interrupter_);
      detail::SlabTerminals terminals = detail::slabTerminals(
          slab.index, flowMap, map.power, balls, slab.cavities, at.begin, at.end, interrupter_);
      graph_.add(terminals);
      if (s > 0) graph_.addContacts(detail::SlabTerminals::contacts(below, terminals.lowest));
      below = std::move(terminals.highest);
      result_.counts.medialBalls += terminals.balls;

      ByteWriter flowBytes;
      flowBytes.add(flowMap.manifold);
      write("flow", s, flowBytes);
      std::vector<uint64_t> ballWords;
      for (size_t i = 0; i < slab.index.leafCount() * 8; ++i) ballWords.push_back(balls.word(i));
      writeVector("balls", s, ballWords);
      remove("below", s);
      remove("above", s);
      remove("offered", s);
    }
  }

  /// Where the balls flow to at which paths leave a slab.
  void answerQuestions() {
    for (size_t s = 0; s < slabCount(); ++s) {
      const auto& questions = graph_.questions(s);
      const auto ballWords = readVector<uint64_t>("balls", s);
      remove("balls", s);
      if (questions.empty()) continue;
      const SlabBody slab = body(s);
      const auto flowMap = read("flow", s).voxelArray<uint32_t>();
      for (size_t i = 0; i < questions.size(); ++i) {
        const VoxelId id = *slab.index.findVoxel(questions[i].position);
        graph_.answer(s, questions[i], flowMap[slab.index.rank(id)]);
        const bool isKnown = ballWords[id >> 6] >> bitOf(id) & 1;
        const bool isRepeated = i > 0 && questions[i - 1].position == questions[i].position;
        if (!isKnown && !isRepeated) ++result_.counts.medialBalls;
      }
    }
  }

  void mergeGraph() {
    result_.graph = graph_.finish();
    result_.graph.weights = result_.weights;
    merging_ = merge(result_.graph, options_.merge);
    SegmentCounts& counts = result_.counts;
    counts.keptBalls = counts.medialBalls;
    counts.criticalPoints = int64_t(result_.graph.nodes.size());
    counts.grains = int64_t(merging_.representative.size());
    result_.grainVoxels.assign(size_t(counts.grains), 0);
  }

  /// Labels as merged.
  VoxelArray<uint32_t> mergedLabels(size_t s, const SlabBody& slab) const {
    auto labels = read("flow", s).voxelArray<uint32_t>();
    const std::vector<uint32_t> nodes = graph_.nodesOf(s);
    for (size_t i = 0; i < labels.size(); ++i)
      labels[i] = uint32_t(merging_.grainOfNode[nodes[(labels[i] & ~Flow::kOwnCell) - 1]]);
    for (const VoxelId id : slab.cavities) labels[slab.index.rank(id)] = 0;
    return labels;
  }

  void label(const PutLabels& put) {
    if (options_.tidy > 0) tidyLabels();
    size_t next = 0;  // of the loose voxels by slab
    for (size_t s = 0; s < slabCount(); ++s) {
      const SlabBody slab = body(s);
      VoxelArray<uint32_t> labels =
          options_.tidy > 0 ? read("labels", s).voxelArray<uint32_t>() : mergedLabels(s, slab);
      remove(options_.tidy > 0 ? "labels" : "flow", s);
      remove("cavities", s);
      for (; next < loose_.size() && loose_[next].position.z() < end(s); ++next)
        labels[slab.index.rank(*slab.index.findVoxel(loose_[next].position))] = loose_[next].label;
      for (size_t i = 0; i < labels.size(); ++i)
        if (labels[i] > 0) ++result_.grainVoxels[labels[i] - 1];
      put(s, slab.index, labels);
    }
  }

  void tidyLabels() {
    const detail::Anchors anchors = findAnchors();
    smooth(anchors);
    joinPieces();
  }

  /// The voxel of each grain that never changes: its representative, or the nearest to it if that lies
  /// in a cavity.
  detail::Anchors findAnchors() const {
    GrainLabels grains = detail::grainsOf(result_.graph, merging_);
    detail::Anchors anchors = grains.representative;
    std::vector<uint32_t> lost;
    for (size_t s = 0; s < slabCount(); ++s) {
      const LeafIndex cavities(LeafIndex(), readVector<LeafIndex::LeafVoxels>("cavities", s));
      if (cavities.voxelCount() == 0) continue;
      for (uint32_t g = 0; g < anchors.size(); ++g)
        if (cavities.findVoxel(anchors[g])) lost.push_back(g);
    }
    if (lost.empty()) return anchors;
    std::vector<detail::AnchorCandidate> best(lost.size());
    for (size_t s = 0; s < slabCount(); ++s) {
      const SlabBody slab = body(s);
      grains.label = mergedLabels(s, slab);
      const auto found = detail::anchorCandidates(slab.index, grains, lost, interrupter_);
      for (size_t i = 0; i < lost.size(); ++i) best[i].improve(found[i]);
    }
    for (size_t i = 0; i < lost.size(); ++i) anchors[lost[i]] = best[i].position;
    return anchors;
  }

  /// Labels beyond the cuts are those before any smoothing, so they are kept until the next slab has
  /// seen them.
  void smooth(const detail::Anchors& anchors) {
    const int reach = (options_.tidy + 7) / 8 * 8;
    detail::LeafLabels below;
    SlabBody slab = body(0);
    VoxelArray<uint32_t> labels = mergedLabels(0, slab);
    for (size_t s = 0; s < slabCount(); ++s) {
      SlabBody slabAbove;
      VoxelArray<uint32_t> labelsAbove;
      detail::LeafLabels above;
      if (s + 1 < slabCount()) {
        slabAbove = body(s + 1);
        labelsAbove = mergedLabels(s + 1, slabAbove);
        above = detail::labelsBetween(slabAbove.index, labelsAbove, end(s), end(s) + reach);
      }
      detail::LeafLabels highest =
          detail::labelsBetween(slab.index, labels, end(s) - reach, end(s));
      smoothSlab(slab.index, below, above, anchors, options_.tidy, labels, interrupter_);
      writeLabels(s, slab, labels, anchors);
      below = std::move(highest);
      slab = std::move(slabAbove);
      labels = std::move(labelsAbove);
    }
  }

  void writeLabels(size_t s, const SlabBody& slab, const VoxelArray<uint32_t>& labels,
                   const detail::Anchors& anchors) {
    const detail::ConnectedComponents components(slab.index, labels, interrupter_);
    ByteWriter labelBytes, pieceBytes;
    labelBytes.add(labels);
    write("labels", s, labelBytes);
    remove("flow", s);
    detail::SlabPieces(slab.index, labels, components, anchors, begin(s), end(s))
        .writeTo(pieceBytes);
    write("pieces", s, pieceBytes);
  }

  std::optional<detail::SlabPieces> pieces(size_t slab) const {
    if (slab >= slabCount()) return std::nullopt;
    ByteReader bytes = read("pieces", slab);
    return detail::SlabPieces::readFrom(bytes);
  }

  void joinPieces() {
    detail::PieceUnion all;
    std::optional<detail::SlabPieces> below;
    for (size_t s = 0; s < slabCount(); ++s) {
      std::optional<detail::SlabPieces> here = pieces(s);
      all.add(*here, below ? &*below : nullptr);
      below = std::move(here);
    }
    below.reset();
    std::optional<detail::SlabPieces> here = pieces(0);
    for (size_t s = 0; s < slabCount(); ++s) {
      std::optional<detail::SlabPieces> above = pieces(s + 1);
      const SlabBody slab = body(s);
      const auto labels = read("labels", s).voxelArray<uint32_t>();
      const detail::ConnectedComponents components(slab.index, labels, interrupter_);
      const auto found = looseVoxels(slab.index, labels, components, s, begin(s), end(s),
                                     below ? &*below : nullptr, above ? &*above : nullptr, all);
      loose_.insert(loose_.end(), found.begin(), found.end());
      below = std::move(here);
      here = std::move(above);
    }
    for (size_t s = 0; s < slabCount(); ++s) remove("pieces", s);
    refill(loose_);
    std::stable_sort(loose_.begin(), loose_.end(),
                     [](const auto& a, const auto& b) { return a.position.z() < b.position.z(); });
  }

  const SlabObject& object_;
  const SegmentOptions& options_;
  Scratch& scratch_;
  Interrupter* interrupter_;
  Obstacles obstacles_;
  detail::SlabGraph graph_;
  Merging merging_;
  std::vector<detail::LooseVoxel> loose_;
  SlabSegmentation result_;
};

}  // namespace

SlabSegmentation segmentSlabs(const SlabObject& object, const SegmentOptions& options,
                              Scratch& scratch, const PutLabels& put, Interrupter* interrupter) {
  checkSlabOptions(object, options);
  return SlabMethod(object, options, scratch, interrupter).run(put);
}

}  // namespace vdb_madf
