// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_labels.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/leaves/leaf_grid.h"
#include "vdb_madf/method/detail/tidy_steps.h"
#include "vdb_madf/method/segmentation_metadata.h"
#include "vdb_madf/slabs/detail/slab_pieces.h"
#include "vdb_madf/slabs/detail/slab_smoothing.h"

namespace vdb_madf::detail {

namespace {

class SlabLabels {
 public:
  SlabLabels(SlabWork& work, const SlabGrains& grains, SlabSegmentation& result)
      : work_(work), grains_(grains), result_(result) {}

  void run(const PutSlabLabels& put) {
    if (result_.counts.objectVoxels == 0) {
      for (size_t s = 0; s < work_.slabCount(); ++s) put(s, toGrid(SlabBody(), {}));
      return;
    }
    const bool isTidied = work_.options.tidy > 0;
    if (isTidied && !work_.scratch.has("loose")) tidyLabels();
    std::vector<LooseVoxel> loose;  // ascending by slab
    if (isTidied) loose = ByteReader(work_.scratch.read("loose")).vector<LooseVoxel>();
    auto next = loose.begin();
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const auto first = next;
      while (next != loose.end() && next->position.z() < work_.end(s)) ++next;
      if (!work_.has("counts", s)) {
        const SlabBody slab = work_.body(s);
        VoxelArray<uint32_t> labels =
            isTidied ? work_.read("labels", s).voxelArray<uint32_t>() : mergedLabels(s, slab);
        for (auto voxel = first; voxel != next; ++voxel)
          labels[slab.index.rank(*slab.index.findVoxel(voxel->position))] = voxel->label;
        const auto counts = countLabels(labels);
        put(s, toGrid(slab, std::move(labels)));
        work_.writeVector("counts", s, counts);
      }
      for (const auto& [label, voxels] : work_.readVector<LabelCount>("counts", s))
        result_.grainVoxels[label - 1] += voxels;
      work_.remove("pieces", s);
      work_.remove("labels", s);
      work_.remove("flow", s);
    }
  }

 private:
  /// Labels as merged.
  VoxelArray<uint32_t> mergedLabels(size_t s, const SlabBody& slab) const {
    auto labels = work_.read("flow", s).voxelArray<uint32_t>();
    const std::vector<uint32_t> grains = grains_.grainsOf(s);
    for (size_t i = 0; i < labels.size(); ++i)
      labels[i] = grains[(labels[i] & ~Flow::kOwnCell) - 1];
    for (const VoxelId id : slab.cavities) labels[slab.index.rank(id)] = 0;
    return labels;
  }

  Int32Grid::Ptr toGrid(const SlabBody& slab, VoxelArray<uint32_t> labels) const {
    const Int32Grid::Ptr grain =
        vdb_madf::toGrid(slab.index, std::move(labels), "grain", work_.interrupter);
    removeVoxels(*grain, slab.index, slab.cavities);
    copyProvenance(*work_.object.about, *grain);
    if (work_.domain) setDomain(*grain, *work_.domain);
    Segmentation about;
    about.counts = result_.counts;
    about.fillHoles = result_.fillHoles;
    about.tidy = result_.tidy;
    about.open = result_.open;
    about.weights = result_.weights;
    describeSegmentation(*grain, work_.options, about);
    return grain;
  }

  struct LabelCount {
    uint64_t label;
    int64_t voxels;
  };
  std::vector<LabelCount> countLabels(const VoxelArray<uint32_t>& labels) const {
    std::vector<int64_t> voxels(result_.grainVoxels.size() + 1, 0);
    for (size_t i = 0; i < labels.size(); ++i) ++voxels[labels[i]];
    std::vector<LabelCount> counts;
    for (size_t label = 1; label < voxels.size(); ++label)
      if (voxels[label] > 0) counts.push_back({label, voxels[label]});
    return counts;
  }

  void tidyLabels() {
    if (!work_.scratch.has("anchors")) {
      ByteWriter bytes;
      bytes.add(findAnchors());
      work_.scratch.write("anchors", bytes.bytes());
    }
    smooth(ByteReader(work_.scratch.read("anchors")).vector<Coord>());
    ByteWriter bytes;
    bytes.add(findLoose());
    work_.scratch.write("loose", bytes.bytes());
  }

  /// The voxel of each grain that never changes: its representative, or the nearest to it if that lies
  /// in a cavity.
  Anchors findAnchors() const {
    GrainLabels grains;
    grains.representative = grains_.representatives();
    grains.weights = result_.weights;
    Anchors anchors = grains.representative;
    std::vector<uint32_t> lost;
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const LeafIndex holes(LeafIndex(), work_.cavities(s));
      if (holes.voxelCount() == 0) continue;
      for (uint32_t g = 0; g < anchors.size(); ++g)
        if (holes.boundingBox().isInside(anchors[g]) && holes.findVoxel(anchors[g]))
          lost.push_back(g);
    }
    if (lost.empty()) return anchors;
    std::vector<AnchorCandidate> best(lost.size());
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const SlabBody slab = work_.body(s);
      grains.label = mergedLabels(s, slab);
      const auto found = anchorCandidates(slab.index, grains, lost, work_.interrupter);
      for (size_t i = 0; i < lost.size(); ++i) best[i].improve(found[i]);
    }
    for (size_t i = 0; i < lost.size(); ++i) anchors[lost[i]] = best[i].position;
    return anchors;
  }

  /// A slab with its labels as merged.
  struct Merged {
    SlabBody slab;
    VoxelArray<uint32_t> labels;
  };
  std::optional<Merged> merged(size_t s) const {
    if (s >= work_.slabCount()) return std::nullopt;
    Merged result{work_.body(s), {}};
    result.labels = mergedLabels(s, result.slab);
    return result;
  }
  LeafLabels rim(const std::optional<Merged>& slab, int begin, int end) const {
    if (!slab) return {};
    return labelsBetween(slab->slab.index, slab->labels, begin, end);
  }

  /// What smoothing sees beyond the cuts is labels as merged: where a slab flows to stays until the one
  /// above it is smooth.
  void smooth(const Anchors& anchors) {
    const int reach = (work_.options.tidy + 7) / 8 * 8;
    std::optional<Merged> here;
    LeafLabels below;
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      if (work_.has("pieces", s)) continue;
      WorkPart part = work_.part(75, 90, s);
      if (!here) {
        if (s > 0) below = rim(merged(s - 1), work_.begin(s) - reach, work_.begin(s));
        here = merged(s);
      }
      std::optional<Merged> next = merged(s + 1);
      LeafLabels highest = rim(here, work_.end(s) - reach, work_.end(s));
      smoothSlab(here->slab.index, below, rim(next, work_.end(s), work_.end(s) + reach), anchors,
                 work_.options.tidy, here->labels, &part);
      writeLabels(s, *here, anchors);
      if (s > 0) work_.remove("flow", s - 1);
      below = std::move(highest);
      here = std::move(next);
    }
  }

  void writeLabels(size_t s, const Merged& slab, const Anchors& anchors) {
    const ConnectedComponents components(slab.slab.index, slab.labels, work_.interrupter);
    ByteWriter labelBytes, pieceBytes;
    labelBytes.add(slab.labels);
    work_.write("labels", s, labelBytes);
    SlabPieces(slab.slab.index, slab.labels, components, anchors, work_.begin(s), work_.end(s))
        .writeTo(pieceBytes);
    work_.write("pieces", s, pieceBytes);  // the last: the slab is done
  }

  std::optional<SlabPieces> pieces(size_t slab) const {
    if (slab >= work_.slabCount()) return std::nullopt;
    ByteReader bytes = work_.read("pieces", slab);
    return SlabPieces::readFrom(bytes);
  }

  /// The voxels that no path of their label joins with its anchor, with the labels they get instead;
  /// ascending by z.
  std::vector<LooseVoxel> findLoose() const {
    PieceUnion all;
    std::optional<SlabPieces> below;
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      std::optional<SlabPieces> here = pieces(s);
      all.add(*here, below ? &*below : nullptr);
      below = std::move(here);
    }
    below.reset();
    std::vector<LooseVoxel> loose;
    std::optional<SlabPieces> here = pieces(0);
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      std::optional<SlabPieces> above = pieces(s + 1);
      const SlabBody slab = work_.body(s);
      const auto labels = work_.read("labels", s).voxelArray<uint32_t>();
      const ConnectedComponents components(slab.index, labels, work_.interrupter);
      const auto found =
          looseVoxels(slab.index, labels, components, s, work_.begin(s), work_.end(s),
                      below ? &*below : nullptr, above ? &*above : nullptr, all);
      loose.insert(loose.end(), found.begin(), found.end());
      below = std::move(here);
      here = std::move(above);
    }
    refill(loose);
    std::stable_sort(loose.begin(), loose.end(),
                     [](const auto& a, const auto& b) { return a.position.z() < b.position.z(); });
    return loose;
  }

  SlabWork& work_;
  const SlabGrains& grains_;
  SlabSegmentation& result_;
};

}  // namespace

void labelSlabs(SlabWork& work, const SlabGrains& grains, SlabSegmentation& result,
                const PutSlabLabels& put) {
  SlabLabels(work, grains, result).run(put);
}

}  // namespace vdb_madf::detail
