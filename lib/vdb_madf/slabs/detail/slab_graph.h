// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/slabs/detail/slab_terminals.h"

namespace vdb_madf::detail {

/// Joins the terminals of all slabs to the graph of the whole.
class SlabGraph {
 public:
  /// @param cuts slab s is cuts[s] <= z < cuts[s + 1]
  explicit SlabGraph(std::vector<int> cuts) : cuts_(std::move(cuts)) {}

  /// Of the next slab, from the lowest on.
  void add(const SlabTerminals& terminals);
  /// Between the slab that was added last and the one before it.
  void addContacts(const std::vector<ManifoldGraph::Edge>& contacts);

  /// A ball of a slab that others have as their terminal: where does its voxel flow to?
  struct Question {
    Coord position;
    uint32_t terminal;  ///< who asks: a number of this graph
  };
  /// Those to a slab, by position.
  const std::vector<Question>& questions(size_t slab);
  /// The answer: a terminal of the slab, as in Flow::manifold.
  void answer(size_t slab, const Question& question, uint32_t terminal);

  /// When all is answered. Releases all but what nodeOf() needs. All but the weights is set.
  ManifoldGraph finish();
  /// The node of each terminal of a slab.
  std::vector<uint32_t> nodesOf(size_t slab) const;

 private:
  size_t slabOf(int z) const;

  std::vector<int> cuts_;
  std::vector<uint32_t> first_{0};  // terminal of each slab; one more at the end
  std::vector<CriticalPoint> points_;
  std::vector<uint32_t> next_;  // of a terminal; itself, if it is critical; then its node
  std::vector<ManifoldGraph::Edge> edges_;
  std::vector<std::vector<Question>> questions_;
};

}  // namespace vdb_madf::detail
