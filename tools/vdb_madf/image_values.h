// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "input_options.h"
#include "json_file.h"
#include "vdb_madf/pictures/plot_type.h"
#include "vdb_madf/scans/histogram.h"

namespace vdb_madf::tools {

/// What `info` says of the values of an image, which it counts. @throw as histogramOf()
Histogram countValues(const InputOptions& input, Progress* progress);
void describeValues(const InputOptions& input, const Histogram& histogram, Json& json,
                    Progress* progress);
/// The bytes of a plot of the histogram. @throw InvalidInput if it has one value at most
std::string plotValues(const InputOptions& input, const Histogram& histogram, PlotType type);

}  // namespace vdb_madf::tools
