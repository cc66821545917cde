// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/matching/track.h"

namespace vdb_madf::detail {

/// track() with a motion.
Tracks motionTracks(const AnyLabels& before, const AnyLabels& after, const TrackOptions& options,
                    Interrupter* interrupter);

}  // namespace vdb_madf::detail
