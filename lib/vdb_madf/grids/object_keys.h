// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf {

/// Metadata of a mask and of its labels that says how the object was made of a gray image.
inline constexpr char kObjectKey[] = "madf_object";        ///< the steps in their order (string)
inline constexpr char kThresholdKey[] = "madf_threshold";  ///< the least value of it (double)
inline constexpr char kThresholdLowKey[] = "madf_threshold_low";  ///< of hysteresis (double)

}  // namespace vdb_madf
