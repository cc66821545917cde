// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/measure/detail/joined_areas.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf::detail {

/// The grains of manifolds at the strictnesses that the slider of a page offers. Leaves are those
/// at the largest; at any other, a grain is a union of leaves (method/hierarchy.h: cut()).
struct GrainLevels {
  /// From 8 to 14, and further if that of the labels is not among them.
  double lowest = 8, highest = 14;
  double own = 0;    ///< that of the labels
  AnyLabels leaves;  ///< 1 to their number, without tidying; in slabs as the manifolds
  std::vector<int32_t> grainOfLeaf;  ///< among the labels, of leaf g at g - 1
  /// Leaves are named by their places in the order of their representatives, in which also those
  /// are that have no voxel of the object, and no label (`empty`, ascending).
  std::vector<uint32_t> empty;
  /// A join makes two grains one. A grain is named by the leaf of its representative; the name of
  /// one of the two is kept.
  struct Join {
    uint32_t kept = 0, gone = 0;
    int32_t strictness = 0;  ///< the largest at which it is made, in Hierarchy::kUnitsOfScore
  };
  std::vector<Join> joins;  ///< in the order in which they are made
};

/// None if the labels, which are \p ids, are not what merging these manifolds by score made: if
/// they do not say so, or were edited, or have other grains.
/// @param labels their transform and metadata
std::optional<GrainLevels> grainLevels(const Int32Grid& labels, const std::vector<int32_t>& ids,
                                       const AnyLabels& manifold, Interrupter* interrupter);

/// For the page: planes (PackedBytes::planes()) of 32 bits, of grainOfLeaf; then of the joins
/// `kept`, `gone` and `strictness`.
std::string packJoins(const GrainLevels& levels);

/// What is measured of the surfaces of the leaves, and what the joins of the levels add to it.
/// @param leaves their measures; @param domain that these were measured with
JoinedAreas levelAreas(const GrainLevels& levels, const Measurements& leaves,
                       const std::optional<Domain>& domain, Interrupter* interrupter);

/// Measures that add up, or of which the largest or smallest counts, of leaves and their contacts.
struct PackedLeaves {
  struct Column {
    std::string name;
    bool isExact = false;
  };
  struct Table {
    size_t rows = 0;
    std::vector<Column> columns;
  };
  /// Table by table, column by column, planes of the bits of numbers, 64 of those that are exact,
  /// else 32. Lengths are in the unit of the tables.
  std::string text;
  /// Columns of columns.h, and `moment_xx`, `_yy`, `_zz`, `_xy`, `_xz`, `_yz`: the covariance of
  /// the places in a leaf.
  Table grains;
  /// `first`, `second`, `faces`, `centroid_x`, `_y`, `_z`, and of JoinedAreas::Contact `area1`,
  /// `area2`, `area4`, `across_x`, `_y`, `_z`.
  Table contacts;
  Table changes;  ///< JoinedAreas::Change: `join`, `other`, `area1`, `area2`, `area4`
  Table joins;    ///< what each adds: `free_area`, in kAreaUnit
};
PackedLeaves packLeaves(const Measurements& leaves, const JoinedAreas& areas);

}  // namespace vdb_madf::detail
