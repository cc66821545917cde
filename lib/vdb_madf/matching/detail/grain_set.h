// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/labels/detail/label_contacts.h"
#include "vdb_madf/matching/detail/scan_labels.h"
#include "vdb_madf/matching/detail/track_sides.h"
#include "vdb_madf/matching/match_grains.h"

namespace vdb_madf::detail {

/// What is known of the grains of labels; lengths are in voxels, which are boxes.
struct ScanSums {
  GrainSet set;  ///< from exact sums; contacts are of a face or more
  std::vector<LabelContact> contacts;
};
/// @param open what grains are cut at: of such a voxel has a face neighbor outside of it
/// @throw Interrupted; what reading throws
ScanSums scanSums(ScanLabels& labels, const std::optional<Domain>& open, Interrupter* interrupter);

/// Chooses from pairs of labels, the smaller one first, those of which two voxels lie at most `gap`
/// apart, from center to center. @throw as scanSums()
std::set<LabelPair> nearPairs(ScanLabels& labels, const std::set<LabelPair>& pairs, int gap,
                              Interrupter* interrupter);

/// How grains moved, by number.
using Motions = std::map<int32_t, Motion>;

/// Chooses from pairs of labels those between which there is something solid in another scan, at
/// most of the places of their faces when these are moved; of pairs without motions none.
/// @throw as scanSums()
std::set<LabelPair> solidPairs(ScanLabels& labels, ScanLabels& other,
                               const std::set<LabelPair>& pairs, const Motions& motions,
                               Interrupter* interrupter);

/// How many voxels of each grain before lie in each one after when they are moved, those of a grain
/// of before by its motion; those without one stay out. @throw as scanSums()
std::map<LabelPair, int64_t> movedOverlaps(ScanLabels& before, ScanLabels& after,
                                           const Motions& motions, Interrupter* interrupter);

}  // namespace vdb_madf::detail
