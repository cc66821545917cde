// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/slabs/detail/merge_parts.h"
#include "vdb_madf/slabs/detail/slab_terminals.h"

namespace vdb_madf::detail {

/// Joins the terminals of all slabs to the graph of the whole: knows where those that are balls of
/// other slabs flow to, and makes the part of each slab from that.
class SlabGraph {
 public:
  /// @param cuts slab s is cuts[s] <= z < cuts[s + 1]
  explicit SlabGraph(std::vector<int> cuts) : cuts_(std::move(cuts)) {}

  /// Of the next slab, from the lowest on.
  void add(const SlabTerminals& terminals);
  size_t slabCount() const { return first_.size() - 1; }  ///< of those that were added
  int64_t criticalPoints() const { return criticalPoints_; }

  /// A ball of a slab that others have as their terminal: where does its voxel flow to?
  struct Question {
    Coord position;
    uint32_t terminal;  ///< who asks: a number of this graph
  };
  /// Those to a slab, by position.
  const std::vector<Question>& questions(size_t slab);
  /// The answer: a terminal of the slab, as in Flow::manifold.
  void answer(size_t slab, const Question& question, uint32_t terminal);
  /// When all is answered.
  void finish();

  /// Has a slab critical points that others lead to? Their D and numbers are to be told then, for all
  /// slabs, before the first part is made.
  /// @param numbers of the terminals that are critical, as in GraphPart; empty: not wanted
  bool isShared(size_t slab) const;
  void tellShared(size_t slab, const std::vector<CriticalPoint>& points,
                  const std::vector<uint32_t>& numbers);

  /// The part of a slab, with its contacts to the slab below.
  struct Part : GraphPart {
    std::vector<uint32_t> nodeOf;  ///< of each terminal of the slab
  };
  /// Of the next slab, from the lowest on. @param below, above its contacts (SlabTerminals::contacts())
  Part nextPart(const SlabTerminals& terminals, const std::vector<uint32_t>& numbers,
                const std::vector<ManifoldGraph::Edge>& below,
                const std::vector<ManifoldGraph::Edge>& above);

 private:
  /// A ball of another slab.
  struct Foreign {
    uint32_t terminal;
    uint32_t next;  ///< where it flows to: another terminal; its critical point, if finished
  };
  /// A critical point that terminals of several slabs lead to.
  struct Shared {
    uint32_t terminal;
    uint32_t last;  ///< the highest slab with such a terminal
    CriticalPoint point{};
    uint32_t number = 0;
  };
  /// Where a terminal leads to.
  struct Root {
    CriticalPoint point;
    uint32_t number;
    uint32_t last;    ///< the highest slab with a terminal that leads there
    bool isTerminal;  ///< is the terminal itself critical?
  };

  size_t slabOf(int z) const;
  size_t slabOfTerminal(uint32_t terminal) const;
  const Foreign* findForeign(uint32_t terminal) const;
  std::vector<Shared>::const_iterator sharedFrom(uint32_t terminal) const;
  std::vector<Root> rootsOf(size_t slab, const std::vector<CriticalPoint>& points,
                            const std::vector<uint32_t>& numbers) const;

  std::vector<int> cuts_;
  std::vector<uint32_t> first_{0};  // terminal of each slab; one more at the end
  int64_t criticalPoints_ = 0;
  std::vector<Foreign> foreign_;  // ascending by terminal
  std::vector<std::vector<Question>> questions_;
  std::vector<Shared> shared_;  // ascending by terminal

  size_t parts_ = 0;              // that were made
  std::vector<Root> rootsBelow_;  // of the slab of the last one
};

}  // namespace vdb_madf::detail
