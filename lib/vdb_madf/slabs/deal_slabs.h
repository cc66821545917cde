// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "vdb_madf/slabs/slab_builder.h"

namespace vdb_madf {

/// Cuts an object that several members read, each some of its layers of leaf nodes, into slabs of
/// about as many voxels each, as many as there are members or more, and deals these to the team.
/// All make one. Of the object nothing is in the memory of a member but a layer or a slab; the rest
/// is in scratch.
class SlabDealer {
 public:
  SlabDealer(Team& team, const SlabCosts& costs, Scratch& scratch)
      : team_(team), costs_(costs), scratch_(scratch) {}

  /// A layer, which no other member reads, in any order. @throw InvalidInput if it is not one, or
  /// comes twice
  void add(const MaskTree& layer);

  /// Comes after the last layer of all members, which call it together.
  /// @param limits of a slab
  /// @param reach how far beyond its slabs a member has to know the object, voxels
  /// The cuts cover the domain, if there is one, and the object; they do not depend on who read
  /// what. Slabs in a scratch that is shared count as finished (hasSlabs()) when all is in it.
  void finish(const SlabLimits& limits, int64_t reach, const std::optional<Domain>& domain);

 private:
  struct Layers;
  Layers countLayers(const std::optional<Domain>& domain) const;
  void send(const std::vector<int>& cuts, int64_t reach);
  void receive(const std::vector<int>& cuts, int64_t reach, const Layers& layers);

  Team& team_;
  SlabCosts costs_;
  Scratch& scratch_;
  std::map<int, LeafCosts> read_;  // what the layers of this member cost, by their z
};

}  // namespace vdb_madf
