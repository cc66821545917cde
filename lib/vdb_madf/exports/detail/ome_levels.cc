// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/ome_levels.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/exports/detail/coarse_trees.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/detail/reduction.h"
#include "vdb_madf/labels/reduced_labels.h"

namespace vdb_madf::detail {

namespace {

using Leaf = Int32Tree::LeafNodeType;

constexpr int kLeaf = Leaf::DIM;

/// The arrays of a level.
class LevelArrays {
 public:
  LevelArrays(const OutputTree& folder, const std::string& group, const OmeLevel& level,
              const std::string& name, ZarrVersion version)
      : isFinest_(level.factor == 1),
        object_(folder, group + name, level.box, isFinest_ ? ZarrSamples::mask : ZarrSamples::gray,
                version),
        label_(folder, group + kLabelGroup + "/" + name, level.box, ZarrSamples::label, version) {}

  int layerCount() const { return label_.layerCount(); }
  int firstSlice(int layer) const { return label_.firstSlice(layer); }
  /// @param gray of the finest level nothing
  void write(const Int32Tree& label, const Int32Tree& gray, int begin, int end,
             Interrupter* interrupter) {
    object_.write(isFinest_ ? label : gray, begin, end, interrupter);
    label_.write(label, begin, end, interrupter);
  }
  void finish() const {
    object_.finish();
    label_.finish();
  }

 private:
  const bool isFinest_;
  ZarrArray object_, label_;
};

/// A level of labels that come slab by slab.
class SlabLevel {
 public:
  SlabLevel(const OutputTree& folder, const std::string& group, const OmeLevel& level,
            const std::string& name, ZarrVersion version, const std::optional<Domain>& domain)
      : factor_(level.factor),
        domain_(domain),
        counts_(level.factor, domain),
        arrays_(folder, group, level, name, version) {}

  /// The next slab; the finest level takes its leaves. @param counts of its leaves, for factors
  /// above 8
  /// @param end all labels of the slices below it have come
  void add(Int32Grid& slab, const std::vector<LabelCount>& counts, int end,
           Interrupter* interrupter) {
    const int known = floorDiv(Coord(end), factor_).z();
    if (factor_ == 1) {
      label_.merge(slab.tree());
    } else if (factor_ <= kLeaf) {  // a coarse voxel lies in one leaf
      addTrees(coarseTrees(slab, factor_, domain_, interrupter));
    } else {
      counts_.add(counts);
      addTrees(counts_.take(known));
    }
    int layers = written_;
    while (layers < arrays_.layerCount() && arrays_.firstSlice(layers + 1) <= known) ++layers;
    writeLayers(layers, interrupter);
  }
  void finish(Interrupter* interrupter) {
    addTrees(counts_.take(std::numeric_limits<int>::max()));
    writeLayers(arrays_.layerCount(), interrupter);
    arrays_.finish();
  }

 private:
  void addTrees(CoarseTrees trees) {
    label_.merge(trees.label);
    gray_.merge(trees.gray);
  }
  void writeLayers(int end, Interrupter* interrupter) {
    if (end == written_) return;
    arrays_.write(label_, gray_, written_, end, interrupter);
    written_ = end;
    for (Int32Tree* tree : {&label_, &gray_}) dropBelow(*tree, arrays_.firstSlice(end));
  }
  static void dropBelow(Int32Tree& tree, int z) {
    std::vector<Leaf*> leaves;
    tree.stealNodes(leaves);
    tree.clear();
    for (Leaf* const leaf : leaves)
      if (leaf->origin().z() + kLeaf > z)
        tree.addLeaf(leaf);
      else
        delete leaf;
  }

  const int factor_;
  const std::optional<Domain> domain_;  // of the whole
  CoarseCounts counts_;
  LevelArrays arrays_;
  Int32Tree label_, gray_;  // of layers that are not written
  int written_ = 0;         // layers
};

}  // namespace

std::vector<OmeLevel> omeLevels(const CoordBBox& box) {
  std::vector<OmeLevel> levels{{1, box}};
  const auto longest = [&] {
    const Coord size = levels.back().box.dim();
    return std::max({size.x(), size.y(), size.z()});
  };
  for (int factor = 2; factor <= kMaxReduction && longest() > kZarrChunk; factor *= 2)
    levels.push_back({factor, CoordBBox(floorDiv(box.min(), factor), floorDiv(box.max(), factor))});
  return levels;
}

void writeOmeLevels(const OutputTree& folder, const std::string& group, const Int32Grid& labels,
                    const std::vector<OmeLevel>& levels, ZarrVersion version,
                    Interrupter* interrupter) {
  for (size_t i = 0; i < levels.size(); ++i) {
    const auto percent = [&](size_t done) { return int(done * 100 / levels.size()); };
    WorkPart part(interrupter, percent(i), percent(i + 1));
    LevelArrays arrays(folder, group, levels[i], std::to_string(i), version);
    if (levels[i].factor == 1) {
      arrays.write(*withoutTiles(labels), Int32Tree(), 0, arrays.layerCount(), &part);
    } else {
      const CoarseTrees trees = coarseTrees(labels, levels[i].factor, storedDomain(labels), &part);
      arrays.write(trees.label, trees.gray, 0, arrays.layerCount(), &part);
    }
    arrays.finish();
  }
}

void writeOmeLevels(const OutputTree& folder, const std::string& group, const LabelSlabs& labels,
                    const std::vector<OmeLevel>& levels, ZarrVersion version,
                    Interrupter* interrupter) {
  std::vector<std::unique_ptr<SlabLevel>> open;
  for (size_t i = 0; i < levels.size(); ++i)
    open.push_back(std::make_unique<SlabLevel>(folder, group, levels[i], std::to_string(i), version,
                                               storedDomain(*labels.about)));
  for (size_t s = 0; s < labels.slabCount(); ++s) {
    const auto percent = [&](size_t done) { return int(done * 100 / labels.slabCount()); };
    WorkPart part(interrupter, percent(s), percent(s + 1));
    const Int32Grid::Ptr slab = labels.read(s, &part);
    slab->tree().voxelizeActiveTiles();
    std::vector<LabelCount> counts;
    if (levels.back().factor > kLeaf) counts = countLabels(slab->tree(), &part);
    for (size_t i = levels.size(); i-- > 0;)  // the finest one last
      open[i]->add(*slab, counts, labels.cuts[s + 1], &part);
  }
  for (const auto& level : open) level->finish(interrupter);
}

}  // namespace vdb_madf::detail
