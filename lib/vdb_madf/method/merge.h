// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/method/manifold_graph.h"

namespace vdb_madf {

enum class MergeMode {
  both,   ///< the angle test, then the neck test
  angle,  ///< the angle test alone (the paper)
  neck,   ///< the neck test alone
  score   ///< joins by score, the best first (hierarchy.h): the default
};
enum class Adjacency {
  manifold,  ///< the angle test sees all edges of the graph
  cell       ///< only those where the cells of the critical points touch (as the paper words it)
};

/// When manifolds are one grain; see merge(). strictness is for MergeMode::score; theta, delta and
/// adjacency are for the tests.
struct MergeOptions {
  MergeMode mode = MergeMode::score;
  /// The least score that joins two classes, to the nearest 1/512 (hierarchy.h); the larger, the
  /// more grains; -kMaxStrictness to kMaxStrictness.
  double strictness = 11;
  double theta = -0.9;  ///< cosine in [-1, 1]; -1 merges least
  /// How much narrower than the smaller grain a neck has to be at least to divide, in eighths of
  /// the shortest edge of a voxel; 0 to kMaxDelta; 0: theta alone decides.
  int delta = 2;
  Adjacency adjacency = Adjacency::manifold;
  /// Grains of fewer voxels then join the neighbor of most shared faces (join_small.h); 0: none.
  int64_t minGrain = 0;
};

constexpr int kMaxDelta = 80;              ///< ten voxels
constexpr double kMaxStrictness = 200000;  ///< no score is larger, and none smaller than -200000

/// Grains as classes of critical points.
struct Merging {
  /// 1..grains, one per node; 0: the node's class holds no voxel of the object.
  std::vector<int32_t> grainOfNode;
  /// Node of grain g at g - 1: the one of largest D, then of smaller coordinate.
  std::vector<uint32_t> representative;
};

/// @throw InvalidInput unless theta is in [-1, 1] (NaN is not), delta in [0, kMaxDelta], strictness
///   in [-kMaxStrictness, kMaxStrictness] and minGrain 0 or more.
void checkMergeOptions(const MergeOptions& options);

/// Merges critical points by score, or by the angle of their balls (paper, section 5.2, eq. 7) and
/// the neck.
///
/// Score (not in the paper): cut(mergeHierarchy(graph), strictness) of hierarchy.h.
/// Angle: an edge merges its nodes if
///   cos alpha = (|ci - cj|^2 - D(ci) - D(cj)) / (2 sqrt(D(ci) D(cj))) < theta;
/// each edge is tested once, on the original balls.
/// Neck (not in the paper): the edges of saddle height h > 0, in descending order of h (then by
/// ascending pair), merge the classes a, b of their nodes if
///   h >= (1 - theta) / 2 * min(top(a), top(b)),
/// where top is the largest D of a class so far; or if, with m = min(top(a), top(b)),
///   sqrt(m) - sqrt(h) < delta / 8 of the shortest edge of a voxel:
/// theta compares radii in proportion, but the error of a digital radius is some tenths of a voxel
/// whatever the grain. (Decided in integers.)
/// Small grains (not in the paper): with minGrain, joinSmallGrains() of join_small.h follows.
/// Grains are numbered in lexicographic order of their representatives.
/// @throw InvalidInput as checkMergeOptions.
Merging merge(const ManifoldGraph& graph, const MergeOptions& options = {});

/// The grains of a rule of one's own: nodes of one class are one grain; classes may have any number
/// from 0 to the number of nodes. Grains are numbered as by merge(), whatever the classes' numbers.
/// @throw InvalidInput unless every node has a class in that range.
Merging mergeClasses(const ManifoldGraph& graph, const std::vector<uint32_t>& classOfNode);

/// Voxels of grain g at g - 1.
std::vector<int64_t> grainVoxels(const ManifoldGraph& graph, const Merging& merging);

}  // namespace vdb_madf
