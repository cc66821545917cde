// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/label_preview.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "vdb_madf/detail/label_blocks.h"
#include "vdb_madf/detail/parallel.h"
#include "vdb_madf/errors.h"
#include "vdb_madf/grain_colors.h"
#include "vdb_madf/grid_metadata.h"

namespace vdb_madf {

namespace {

using openvdb::Index;
using openvdb::Vec3f;
using Leaf = Int32Tree::LeafNodeType;

constexpr size_t kLeafGrain = 4;

int floorDiv(int a, int b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

Coord floorDiv(const Coord& a, int b) {
  return {floorDiv(a.x(), b), floorDiv(a.y(), b), floorDiv(a.z(), b)};
}

/// What the fine voxels of a coarse one are.
struct Cell {
  int32_t majority = 0;  ///< of all
  int32_t label = 0;     ///< of the labelled ones
  int64_t labelled = 0;
};
using Cells = std::array<Cell, Leaf::SIZE>;

/// The fine leaves that a coarse leaf takes voxels from.
struct CoarseLeaf {
  Coord origin;
  const Leaf* fine;
  bool operator<(const CoarseLeaf& o) const {
    return origin != o.origin ? origin < o.origin : fine->origin() < o.fine->origin();
  }
};

class Reduction {
 public:
  Reduction(const Int32Grid& labels, int factor)
      : tree_(detail::withoutTiles(labels)), factor_(factor) {
    if (factor < 1 || factor > kLargestReduction)
      throw InvalidInput("the reduction must lie between 1 and 256");
    std::vector<const Leaf*> leaves;
    tree_->getNodes(leaves);
    for (const Leaf* leaf : leaves) {
      const Coord low = floorDiv(leaf->origin(), factor) & ~7,
                  high = floorDiv(leaf->origin().offsetBy(7), factor) & ~7;
      for (int x = low.x(); x <= high.x(); x += 8)
        for (int y = low.y(); y <= high.y(); y += 8)
          for (int z = low.z(); z <= high.z(); z += 8) pairs_.push_back({Coord(x, y, z), leaf});
    }
    std::sort(pairs_.begin(), pairs_.end());
    for (size_t i = 0; i < pairs_.size(); ++i)
      if (i == 0 || pairs_[i].origin != pairs_[i - 1].origin) first_.push_back(i);
    first_.push_back(pairs_.size());
  }

  size_t leafCount() const { return first_.size() - 1; }

  /// f(number, origin, cells) for every coarse leaf, in parallel.
  template <typename F>
  void run(const F& f, Interrupter* interrupter) const {
    detail::parallelFor(leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
      std::vector<uint64_t> keys;
      for (size_t n = begin; n < end; ++n) {
        const Coord origin = pairs_[first_[n]].origin;
        keys.clear();
        for (size_t i = first_[n]; i < first_[n + 1]; ++i) collect(*pairs_[i].fine, origin, keys);
        std::sort(keys.begin(), keys.end());
        f(n, origin, count(keys));
      }
    });
  }

 private:
  /// One key per labelled voxel: its coarse voxel, then its label.
  void collect(const Leaf& leaf, const Coord& origin, std::vector<uint64_t>& keys) const {
    const int32_t* values = leaf.buffer().data();
    for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
      const int32_t label = detail::labelAt(leaf, values, voxel.pos());
      if (label == 0) continue;
      const Coord p = floorDiv(voxel.getCoord(), factor_);
      if ((p & ~7) == origin)
        keys.push_back(uint64_t(Leaf::coordToOffset(p)) << 32 | uint32_t(label));
    }
  }

  Cells count(const std::vector<uint64_t>& keys) const {
    const int64_t all = int64_t(factor_) * factor_ * factor_;
    Cells cells;
    for (size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
      const size_t offset = keys[begin] >> 32;
      int64_t most = 0;
      while (end < keys.size() && keys[end] >> 32 == offset) {
        const size_t run = end;
        while (end < keys.size() && keys[end] == keys[run]) ++end;
        if (int64_t(end - run) > most) {
          most = int64_t(end - run);
          cells[offset].label = int32_t(keys[run] & 0xffffffffu);
        }
      }
      cells[offset].labelled = int64_t(end - begin);
      cells[offset].majority = most > all - cells[offset].labelled ? cells[offset].label : 0;
    }
    return cells;
  }

  Int32Tree::ConstPtr tree_;
  const int factor_;
  std::vector<CoarseLeaf> pairs_;
  std::vector<size_t> first_;
};

/// Makes a grid of the leaves that hold anything.
template <typename Grid>
typename Grid::Ptr gather(
    std::vector<std::unique_ptr<typename Grid::TreeType::LeafNodeType>>& leaves,
    const Int32Grid& labels, int factor, const std::string& name) {
  const auto grid = Grid::create();
  for (auto& leaf : leaves)
    if (leaf && !leaf->isEmpty()) grid->tree().addLeaf(leaf.release());
  grid->setName(name);
  copyProvenance(labels, *grid);
  if (factor == 1) return grid;
  // index fine = factor * coarse + (factor - 1) / 2; what is applied first comes last here.
  const auto transform = labels.transform().copy();
  transform->preTranslate(openvdb::Vec3d((factor - 1) / 2.0));
  transform->preScale(factor);
  grid->setTransform(transform);
  if (const auto box = domain(labels))
    setDomain(*grid, CoordBBox(floorDiv(box->min(), factor), floorDiv(box->max(), factor)));
  if (const auto size = voxelSize(labels))  // the unit stays that of the transform
    grid->insertMeta("madf_voxel_size_m", openvdb::DoubleMetadata(size->metres * factor));
  return grid;
}

template <typename Grid>
auto leafAt(const Coord& origin) {
  using GridLeaf = typename Grid::TreeType::LeafNodeType;
  return std::make_unique<GridLeaf>(origin, typename GridLeaf::ValueType(0));
}

/// The inverse of the sRGB transfer function (IEC 61966-2-1).
float linear(uint8_t channel) {
  const double c = channel / 255.0;
  return float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

}  // namespace

int reductionFor(const CoordBBox& box, int maxDim) {
  if (maxDim < 1) throw InvalidInput("the largest size must be 1 voxel or more");
  if (box.empty()) return 1;
  for (int factor = 1; factor <= kLargestReduction; ++factor) {
    const Coord size = floorDiv(box.max(), factor) - floorDiv(box.min(), factor);
    if (std::max({size.x(), size.y(), size.z()}) < maxDim) return factor;
  }
  throw InvalidInput("a reduction of more than 256 would be needed: allow a larger size");
}

Int32Grid::Ptr reduceLabels(const Int32Grid& labels, int factor, Interrupter* interrupter) {
  const Reduction reduction(labels, factor);
  std::vector<std::unique_ptr<Leaf>> leaves(reduction.leafCount());
  reduction.run(
      [&](size_t n, const Coord& origin, const Cells& cells) {
        leaves[n] = leafAt<Int32Grid>(origin);
        for (Index i = 0; i < Leaf::SIZE; ++i)
          if (cells[i].majority) leaves[n]->setValueOn(i, cells[i].majority);
      },
      interrupter);
  return gather<Int32Grid>(leaves, labels, factor, labels.getName());
}

LabelPreview previewLabels(const Int32Grid& labels, int factor, Interrupter* interrupter) {
  const Reduction reduction(labels, factor);
  const GrainColors colors = grainColors(labels, interrupter);
  const float whole = float(int64_t(factor) * factor * factor);
  std::vector<std::unique_ptr<FloatGrid::TreeType::LeafNodeType>> densities(reduction.leafCount());
  std::vector<std::unique_ptr<ColorGrid::TreeType::LeafNodeType>> shades(reduction.leafCount());
  reduction.run(
      [&](size_t n, const Coord& origin, const Cells& cells) {
        densities[n] = leafAt<FloatGrid>(origin);
        shades[n] = leafAt<ColorGrid>(origin);
        for (Index i = 0; i < Leaf::SIZE; ++i) {
          if (!cells[i].labelled) continue;
          const Rgb rgb = colors.of(cells[i].label);
          densities[n]->setValueOn(i, float(cells[i].labelled) / whole);
          shades[n]->setValueOn(i, Vec3f(linear(rgb[0]), linear(rgb[1]), linear(rgb[2])));
        }
      },
      interrupter);
  LabelPreview preview;
  preview.density = gather<FloatGrid>(densities, labels, factor, "density");
  preview.density->setGridClass(openvdb::GRID_FOG_VOLUME);
  preview.color = gather<ColorGrid>(shades, labels, factor, "color");
  preview.color->setVectorType(openvdb::VEC_INVARIANT);
  return preview;
}

}  // namespace vdb_madf
