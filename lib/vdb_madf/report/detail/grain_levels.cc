// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/detail/grain_levels.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/relabelled.h"
#include "vdb_madf/labels/detail/slab_window.h"
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

/// Writes tables of the page, column by column.
class TablePacker {
 public:
  explicit TablePacker(const Measurements& leaves) : edges_(leaves.edges) {
    if (leaves.voxelSize) {
      const std::array<double, 3> edges = leaves.voxelSize->edgesInUnit();
      edges_ = {edges[0], edges[1], edges[2]};
    }
  }

  void begin(PackedLeaves::Table& table, size_t rows) {
    table_ = &table;
    table.rows = rows;
  }

  void add(const MeasureColumn& column) {
    const bool isExact = column.isWhole();
    table_->columns.push_back({column.name, isExact});
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

  void addNamed(const std::vector<MeasureColumn>& columns, const std::vector<std::string>& names) {
    for (const MeasureColumn& column : columns)
      if (std::find(names.begin(), names.end(), column.name) != names.end()) add(column);
  }

  /// Whole numbers, of each row.
  template <typename Rows, typename F>
  void addExact(const std::string& name, const Rows& rows, const F& number) {
    MeasureColumn column;
    column.name = name;
    column.kind = MeasureColumn::Kind::count;
    for (const auto& row : rows) column.values.push_back(double(number(row)));
    add(column);
  }

  template <typename Rows>
  void addAreas(const Rows& rows) {
    const char* const names[] = {"area1", "area2", "area4"};
    for (size_t i = 0; i < 3; ++i)
      addExact(names[i], rows, [i](const auto& row) { return row.areas[i]; });
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
  PackedLeaves::Table* table_ = nullptr;
  PackedBytes bytes_;
};

/// The bonds in the order of the contacts; one of no face where grains share none.
std::vector<BondMeasures> bondsOf(const std::vector<JoinedAreas::Contact>& contacts,
                                  const std::vector<BondMeasures>& bonds) {
  std::vector<BondMeasures> result;
  auto bond = bonds.begin();
  for (const JoinedAreas::Contact& contact : contacts) {
    const bool isBond =
        bond != bonds.end() && bond->first == contact.first && bond->second == contact.second;
    result.push_back(isBond ? *bond++ : BondMeasures());
  }
  return result;
}

/// A solid ellipsoid of axis l (not half of it) has the moment l^2 / 20 along it.
double moment(const Principal& ellipsoid, int i, int j) {
  double sum = 0;
  for (size_t k = 0; k < 3; ++k)
    sum += ellipsoid.axes[k][i] * ellipsoid.axes[k][j] * ellipsoid.values[k] * ellipsoid.values[k] /
           20;
  return sum;
}

std::optional<ManifoldGraph> graphOf(const AnyLabels& manifold, Interrupter* interrupter) {
  if (const auto* const whole = std::get_if<Int32Grid::ConstPtr>(&manifold))
    return storedGraph(**whole);
  return storedGraph(std::get<LabelSlabs>(manifold), interrupter);
}

/// The grains of a merging, with the transform and the metadata of the labels.
AnyLabels mergedLabels(const AnyLabels& manifold, const Merging& merging, const Int32Grid& labels,
                       Interrupter* interrupter) {
  if (const auto* const whole = std::get_if<Int32Grid::ConstPtr>(&manifold)) {
    const Int32Grid::Ptr grains = applyMerging(**whole, merging, 0, interrupter);
    copyProvenance(labels, *grains);
    return Int32Grid::ConstPtr(grains);
  }
  LabelSlabs slabs = std::get<LabelSlabs>(manifold);
  slabs.about = openvdb::gridConstPtrCast<Int32Grid>(labels.copyGridWithNewTree());
  std::vector<std::pair<int32_t, int32_t>> grainOf;
  for (size_t node = 0; node < merging.grainOfNode.size(); ++node)
    grainOf.emplace_back(int32_t(node) + 1, merging.grainOfNode[node]);
  slabs.read = [read = slabs.read, grainOf](size_t slab, Interrupter* reader) {
    return relabelled(*read(slab, reader), grainOf, reader);
  };
  return slabs;
}

}  // namespace

std::optional<GrainLevels> grainLevels(const Int32Grid& labels, const std::vector<int32_t>& ids,
                                       const AnyLabels& manifold, Interrupter* interrupter) {
  const auto stored = storedMerging(labels);
  if (!stored || stored->options.mode != MergeMode::score || labels[kEditsKey] || ids.empty())
    return std::nullopt;
  checkMergeOptions(stored->options);
  const std::optional<ManifoldGraph> graph = graphOf(manifold, interrupter);
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
  levels.leaves = mergedLabels(manifold, finest, labels, interrupter);
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

JoinedAreas levelAreas(const GrainLevels& levels, const Measurements& leaves,
                       const std::optional<Domain>& domain, Interrupter* interrupter) {
  std::vector<uint32_t> names;  // the places of leaves that have voxels
  auto empty = levels.empty.begin();
  for (uint32_t place = 0; names.size() < levels.grainOfLeaf.size(); ++place)
    if (empty != levels.empty.end() && *empty == place)
      ++empty;
    else
      names.push_back(place);
  std::vector<NamedJoin> joins;
  for (const GrainLevels::Join& join : levels.joins) joins.push_back({join.kept, join.gone});
  JoinedAreasCounter counter(leaves.open ? domain : std::nullopt, VoxelShape{leaves.edges},
                             std::move(names), std::move(joins));
  if (const auto* const whole = std::get_if<Int32Grid::ConstPtr>(&levels.leaves)) {
    counter.add(LabelLeaves(**whole, interrupter), {}, interrupter);
    return counter.areas();
  }
  const auto& slabs = std::get<LabelSlabs>(levels.leaves);
  SlabWindow window(slabs);
  for (size_t s = 0; s < slabs.slabCount(); ++s) {
    const int begin = slabs.cuts[s], end = slabs.cuts[s + 1];
    counter.add(window.leaves({begin - 8, end + 8}, interrupter), {begin, end}, interrupter);
  }
  return counter.areas();
}

PackedLeaves packLeaves(const Measurements& leaves, const JoinedAreas& areas) {
  PackedLeaves packed;
  TablePacker packer(leaves);
  packer.begin(packed.grains, leaves.grains.size());
  packer.addNamed(
      grainColumns(leaves.grains),
      {"voxels", "centroid_x", "centroid_y", "centroid_z", "representative_x", "representative_y",
       "representative_z", "inscribed_radius", "free_area", "cut_area", "box_min_x", "box_min_y",
       "box_min_z", "box_max_x", "box_max_y", "box_max_z", "at_domain_face"});
  const char* const names[] = {"xx", "yy", "zz", "xy", "xz", "yz"};
  const std::array<std::array<int, 2>, 6> axes{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  for (size_t k = 0; k < axes.size(); ++k) {
    MeasureColumn column;
    column.name = std::string("moment_") + names[k];
    column.power = 2;
    for (const GrainMeasures& leaf : leaves.grains)
      column.values.push_back(moment(leaf.ellipsoid, axes[k][0], axes[k][1]));
    packer.add(column);
  }
  const auto& contacts = areas.contacts;
  packer.begin(packed.contacts, contacts.size());
  packer.addExact("first", contacts, [](const auto& contact) { return contact.first; });
  packer.addExact("second", contacts, [](const auto& contact) { return contact.second; });
  packer.addNamed(bondColumns(bondsOf(contacts, leaves.bonds)),
                  {"faces", "centroid_x", "centroid_y", "centroid_z"});
  packer.addAreas(contacts);
  for (size_t k = 0; k < 3; ++k)
    packer.addExact(std::string("across_") + "xyz"[k], contacts,
                    [k](const auto& contact) { return contact.faces[k]; });
  packer.begin(packed.changes, areas.changes.size());
  packer.addExact("join", areas.changes, [](const auto& change) { return change.join; });
  packer.addExact("other", areas.changes, [](const auto& change) { return change.other; });
  packer.addAreas(areas.changes);
  packer.begin(packed.joins, areas.freeAreas.size());
  packer.addExact("free_area", areas.freeAreas, [](int64_t area) { return area; });
  packed.text = packer.text();
  return packed;
}

}  // namespace vdb_madf::detail
