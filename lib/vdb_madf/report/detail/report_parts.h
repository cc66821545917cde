// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/pictures/grain_view.h"
#include "vdb_madf/report/detail/grain_levels.h"
#include "vdb_madf/report/report.h"

namespace vdb_madf::detail {

/// What a page has of a sample: elements of data, each with an id that ends with a suffix of the
/// sample's own.
class ReportParts {
 public:
  /// Measures. Labels and options must live as long. @throw as writeReport()
  ReportParts(const AnyLabels& labels, const ReportOptions& options, std::string suffix,
              Interrupter* interrupter);

  const Measurements& measured() const { return measured_; }
  std::string title() const;
  std::string unit() const;
  Report report() const;

  std::string tables() const;
  std::string colors(const GrainColors& colors) const;
  std::string sweep() const;
  std::string slices();
  /// The scan under the slices, after these; empty if there is none. A byte a voxel of theirs, x
  /// fastest, then y, then z: from 0, black, to about().gray.levels - 1, white.
  std::string gray() const;
  std::string mesh();
  /// What the slider needs; empty if there is none.
  std::string levels() const;
  /// After slices(), mesh() and levels(), if there are these: it tells how to read them.
  std::string about() const;
  /// An image element for where there is no WebGL, and for paper: on any ground, light or dark.
  /// @param colors none: those of the labels
  std::string picture(const std::optional<GrainColors>& colors = std::nullopt) const;

 private:
  void begin(const char* stage) const;
  void addLevels();
  /// What mesh and slices show: the leaves of the slider, or the labels.
  const AnyLabels& bodies() const { return levels_ ? levels_->leaves : labels_; }
  const Measurements& bodyMeasures() const { return levels_ ? *leafMeasures_ : measured_; }
  std::vector<int32_t> bodyIds() const;

  const AnyLabels& labels_;
  const ReportOptions& options_;
  const std::string suffix_;
  Interrupter* interrupter_;
  const ViewOptions view_;
  Measurements measured_;
  CoordBBox box_, sliceBox_;
  std::vector<int32_t> ids_;
  std::optional<GrainLevels> levels_;
  std::optional<Measurements> leafMeasures_;
  PackedLeaves packedLeaves_;
  int reduction_ = 1;
  uint64_t points_ = 0, triangles_ = 0;  ///< of the mesh
  double step_ = 0;
};

}  // namespace vdb_madf::detail
