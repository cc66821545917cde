// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/measure/measure_sample.h"

namespace vdb_madf::detail {

/// Is this the box of the scan that the labels were made of (fitsScan())?
/// @throw InvalidInput, one line that begins with the path
void checkScanBox(const std::string& path, const CoordBBox& scan, const SampleMeasures& sample);

}  // namespace vdb_madf::detail
