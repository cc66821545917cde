// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_labels.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/leaf_grid.h"
#include "vdb_madf/method/detail/tidy_steps.h"
#include "vdb_madf/slabs/cuts/slab_pieces.h"
#include "vdb_madf/slabs/cuts/slab_smoothing.h"

namespace vdb_madf::detail {

/// Which pieces of a slab, and of those beside it, are part of one that holds an anchor?
struct HeldPieces {
  std::vector<char> below, own, above;

  template <typename Self>
  static auto storedFields(Self& self) {
    return std::tie(self.below, self.own, self.above);
  }
};

struct CountedLabel {
  uint64_t label;
  int64_t voxels;
};

namespace {

/// Voxels per task of a loop over them.
constexpr size_t kVoxelGrain = size_t(1) << 16;

class SlabLabels {
 public:
  SlabLabels(SlabWork& work, SlabSegmentation& result) : work_(work), result_(result) {}

  void run(std::vector<Coord> representatives, const PutLabels& put) {
    grains_.representative = std::move(representatives);
    const bool isTidied = work_.options.tidy > 0 && result_.counts.objectVoxels > 0;
    if (isTidied) {
      work_.steps.beginStage("tidy");
      tidyLabels();
    }
    work_.steps.beginStage("labels");
    work_.steps.forEachSlab(Step::labels, [&](size_t s) { putLabels(s, isTidied, put); });
    if (!work_.plan.isRoot()) return;
    for (size_t s = 0; s < work_.plan.slabCount(); ++s)
      for (const auto& [label, voxels] : work_.store.receive(kCounts, s, kRoot))
        result_.grainVoxels[label - 1] += voxels;
  }

 private:
  /// Labels as merged.
  VoxelArray<uint32_t> mergedLabels(size_t s, const SlabBody& slab) const {
    auto labels = work_.store.read(kFlow, s);
    const auto grains = work_.store.read(kGrains, s);
    parallelForEach(labels.size(), kVoxelGrain, nullptr,
                    [&](size_t i) { labels[i] = grains[(labels[i] & ~Flow::kOwnCell) - 1]; });
    for (const VoxelId id : slab.cavities) labels[slab.index.rank(id)] = 0;
    return labels;
  }

  void putLabels(size_t s, bool isTidied, const PutLabels& put) {
    if (result_.counts.objectVoxels == 0) {
      put(s, SlabBody(), {});
      work_.store.write(kPut, s, 1);
      return;
    }
    const SlabBody slab = work_.body(s);
    VoxelArray<uint32_t> labels = isTidied ? work_.store.read(kLabels, s) : mergedLabels(s, slab);
    for (const LooseVoxel& voxel : work_.store.receive(kRefilled, kRoot, s))
      labels[slab.index.rank(*slab.index.findVoxel(voxel.position))] = voxel.label;
    const auto counts = countLabels(labels);
    put(s, slab, std::move(labels));
    work_.store.send(kCounts, s, kRoot, counts);
    work_.store.write(kPut, s, 1);
  }

  std::vector<CountedLabel> countLabels(const VoxelArray<uint32_t>& labels) const {
    std::vector<int64_t> voxels(size_t(result_.counts.grains) + 1, 0);
    parallelFor(labels.size(), kVoxelGrain, nullptr, [&](size_t begin, size_t end) {
      for (size_t i = begin, next; i < end; i = next) {  // voxels of one label follow each other
        for (next = i + 1; next < end && labels[next] == labels[i];) ++next;
        __atomic_fetch_add(&voxels[labels[i]], int64_t(next - i), __ATOMIC_RELAXED);
      }
    });
    std::vector<CountedLabel> counts;
    for (size_t label = 1; label < voxels.size(); ++label)
      if (voxels[label] > 0) counts.push_back({label, voxels[label]});
    return counts;
  }

  void tidyLabels() {
    shareAnchors();
    work_.steps.forEachSlab(Step::rims, [&](size_t s) { sendRims(s); });
    work_.steps.forEachSlab(Step::smoothing, [&](size_t s) { smooth(s); });
    work_.steps.forEachSlab(Step::joins, [&](size_t s) { joinPieces(s); });
    if (work_.plan.isRoot()) findHeld();
    work_.steps.exchange();
    work_.steps.forEachSlab(Step::loose, [&](size_t s) { findLoose(s); });
    if (work_.plan.isRoot()) refillLoose();
    work_.steps.exchange();
  }

  /// The voxel of each grain that never changes: its representative, or the nearest to it if that
  /// lies in a cavity. Known at all members.
  void shareAnchors() {
    Lost lost;
    if (work_.plan.isRoot()) lost = findLost();
    grains_.representative = work_.store.broadcast(grains_.representative);
    lost = work_.store.broadcast(lost);
    grains_.weights = work_.facts.weights;
    anchors_ = grains_.representative;
    work_.steps.forEachSlab(Step::anchors, [&](size_t s) {
      if (lost.empty()) return;
      const SlabBody slab = work_.body(s);
      grains_.label = mergedLabels(s, slab);
      work_.store.send(kAnchors, s, kRoot,
                       anchorCandidates(slab.index, grains_, lost, work_.interrupter));
    });
    if (lost.empty()) return;
    if (work_.plan.isRoot()) replaceLost(lost);
    anchors_ = work_.store.broadcast(anchors_);
  }

  using Lost = std::vector<uint32_t>;  // grains whose representative is in a cavity

  Lost findLost() const {
    Lost lost;
    if (work_.facts.fillsNone) return lost;
    for (size_t s = 0; s < work_.plan.slabCount(); ++s) {
      const LeafIndex holes(work_.store.receive(kHoles, s, kRoot));
      if (holes.voxelCount() == 0) continue;
      for (uint32_t g = 0; g < grains_.representative.size(); ++g) {
        const Coord& p = grains_.representative[g];
        if (holes.boundingBox().isInside(p) && holes.findVoxel(p)) lost.push_back(g);
      }
    }
    return lost;
  }

  void replaceLost(const Lost& lost) {
    std::vector<AnchorCandidate> best(lost.size());
    for (size_t s = 0; s < work_.plan.slabCount(); ++s) {
      const auto found = work_.store.receive(kAnchors, s, kRoot);
      for (size_t i = 0; i < lost.size(); ++i) best[i].improve(found[i]);
    }
    for (size_t i = 0; i < lost.size(); ++i) anchors_[lost[i]] = best[i].position;
  }

  /// Labels as merged, as far from the cuts as the slabs beyond them have to see.
  void sendRims(size_t s) {
    const auto grains = work_.store.read(kGrains, s);
    const auto send = [&](const Piece<LeafLabels>& side, size_t to) {
      LeafLabels rim = work_.store.read(side, s);
      for (uint32_t& label : rim.labels)
        if (label != 0) label = grains[(label & ~Flow::kOwnCell) - 1];
      work_.store.send(kRim, s, to, rim);
    };
    if (s > 0) send(kLowestRim, s - 1);
    if (s + 1 < work_.plan.slabCount()) send(kHighestRim, s + 1);
  }
  LeafLabels rim(size_t from, size_t s) const { return work_.store.receive(kRim, from, s); }

  void smooth(size_t s) {
    WorkPart part = work_.steps.part(Step::smoothing, s);
    WorkPart smoothing(&part, 0, 70), finding(&part, 70, 85), joining(&part, 85, 100);
    const SlabBody slab = work_.body(s);
    VoxelArray<uint32_t> labels = mergedLabels(s, slab);
    smoothSlab(slab.index, rim(s - 1, s), rim(s + 1, s), anchors_, work_.options.tidy, labels,
               &smoothing);
    const LabelMasks masks(slab.index, labels, &finding);
    const ConnectedComponents components(slab.index, masks, &joining);
    work_.store.write(kLabels, s, labels);
    const std::vector<char> hasAnchor = piecesWithAnchor(slab.index, labels, components, anchors_);
    work_.store.send(kPieces, s, kRoot, hasAnchor);
    work_.store.write(kWithoutAnchor, s, piecesWithoutAnchor(slab.index, components, hasAnchor));
    const auto face = [&](bool isUpper) {
      return facePieces(slab.index, components, work_.plan.cut(s, isUpper));
    };
    const std::vector<FacePiece> lowest = face(false);
    work_.store.write(kLowestPieces, s, lowest);
    if (s > 0) work_.store.send(kFacePieces, s, s - 1, lowest);
    if (s + 1 < work_.plan.slabCount()) work_.store.send(kFacePieces, s, s + 1, face(true));
  }

  void joinPieces(size_t s) {
    if (s == 0) return;
    work_.store.send(
        kJoinedPieces, s, kRoot,
        pieceJoins(work_.store.receive(kFacePieces, s - 1, s), work_.store.read(kLowestPieces, s)));
  }

  /// At the root: which pieces are part of one that holds an anchor.
  void findHeld() {
    PieceUnion pieces;
    const size_t slabs = work_.plan.slabCount();
    std::vector<std::vector<char>> held(slabs);
    for (size_t s = 0; s < slabs; ++s) {
      held[s] = work_.store.receive(kPieces, s, kRoot);
      pieces.add(held[s].size(), work_.store.receive(kJoinedPieces, s, kRoot));
    }
    std::vector<char> isHeld(pieces.size(), 0);
    for (size_t s = 0; s < slabs; ++s)
      for (uint32_t i = 0; i < held[s].size(); ++i)
        if (held[s][i]) isHeld[pieces.find(s, i)] = 1;
    for (size_t s = 0; s < slabs; ++s)
      for (uint32_t i = 0; i < held[s].size(); ++i) held[s][i] = isHeld[pieces.find(s, i)];
    for (size_t s = 0; s < slabs; ++s) {
      const std::vector<char> none;
      work_.store.send(kHeld, kRoot, s,
                       {s > 0 ? held[s - 1] : none, held[s], s + 1 < slabs ? held[s + 1] : none});
    }
  }

  void findLoose(size_t s) {
    HeldPieces held = work_.store.receive(kHeld, kRoot, s);
    BeyondPieces below, above;
    below.isHeld = std::move(held.below);
    above.isHeld = std::move(held.above);
    std::vector<LeafPiece> loose = work_.store.read(kWithoutAnchor, s);
    loose.erase(std::remove_if(
                    loose.begin(), loose.end(),
                    [&](const LeafPiece& piece) { return held.own[piece.piece.component] != 0; }),
                loose.end());
    std::vector<LooseVoxel> voxels;
    if (!loose.empty()) {
      below.face = work_.store.receive(kFacePieces, s - 1, s);
      above.face = work_.store.receive(kFacePieces, s + 1, s);
      voxels = looseVoxels(work_.body(s).index, work_.store.read(kLabels, s), loose,
                           work_.plan.begin(s), work_.plan.end(s), below, above);
    }
    work_.store.send(kLoose, s, kRoot, voxels);
  }

  /// At the root: the voxels that no path of their label joins with its anchor get other labels.
  void refillLoose() {
    std::vector<LooseVoxel> loose = work_.store.receiveAll(kLoose, kRoot);
    refillAll(loose, work_.interrupter);
    std::vector<std::vector<LooseVoxel>> of(work_.plan.slabCount());
    for (const LooseVoxel& voxel : loose)
      of[work_.plan.slabOf(voxel.position.z())].push_back(voxel);
    for (size_t s = 0; s < work_.plan.slabCount(); ++s)
      work_.store.send(kRefilled, kRoot, s, of[s]);
  }

  SlabWork& work_;
  SlabSegmentation& result_;
  GrainLabels grains_;
  Anchors anchors_;
};

}  // namespace

Int32Grid::Ptr slabGrid(const SlabWork& work, size_t slab, const SlabBody& body,
                        VoxelArray<uint32_t> values, const char* name) {
  WorkPart part = work.steps.part(Step::labels, slab);
  const Int32Grid::Ptr grid = toGrid(body.index, std::move(values), name, &part);
  removeVoxels(*grid, body.index, body.cavities);
  return grid;
}

void writeRims(SlabWork& work, size_t slab, const SlabBody& body, VoxelArray<uint32_t> manifold) {
  const int rounds = work.options.tidy, reach = (rounds + 7) / 8 * 8;
  if (rounds == 0) return;
  for (const VoxelId id : body.cavities) manifold[body.index.rank(id)] = 0;
  const int begin = work.plan.begin(slab), end = work.plan.end(slab);
  work.store.write(kLowestRim, slab, labelsBetween(body.index, manifold, begin, begin + reach));
  work.store.write(kHighestRim, slab, labelsBetween(body.index, manifold, end - reach, end));
}

void labelSlabs(SlabWork& work, std::vector<Coord> representatives, SlabSegmentation& result,
                const PutLabels& put) {
  SlabLabels(work, result).run(std::move(representatives), put);
}

}  // namespace vdb_madf::detail
