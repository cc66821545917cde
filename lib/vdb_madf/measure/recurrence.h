// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf {

/// How often a grain or a bond came again when a scan was segmented by other choices.
struct Recurrence {
  double share = 0;  ///< of the runs, 0 to 1
  /// Standard deviation over these of the grain's volume, or of the bond's area.
  double deviation = 0;
};

}  // namespace vdb_madf
