// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "vdb_madf/segmentation/graph_part.h"
#include "vdb_madf/slabs/cuts/slab_terminals.h"

namespace vdb_madf::detail {

/// Where a terminal leads to.
struct SlabRoot {
  CriticalPoint point;
  uint32_t number = 0;  ///< as in GraphPart; 0: it is not wanted
  uint32_t first = 0,
           last = 0;        ///< the lowest and the highest slab with a terminal that leads there
  bool isTerminal = false;  ///< is the terminal itself critical?
};

/// A terminal of a slab that leads to another slab, or that others lead to.
struct SlabLead {
  uint32_t terminal;
  SlabRoot root;  ///< but for isTerminal
};

/// Where all terminals of a slab lead to.
/// @param numbers of those that are critical; empty: not wanted
std::vector<SlabRoot> slabRoots(size_t slab, const std::vector<CriticalPoint>& points,
                                const std::vector<uint32_t>& numbers,
                                const std::vector<SlabLead>& leads);

/// The part of a slab, with its contacts to the slab below.
struct SlabPart : GraphPart {
  std::vector<char> startsBelow;  ///< of each node: is it in the part of a lower slab, too?
  std::vector<uint32_t> nodeOf;   ///< of each terminal of the slab

  template <typename Self>
  static auto storedFields(Self& self) {
    return std::tie(self.graph.nodes, self.graph.edges, self.number, self.goesOn, self.startsBelow,
                    self.nodeOf);
  }
};

/// @param contacts from `below`, by place, to terminals of the slab
/// @param below where terminals of the slab below lead to
/// @param above terminals that the slab above has contacts to
SlabPart slabPart(size_t slab, const SlabTerminals& terminals, const std::vector<SlabRoot>& roots,
                  const std::vector<ManifoldGraph::Edge>& contacts,
                  const std::vector<SlabRoot>& below, const std::vector<uint32_t>& above);

}  // namespace vdb_madf::detail
