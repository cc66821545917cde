// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>

namespace vdb_madf {

/// Files that plots are drawn to. In SVG and PDF letters are outlines or come with their font, so
/// that they look the same everywhere; PNG has 300 dpi.
enum class PlotType { png, svg, pdf };

/// The type by the ending of the file's name, in any case: .png, .svg, .pdf; none for others.
std::optional<PlotType> plotTypeOf(const std::string& path);

}  // namespace vdb_madf
