// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/method/merge.h"

namespace vdb_madf {

/// The manifolds of a graph, joined two by two, the best first (agglomerative clustering).
struct Hierarchy {
  static constexpr int kUnitsOfScore = 512;

  /// What is joined: manifolds that one local maximum of the height has.
  struct Class {
    uint32_t representative = 0;  ///< its node of largest D, then of smaller coordinate
    int32_t top = 0;              ///< the largest D
    int64_t voxels = 0;           ///< of its manifolds, in the object
    int64_t cavityVoxels = 0;     ///< of its manifolds, in cavities that were filled
  };
  /// Two classes become one. Each is named by the class of its representative, and so is the one:
  /// the one of larger top; of equal tops `first`.
  struct Join {
    uint32_t first = 0, second = 0;  ///< indices of classes; first < second
    int32_t score = 0;               ///< in units of 1 / kUnitsOfScore
  };

  std::vector<uint32_t> classOfNode;
  std::vector<Class> classes;  ///< in the order of their representatives
  std::vector<Join> joins;     ///< in the order in which they are made; scores may rise again
  double lowest = 0;           ///< joins of smaller scores, and what follows them, are left out
};

/// Joins manifolds by their sizes, contacts and necks (not in the paper).
///
/// The classes to begin with: those of merge() by the neck at theta -1, delta 0, which merges only
/// what is no local maximum of the height. Of a class, V is the number of its voxels, those in
/// filled cavities included, m its top; of two classes that touch, F is the number of contact faces
/// between them, h the largest saddle height. A join adds V and F, and takes the larger m and h.
///
/// Of a pair of classes with h > 0, a is the one of smaller m, then of smaller V, then of larger
/// representative; b the other one. Its score is, with U = V, but no more than sqrt(18 m^3) (about
/// the class's largest ball), but no less than V / 4,
///   log2(V_b / U_a) + 9 sqrt(m_a / m_b) + 2.5 F / U_b^(2/3) - 4 (sqrt(m_a) - sqrt(h))
///     + 1.5 max(0, 7 - log2 V_a):
/// pieces of a body are alike and meet in broad contacts, or are small beside their neighbor; a
/// grain has a radius of its own, a size, or a narrow neck. Lengths of the fourth term are in
/// shortest edges of a voxel, V and F in voxels and faces, all in integers (detail/join_score.h).
/// From 2^43 voxels and 2^31 faces on, a class and a contact count as one less.
///
/// In a plane, where the domain is one voxel thick (ManifoldGraph::flatAxis), V is an area and F a
/// length: U is V, but no more than 2.5 m (about the largest disc), but no less than V / 4, and the
/// score is
///   1.5 log2(V_b / U_a) + 8 sqrt(m_a / m_b) + 3 F / sqrt(U_b) - 2.5 (sqrt(m_a) - sqrt(h))
///     + max(0, 6 - log2 V_a).
///
/// Where the domain is cut open, the ball of a class may reach out of it: then m may be too large,
/// as nothing out there can end the ball, and the end of a rod would be a grain by its radius. Let
/// s be the largest D of those balls of a class that lie in the domain (CriticalPoint::doubt); 0 if
/// none does. For the score, but not for the order of a and b,
///   m_a, if s_a < m_a, is the largest of s_a, min(m_a, s_b), h and 0.9 m_a;
///   m_b, if s_b < m_b and V_b <= V_a, is the larger of s_b and that m_a:
/// a top that is not sure is what fits the neighbor. A class of more voxels than the neighbor is no
/// end of it, so its top is believed.
///
/// Again and again the pair of largest score is joined; of equal ones that whose smaller
/// representative is lexicographically smaller, then the other one.
///
/// Time is about (edges) log (edges), with a factor for classes with many neighbors of larger m.
/// @param lowest ends at the first largest score below it, to the nearest unit; the default: joins
///   all that has a score
/// @throw InvalidInput unless lowest is in [-kMaxStrictness, kMaxStrictness].
Hierarchy mergeHierarchy(const ManifoldGraph& graph, double lowest = -kMaxStrictness);
/// Joins the manifolds of a graph that nobody needs afterwards: its memory is given back before the
/// joins.
Hierarchy mergeHierarchy(ManifoldGraph&& graph, double lowest = -kMaxStrictness);

/// A join, told of the grains that it makes one.
struct JoinedGrains {
  uint32_t first = 0, second = 0;             ///< nodes: their representatives
  int64_t firstVoxels = 0, secondVoxels = 0;  ///< in the object; may be 0
  double score = 0;
  double strictness =
      0;               ///< the largest one at which cut() makes this join: the least score so far
  int64_t grains = 0;  ///< that are left, of those with voxels in the object
};

/// What is joined to what, join by join.
std::vector<JoinedGrains> joinedGrains(const Hierarchy& hierarchy);

/// The grains at a strictness, which is rounded to the nearest unit (halves away from 0): those of
/// the joins before the first one of a smaller score. That is merge() with MergeMode::score, this
/// strictness and no minGrain: it joins the same pairs in the same order until the largest score is
/// smaller. So each grain is a union of grains at any larger strictness. Grains are numbered as by
/// merge().
/// @throw InvalidInput unless strictness is in [hierarchy.lowest, kMaxStrictness].
Merging cut(const Hierarchy& hierarchy, double strictness);

/// Voxels of grain g of a cut at g - 1.
std::vector<int64_t> grainVoxels(const Hierarchy& hierarchy, const Merging& merging);

/// How many joins, from the first on, cut() makes. @throw InvalidInput as cut()
size_t joinsAt(const Hierarchy& hierarchy, double strictness);

}  // namespace vdb_madf
