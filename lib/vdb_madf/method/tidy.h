// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"
#include "vdb_madf/method/voxel_weights.h"

namespace vdb_madf {

constexpr int kTidy = 2;        ///< rounds of smoothing, by default
constexpr int kMaxTidy = 1000;  ///< labels may go to and fro for ever

/// @throw InvalidInput unless rounds is in [0, kMaxTidy].
void checkTidy(int rounds);

/// Grain labels by voxel, and what is kept of each grain g at g - 1.
struct GrainLabels {
  VoxelArray<uint32_t> label;  ///< 1 .. grains; 0: not of the object (a cavity)
  std::vector<Coord> representative;
  std::vector<int64_t> voxels;
  VoxelWeights weights{};  ///< of the metric in which a voxel is nearest to a representative
};

/// Tidies the interfaces of grains (not in the paper): manifolds meet in combs and leave crumbs,
/// since the flow of a voxel is that of its ball. Neither the number of grains changes nor their
/// numbers. The anchor of a grain, which never changes, is its voxel nearest to the representative
/// (then of smaller coordinate): the representative itself, unless that lies in a cavity.
///
/// Smoothing: `rounds` synchronous rounds. A voxel p of label a, no anchor, takes of a and the
/// labels of its six neighbors the one that most object voxels of the 3 x 3 x 3 cube around p have;
/// a if that is among the most frequent, else the smallest label among them. Connection, then:
/// voxels that no 6-connected path of their label joins with its anchor lose the label. In
/// synchronous rounds each takes the label that most of its six neighbors have (of equally frequent
/// ones the smallest), until a round changes nothing. Those never reached, which lie beside
/// cavities, keep the label they had. 0 rounds: nothing is done. @throw InvalidInput as checkTidy;
/// Interrupted
void tidy(const LeafIndex& index, int rounds, GrainLabels& grains,
          Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
