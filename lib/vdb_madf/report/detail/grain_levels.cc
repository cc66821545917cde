// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/detail/grain_levels.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "vdb_madf/measure/columns.h"
#include "vdb_madf/method/hierarchy.h"
#include "vdb_madf/report/detail/packed_bytes.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/remerge.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf::detail {

namespace {

/// Names the classes that a join makes one.
GrainLevels::Join namedJoin(const Hierarchy& hierarchy, const Hierarchy::Join& join) {
  const bool isSecond = hierarchy.classes[join.second].top > hierarchy.classes[join.first].top;
  return isSecond ? GrainLevels::Join{join.second, join.first, 0}
                  : GrainLevels::Join{join.first, join.second, 0};
}

/// Fills in all but the labels of the leaves, which are `finest`.
void addJoins(const Hierarchy& hierarchy, const Merging& finest, const Merging& own,
              GrainLevels& levels) {
  std::vector<GrainLevels::Join> joins;
  int32_t least = std::numeric_limits<int32_t>::max();
  for (const Hierarchy::Join& join : hierarchy.joins) {
    joins.push_back(namedJoin(hierarchy, join));
    joins.back().strictness = least = std::min(least, join.score);
  }
  const auto made = joins.begin() + std::ptrdiff_t(joinsAt(hierarchy, levels.highest));
  std::vector<char> isGone(hierarchy.classes.size(), 0);
  for (auto join = joins.begin(); join != made; ++join) isGone[join->gone] = 1;
  std::vector<uint32_t> placeOf(hierarchy.classes.size(), 0);
  uint32_t places = 0;
  for (size_t c = 0; c < hierarchy.classes.size(); ++c) {
    if (isGone[c]) continue;
    const uint32_t node = hierarchy.classes[c].representative;
    placeOf[c] = places++;
    if (finest.grainOfNode[node] == 0)
      levels.empty.push_back(placeOf[c]);
    else
      levels.grainOfLeaf.push_back(own.grainOfNode[node]);
  }
  for (auto join = made; join != joins.end(); ++join)
    levels.joins.push_back({placeOf[join->kept], placeOf[join->gone], join->strictness});
}

/// Columns of measures in the page, with those of their names.
class LeafPacker {
 public:
  explicit LeafPacker(const Measurements& leaves) : edges_(leaves.edges) {
    if (leaves.voxelSize) {
      const std::array<double, 3> edges = leaves.voxelSize->edgesInUnit();
      edges_ = {edges[0], edges[1], edges[2]};
    }
  }

  void add(const MeasureColumn& column, std::vector<PackedLeaves::Column>& list) {
    const bool isExact = column.kind == MeasureColumn::Kind::count;
    list.push_back({column.name, isExact});
    std::vector<uint64_t> exact;
    std::vector<uint32_t> rounded;
    for (const double value : column.values)
      if (isExact)
        exact.push_back(bits<uint64_t>(value));
      else
        rounded.push_back(bits<uint32_t>(float(scaled(column, value, edges_))));
    bytes_.planes(exact);
    bytes_.planes(rounded);
  }

  void addNamed(const std::vector<MeasureColumn>& columns, const std::vector<std::string>& names,
                std::vector<PackedLeaves::Column>& list) {
    for (const MeasureColumn& column : columns)
      if (std::find(names.begin(), names.end(), column.name) != names.end()) add(column, list);
  }

  std::string text() { return bytes_.text(); }

 private:
  template <typename Bits, typename Number>
  static Bits bits(Number number) {
    static_assert(sizeof(Bits) == sizeof(Number));
    Bits result;
    std::memcpy(&result, &number, sizeof result);
    return result;
  }

  openvdb::Vec3d edges_;
  PackedBytes bytes_;
};

/// A solid ellipsoid of axis l (not half of it) has the moment l^2 / 20 along it.
double moment(const Principal& ellipsoid, int i, int j) {
  double sum = 0;
  for (size_t k = 0; k < 3; ++k)
    sum += ellipsoid.axes[k][i] * ellipsoid.axes[k][j] * ellipsoid.values[k] * ellipsoid.values[k] /
           20;
  return sum;
}

}  // namespace

std::optional<GrainLevels> grainLevels(const Int32Grid& labels, const std::vector<int32_t>& ids,
                                       const Int32Grid& manifold, Interrupter* interrupter) {
  const auto stored = storedMerging(labels);
  if (!stored || stored->options.mode != MergeMode::score || labels[kEditsKey] || ids.empty())
    return std::nullopt;
  checkMergeOptions(stored->options);
  const std::optional<ManifoldGraph> graph = storedGraph(manifold);
  if (!graph) return std::nullopt;
  const Merging own = merge(*graph, stored->options);
  if (ids.size() != own.representative.size() || size_t(ids.back()) != ids.size())
    return std::nullopt;
  GrainLevels levels;
  levels.own = stored->options.strictness;
  levels.lowest = std::min(levels.lowest, levels.own);
  levels.highest = std::max(levels.highest, levels.own);
  const Hierarchy hierarchy = mergeHierarchy(*graph, levels.lowest);
  const Merging finest = cut(hierarchy, levels.highest);
  levels.leaves = applyMerging(manifold, finest, 0, interrupter);
  addJoins(hierarchy, finest, own, levels);
  return levels;
}

std::string packJoins(const GrainLevels& levels) {
  std::vector<uint32_t> kept, gone;
  std::vector<int32_t> strictness;
  for (const GrainLevels::Join& join : levels.joins) {
    kept.push_back(join.kept);
    gone.push_back(join.gone);
    strictness.push_back(join.strictness);
  }
  PackedBytes bytes;
  bytes.planes(levels.grainOfLeaf);
  bytes.planes(kept);
  bytes.planes(gone);
  bytes.planes(strictness);
  return bytes.text();
}

PackedLeaves packLeaves(const Measurements& leaves) {
  PackedLeaves packed;
  LeafPacker packer(leaves);
  packer.addNamed(
      grainColumns(leaves.grains),
      {"voxels", "centroid_x", "centroid_y", "centroid_z", "representative_x", "representative_y",
       "representative_z", "inscribed_radius", "free_area", "cut_area", "box_min_x", "box_min_y",
       "box_min_z", "box_max_x", "box_max_y", "box_max_z", "at_domain_face"},
      packed.grains);
  const char* const names[] = {"xx", "yy", "zz", "xy", "xz", "yz"};
  const std::array<std::array<int, 2>, 6> axes{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  for (size_t k = 0; k < axes.size(); ++k) {
    MeasureColumn column;
    column.name = std::string("moment_") + names[k];
    column.power = 2;
    for (const GrainMeasures& leaf : leaves.grains)
      column.values.push_back(moment(leaf.ellipsoid, axes[k][0], axes[k][1]));
    packer.add(column, packed.grains);
  }
  packer.addNamed(bondColumns(leaves.bonds),
                  {"first", "second", "faces", "area", "centroid_x", "centroid_y", "centroid_z",
                   "normal_x", "normal_y", "normal_z"},
                  packed.bonds);
  packed.text = packer.text();
  return packed;
}

}  // namespace vdb_madf::detail
