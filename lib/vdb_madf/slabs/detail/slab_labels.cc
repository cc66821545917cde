// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_labels.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/leaf_grid.h"
#include "vdb_madf/method/detail/tidy_steps.h"
#include "vdb_madf/slabs/detail/slab_grains.h"
#include "vdb_madf/slabs/detail/slab_pieces.h"
#include "vdb_madf/slabs/detail/slab_smoothing.h"

namespace vdb_madf::detail {

namespace {

/// Voxels per task of a loop over them.
constexpr size_t kVoxelGrain = size_t(1) << 16;

constexpr char kLowestRim[] = "lowest-rim", kHighestRim[] = "highest-rim";
constexpr char kWithoutAnchor[] = "pieces-without-anchor";

ByteWriter toBytes(const LeafLabels& rim) {
  ByteWriter bytes;
  bytes.add(rim.leaves);
  bytes.add(rim.labels);
  return bytes;
}
LeafLabels toRim(ByteReader bytes) {
  LeafLabels rim;
  rim.leaves = bytes.vector<LeafIndex::LeafVoxels>();
  rim.labels = bytes.vector<uint32_t>();
  return rim;
}

class SlabLabels {
 public:
  SlabLabels(SlabWork& work, SlabSegmentation& result) : work_(work), result_(result) {}

  void run(std::vector<Coord> representatives, const PutLabels& put) {
    grains_.representative = std::move(representatives);
    const bool isTidied = work_.options.tidy > 0 && result_.counts.objectVoxels > 0;
    if (isTidied) {
      work_.beginStage("tidy");
      tidyLabels();
    }
    work_.beginStage("labels");
    work_.forEachSlab([&](size_t s) { putLabels(s, isTidied, put); },
                      [&](size_t s) {
                        work_.remove("labels", s);
                        work_.remove("flow", s);
                      });
    if (!work_.isRoot()) return;
    for (size_t s = 0; s < work_.slabCount(); ++s)
      for (const auto& [label, voxels] :
           work_.receiveVector<LabelCount>("counts", s, SlabWork::kRoot))
        result_.grainVoxels[label - 1] += voxels;
  }

 private:
  /// Labels as merged.
  VoxelArray<uint32_t> mergedLabels(size_t s, const SlabBody& slab) const {
    auto labels = work_.readVoxels<uint32_t>("flow", s);
    const auto grains = work_.readVector<uint32_t>(kGrainsOfTerminals, s);
    parallelFor(labels.size(), kVoxelGrain, nullptr, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) labels[i] = grains[(labels[i] & ~Flow::kOwnCell) - 1];
    });
    for (const VoxelId id : slab.cavities) labels[slab.index.rank(id)] = 0;
    return labels;
  }

  void putLabels(size_t s, bool isTidied, const PutLabels& put) {
    if (result_.counts.objectVoxels == 0) {
      put(s, SlabBody(), {});
      work_.write("put", s, {});
      return;
    }
    const SlabBody slab = work_.body(s);
    VoxelArray<uint32_t> labels =
        isTidied ? work_.readVoxels<uint32_t>("labels", s) : mergedLabels(s, slab);
    for (const LooseVoxel& voxel : work_.receiveVector<LooseVoxel>("refilled", SlabWork::kRoot, s))
      labels[slab.index.rank(*slab.index.findVoxel(voxel.position))] = voxel.label;
    const auto counts = countLabels(labels);
    put(s, slab, std::move(labels));
    work_.sendVector("counts", s, SlabWork::kRoot, counts);
    work_.write("put", s, {});
  }

  struct LabelCount {
    uint64_t label;
    int64_t voxels;
  };
  std::vector<LabelCount> countLabels(const VoxelArray<uint32_t>& labels) const {
    std::vector<int64_t> voxels(size_t(result_.counts.grains) + 1, 0);
    parallelFor(labels.size(), kVoxelGrain, nullptr, [&](size_t begin, size_t end) {
      for (size_t i = begin, next; i < end; i = next) {  // voxels of one label follow each other
        for (next = i + 1; next < end && labels[next] == labels[i];) ++next;
        __atomic_fetch_add(&voxels[labels[i]], int64_t(next - i), __ATOMIC_RELAXED);
      }
    });
    std::vector<LabelCount> counts;
    for (size_t label = 1; label < voxels.size(); ++label)
      if (voxels[label] > 0) counts.push_back({label, voxels[label]});
    return counts;
  }

  void tidyLabels() {
    shareAnchors();
    work_.forEachSlab([&](size_t s) { sendRims(s); },
                      [&](size_t s) {
                        work_.remove(kLowestRim, s);
                        work_.remove(kHighestRim, s);
                      });
    work_.forEachSlab([&](size_t s) { smooth(s); },
                      [&](size_t s) {
                        work_.removeMessage("rim", s - 1, s);
                        work_.removeMessage("rim", s + 1, s);
                      });
    work_.forEachSlab([&](size_t s) { joinPieces(s); });
    if (work_.isRoot()) findHeld();
    work_.exchange();
    work_.forEachSlab([&](size_t s) { findLoose(s); },
                      [&](size_t s) { work_.remove(kWithoutAnchor, s); });
    if (work_.isRoot()) refillLoose();
    work_.exchange();
  }

  /// The voxel of each grain that never changes: its representative, or the nearest to it if that lies
  /// in a cavity. Known at all ranks.
  void shareAnchors() {
    Lost lost;
    if (work_.isRoot()) lost = findLost();
    ByteWriter bytes;
    bytes.add(grains_.representative);
    bytes.add(lost);
    ByteReader all(work_.broadcast(bytes));
    grains_.representative = all.vector<Coord>();
    lost = all.vector<uint32_t>();
    grains_.weights = work_.weights;
    anchors_ = grains_.representative;
    work_.forEachSlab([&](size_t s) {
      if (lost.empty()) return;
      const SlabBody slab = work_.body(s);
      grains_.label = mergedLabels(s, slab);
      work_.sendVector("anchors", s, SlabWork::kRoot,
                       anchorCandidates(slab.index, grains_, lost, work_.interrupter));
    });
    if (lost.empty()) return;
    if (work_.isRoot()) replaceLost(lost);
    ByteWriter replaced;
    replaced.add(anchors_);
    anchors_ = ByteReader(work_.broadcast(replaced)).vector<Coord>();
  }

  using Lost = std::vector<uint32_t>;  // grains whose representative is in a cavity

  Lost findLost() const {
    Lost lost;
    if (work_.fillsNone) return lost;
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const LeafIndex holes(
          LeafIndex(), work_.receiveVector<LeafIndex::LeafVoxels>("holes", s, SlabWork::kRoot));
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
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const auto found = work_.receiveVector<AnchorCandidate>("anchors", s, SlabWork::kRoot);
      for (size_t i = 0; i < lost.size(); ++i) best[i].improve(found[i]);
    }
    for (size_t i = 0; i < lost.size(); ++i) anchors_[lost[i]] = best[i].position;
  }

  /// Labels as merged, as far from the cuts as the slabs beyond them have to see.
  void sendRims(size_t s) {
    const auto grains = work_.readVector<uint32_t>(kGrainsOfTerminals, s);
    const auto send = [&](const char* side, size_t to) {
      LeafLabels rim = toRim(work_.read(side, s));
      for (uint32_t& label : rim.labels)
        if (label != 0) label = grains[(label & ~Flow::kOwnCell) - 1];
      work_.send("rim", s, to, toBytes(rim));
    };
    if (s > 0) send(kLowestRim, s - 1);
    if (s + 1 < work_.slabCount()) send(kHighestRim, s + 1);
  }
  LeafLabels rim(size_t from, size_t s) const {
    if (!work_.hasMessage("rim", from, s)) return {};
    return toRim(work_.receive("rim", from, s));
  }

  void smooth(size_t s) {
    WorkPart part = work_.part(75, 85, s);
    WorkPart smoothing(&part, 0, 70), finding(&part, 70, 85), joining(&part, 85, 100);
    const SlabBody slab = work_.body(s);
    VoxelArray<uint32_t> labels = mergedLabels(s, slab);
    smoothSlab(slab.index, rim(s - 1, s), rim(s + 1, s), anchors_, work_.options.tidy, labels,
               &smoothing);
    const LabelMasks masks(slab.index, labels, &finding);
    const ConnectedComponents components(slab.index, masks, &joining);
    work_.writeVoxels("labels", s, labels);
    const std::vector<char> hasAnchor = piecesWithAnchor(slab.index, labels, components, anchors_);
    work_.sendVector("pieces", s, SlabWork::kRoot, hasAnchor);
    work_.writeVector(kWithoutAnchor, s, piecesWithoutAnchor(slab.index, components, hasAnchor));
    const auto face = [&](bool isUpper) {
      return facePieces(slab.index, components, work_.cut(s, isUpper));
    };
    work_.writeVector("lowest-pieces", s, face(false));
    if (s > 0) work_.sendVector("face-pieces", s, s - 1, face(false));
    if (s + 1 < work_.slabCount()) work_.sendVector("face-pieces", s, s + 1, face(true));
  }

  void joinPieces(size_t s) {
    if (s == 0) return;
    work_.sendVector("joined-pieces", s, SlabWork::kRoot,
                     pieceJoins(work_.receiveVector<FacePiece>("face-pieces", s - 1, s),
                                work_.readVector<FacePiece>("lowest-pieces", s)));
  }

  /// At the root: which pieces are part of one that holds an anchor.
  void findHeld() {
    PieceUnion pieces;
    const size_t slabs = work_.slabCount();
    std::vector<std::vector<char>> held(slabs);
    for (size_t s = 0; s < slabs; ++s) {
      held[s] = work_.receiveVector<char>("pieces", s, SlabWork::kRoot);
      pieces.add(held[s].size(),
                 work_.receiveVector<PieceJoin>("joined-pieces", s, SlabWork::kRoot));
    }
    std::vector<char> isHeld(pieces.size(), 0);
    for (size_t s = 0; s < slabs; ++s)
      for (uint32_t i = 0; i < held[s].size(); ++i)
        if (held[s][i]) isHeld[pieces.find(s, i)] = 1;
    for (size_t s = 0; s < slabs; ++s)
      for (uint32_t i = 0; i < held[s].size(); ++i) held[s][i] = isHeld[pieces.find(s, i)];
    for (size_t s = 0; s < slabs; ++s) {
      ByteWriter bytes;
      bytes.add(s > 0 ? held[s - 1] : std::vector<char>());
      bytes.add(held[s]);
      bytes.add(s + 1 < slabs ? held[s + 1] : std::vector<char>());
      work_.send("held", SlabWork::kRoot, s, bytes);
    }
  }

  void findLoose(size_t s) {
    ByteReader held = work_.receive("held", SlabWork::kRoot, s);
    BeyondPieces below, above;
    below.isHeld = held.vector<char>();
    const auto isHeld = held.vector<char>();
    above.isHeld = held.vector<char>();
    std::vector<LeafPiece> loose = work_.readVector<LeafPiece>(kWithoutAnchor, s);
    loose.erase(
        std::remove_if(loose.begin(), loose.end(),
                       [&](const LeafPiece& piece) { return isHeld[piece.piece.component] != 0; }),
        loose.end());
    std::vector<LooseVoxel> voxels;
    if (!loose.empty()) {
      below.face = work_.receiveVector<FacePiece>("face-pieces", s - 1, s);
      above.face = work_.receiveVector<FacePiece>("face-pieces", s + 1, s);
      voxels = looseVoxels(work_.body(s).index, work_.readVoxels<uint32_t>("labels", s), loose,
                           work_.begin(s), work_.end(s), below, above);
    }
    work_.sendVector("loose", s, SlabWork::kRoot, voxels);
  }

  /// At the root: the voxels that no path of their label joins with its anchor get other labels.
  void refillLoose() {
    std::vector<LooseVoxel> loose;
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const auto found = work_.receiveVector<LooseVoxel>("loose", s, SlabWork::kRoot);
      loose.insert(loose.end(), found.begin(), found.end());
    }
    refill(loose);
    std::vector<std::vector<LooseVoxel>> of(work_.slabCount());
    for (const LooseVoxel& voxel : loose) of[work_.slabOf(voxel.position.z())].push_back(voxel);
    for (size_t s = 0; s < work_.slabCount(); ++s)
      work_.sendVector("refilled", SlabWork::kRoot, s, of[s]);
  }

  SlabWork& work_;
  SlabSegmentation& result_;
  GrainLabels grains_;
  Anchors anchors_;
};

}  // namespace

Int32Grid::Ptr slabGrid(const SlabWork& work, size_t slab, const SlabBody& body,
                        VoxelArray<uint32_t> values, const char* name) {
  WorkPart part = work.part(85, 100, slab);
  const Int32Grid::Ptr grid = toGrid(body.index, std::move(values), name, &part);
  removeVoxels(*grid, body.index, body.cavities);
  return grid;
}

void writeRims(SlabWork& work, size_t slab, const SlabBody& body, VoxelArray<uint32_t> manifold) {
  const int rounds = work.options.tidy, reach = (rounds + 7) / 8 * 8;
  if (rounds == 0) return;
  for (const VoxelId id : body.cavities) manifold[body.index.rank(id)] = 0;
  const int begin = work.begin(slab), end = work.end(slab);
  work.write(kLowestRim, slab, toBytes(labelsBetween(body.index, manifold, begin, begin + reach)));
  work.write(kHighestRim, slab, toBytes(labelsBetween(body.index, manifold, end - reach, end)));
}

void labelSlabs(SlabWork& work, std::vector<Coord> representatives, SlabSegmentation& result,
                const PutLabels& put) {
  SlabLabels(work, result).run(std::move(representatives), put);
}

}  // namespace vdb_madf::detail
