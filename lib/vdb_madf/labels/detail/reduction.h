// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf::detail {

/// Divides, and rounds towards minus infinity.
Coord floorDiv(const Coord& a, int b);

/// The coarse voxels that a box meets, or those of which a region holds half or more of what lies
/// in its box.
/// @throw InvalidInput if there are none.
Domain reducedDomain(const Domain& domain, int factor);

/// How many fine voxels of a coarse one lie in the box of the domain: beyond it there is no
/// background.
int64_t fineVoxels(const Coord& coarse, int factor, const std::optional<Domain>& domain);

/// What the fine voxels of a coarse one are.
struct Cell {
  int32_t majority = 0;  ///< of all in the box of the domain
  int32_t label = 0;     ///< of the labeled ones
  int64_t labelled = 0;
  int64_t all = 0;  ///< in the box of the domain, and no fewer; 0 where there are no labels
};
using Cells = std::array<Cell, Int32Tree::LeafNodeType::SIZE>;

/// The voxels of a label grid, gathered by the coarse voxels of a whole factor.
class Reduction {
 public:
  /// @param domain of the whole, of which the labels may be a slab
  /// @throw InvalidInput if the factor is not 1 .. kMaxReduction
  Reduction(const Int32Grid& labels, int factor, const std::optional<Domain>& domain);

  size_t leafCount() const { return first_.size() - 1; }

  /// f(number, origin, cells) for every coarse leaf, in parallel. @throw Interrupted
  void run(const std::function<void(size_t, const Coord&, const Cells&)>& f,
           Interrupter* interrupter) const;

 private:
  using Leaf = Int32Tree::LeafNodeType;

  /// The fine leaves that a coarse leaf takes voxels from.
  struct CoarseLeaf {
    Coord origin;
    const Leaf* fine;
    bool operator<(const CoarseLeaf& o) const {
      return origin != o.origin ? origin < o.origin : fine->origin() < o.fine->origin();
    }
  };

  void collect(const Leaf& leaf, const Coord& origin, std::vector<uint64_t>& keys) const;
  Cells count(const std::vector<uint64_t>& keys, const Coord& origin) const;

  Int32Tree::ConstPtr tree_;
  const int factor_;
  const std::optional<Domain> domain_;
  std::vector<CoarseLeaf> pairs_;
  std::vector<size_t> first_;
};

/// Reads slabs one by one, and calls f with all labels in ascending parts, each of whole coarse
/// leaves. @throw Interrupted; what reading throws
void forEachPart(const LabelSlabs& labels, int factor,
                 const std::function<void(const Int32Grid&)>& f, Interrupter* interrupter);

/// Scales a transform into world units of another length.
void convertUnit(const std::string& from, const std::string& to,
                 openvdb::math::Transform& transform);

/// Tells a coarse grid its name, and where its voxels lie: transform, domain and voxel size of
/// `labels`, times the factor.
void placeReduced(openvdb::GridBase& grid, const Int32Grid& labels, int factor,
                  const std::string& name);

/// Makes a grid of the leaves that hold anything.
template <typename Grid>
typename Grid::Ptr gather(
    std::vector<std::unique_ptr<typename Grid::TreeType::LeafNodeType>>& leaves,
    const Int32Grid& labels, int factor, const std::string& name) {
  const auto grid = Grid::create();
  for (auto& leaf : leaves)
    if (leaf && !leaf->isEmpty()) grid->tree().addLeaf(leaf.release());
  placeReduced(*grid, labels, factor, name);
  return grid;
}

template <typename Grid>
auto leafAt(const Coord& origin) {
  using GridLeaf = typename Grid::TreeType::LeafNodeType;
  return std::make_unique<GridLeaf>(origin, typename GridLeaf::ValueType(0));
}

}  // namespace vdb_madf::detail
