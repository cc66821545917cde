// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "input_options.h"
#include "scan_option.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/intensity/measure_sensitivity.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf::tools {

/// What was typed after `measure`, and what it means.
struct MeasureArguments {
  InputOptions input;
  std::string folder, boundary = "auto", density, minFaces = "1", bootstrap, plot, sizeCurve,
                      sizeReference;
  ScanOption intensity{"", "", "--intensity"}, gray{"", "", "--gray"}, phases{"", "", "--phases"};
  std::string binderText, bridges;
  int64_t binder = 1;
  std::string runs, vary;
  bool ice = false, stability = false;
  MeasureOptions measure;
  std::optional<SensitivityOptions> sensitivity;
  TableOptions tables;
};

/// Reads the texts. @throw WrongUsage
void parse(MeasureArguments& arguments);

}  // namespace vdb_madf::tools
