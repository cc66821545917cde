// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/measure/detail/voxel_shape.h"

namespace vdb_madf::detail {

/// Two grains become one, which is called `kept`; no grain is called `gone` any more.
struct NamedJoin {
  uint32_t kept = 0, gone = 0;
};

/// The areas of grains, and what joins add to them. A union has not the sum of the areas of its
/// parts: where several grains meet, the normals of faces depend on which of them are one.
struct JoinedAreas {
  using Areas = std::array<int64_t, 3>;  ///< as of LeafSurface::Shared

  /// Two grains before all joins, also if they share no face.
  struct Contact {
    int32_t first = 0, second = 0;  ///< labels, first < second
    Areas areas{};
    std::array<int64_t, 3> faces{};  ///< across each axis, those towards `first` taken off
  };
  /// What a join adds to the areas that its grain shares with another one: they are those that its
  /// two parts shared, and this.
  struct Change {
    uint32_t join = 0, other = 0;  ///< `other`: a name
    Areas areas{};
  };
  std::vector<Contact> contacts;   ///< by first, then second
  std::vector<Change> changes;     ///< by join, then other; none of 0
  std::vector<int64_t> freeAreas;  ///< what each join adds, in kAreaUnit
};

/// Measures labels again for every join, but only in the leaf nodes around which both of its grains
/// lie. They may come slab by slab.
class JoinedAreasCounter {
 public:
  /// @param openDomain what lies outside of it is unknown; none: background
  /// @param nameOfLabel of label l at l - 1
  /// @param joins in the order in which they are made
  JoinedAreasCounter(const std::optional<Domain>& openDomain, const VoxelShape& voxel,
                     std::vector<uint32_t> nameOfLabel, std::vector<NamedJoin> joins);

  /// The leaves in some layers. Those around them have to be there, too. @throw Interrupted
  void add(const LabelLeaves& labels, const LeafLayers& layers, Interrupter* interrupter);

  JoinedAreas areas() const;

 private:
  std::optional<Domain> openDomain_;
  VoxelShape voxel_;
  std::vector<uint32_t> nameOfLabel_;
  std::vector<NamedJoin> joins_;
  std::map<std::pair<int32_t, int32_t>, JoinedAreas::Contact> contacts_;
  std::map<std::pair<uint32_t, uint32_t>, JoinedAreas::Areas> changes_;
  std::vector<int64_t> freeAreas_;
};

}  // namespace vdb_madf::detail
