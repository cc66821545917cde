// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "measure_arguments.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf::tools {

/// Prints what a user looks at first.
void print(const MeasureArguments& arguments, const Measurements& measurements);

}  // namespace vdb_madf::tools
