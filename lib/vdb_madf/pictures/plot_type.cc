// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/plot_type.h"

#include "vdb_madf/files/file_name.h"

namespace vdb_madf {

std::optional<PlotType> plotTypeOf(const std::string& path) {
  const std::string ending = fileEnding(path);
  if (ending == ".png") return PlotType::png;
  if (ending == ".svg") return PlotType::svg;
  if (ending == ".pdf") return PlotType::pdf;
  return std::nullopt;
}

}  // namespace vdb_madf
