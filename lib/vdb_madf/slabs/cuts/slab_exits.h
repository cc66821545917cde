// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "vdb_madf/slabs/cuts/slab_part.h"

namespace vdb_madf::detail {

/// Where the terminals that are balls of other slabs lead to. Of all others it knows how many there
/// are.
class SlabExits {
 public:
  /// @param cuts slab s is cuts[s] <= z < cuts[s + 1]
  explicit SlabExits(std::vector<int> cuts) : cuts_(std::move(cuts)) {}

  /// A terminal of a slab that is a ball of another one.
  struct Exit {
    uint32_t terminal;
    Coord position;
  };
  /// Adds the exits of the next slab, from the lowest on. @param exits ascending
  void add(size_t terminals, const std::vector<Exit>& exits);
  size_t slabCount() const { return first_.size() - 1; }  ///< that were added
  /// How many terminals a slab has, and how many critical points all slabs.
  size_t terminals(size_t slab) const { return first_[slab + 1] - first_[slab]; }
  int64_t criticalPoints() const { return int64_t(first_.back()) - int64_t(foreign_.size()); }

  /// A ball of a slab that others have as their terminal: where does its voxel flow to?
  struct Question {
    Coord position;
    uint32_t asking;  ///< an exit: a number of this graph
  };
  /// The questions to a slab, by position.
  const std::vector<Question>& questions(size_t slab);
  /// The answer: a terminal of the slab, as in Flow::manifold, and its point.
  void answer(size_t slab, const Question& question, uint32_t terminal, const CriticalPoint& point);
  /// When all is answered.
  void finish();

  /// Tells the numbers of the terminals of a slab, as in GraphPart, if they are wanted.
  void tellNumbers(size_t slab, const std::vector<uint32_t>& numbers);
  /// The terminals of a slab that lead to other slabs, and those that others lead to.
  std::vector<SlabLead> leads(size_t slab) const;

 private:
  /// A ball of another slab.
  struct Foreign {
    uint32_t terminal;
    uint32_t next;  ///< where it flows to: another terminal; its critical point, if finished
    // What is known of `next`:
    Coord position;
    int32_t squaredRadius;
  };
  /// A critical point that terminals of several slabs lead to.
  struct Shared {
    uint32_t terminal;
    uint32_t first, last;  ///< the lowest and the highest slab with such a terminal
    uint32_t foreign;      ///< a ball that leads there
    uint32_t number = 0;
  };

  size_t slabOf(int z) const;
  uint32_t slabOfTerminal(uint32_t terminal) const;
  std::vector<Foreign>::const_iterator foreignFrom(uint32_t terminal) const;
  size_t sharedFrom(uint32_t terminal) const;
  SlabRoot rootOf(const Shared& shared) const;

  std::vector<int> cuts_;
  std::vector<uint32_t> first_{0};  // terminal of each slab; one more at the end
  std::vector<Foreign> foreign_;    // ascending by terminal
  std::vector<std::vector<Question>> questions_;
  std::vector<Shared> shared_;  // ascending by terminal
};

}  // namespace vdb_madf::detail
