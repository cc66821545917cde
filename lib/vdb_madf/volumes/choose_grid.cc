// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/choose_grid.h"

#include <fmt/core.h>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/vdb/slab_folder.h"

namespace vdb_madf {

namespace {

bool isUsable(const openvdb::GridBase& grid, GridUse use) {
  if (use == GridUse::labels) return grid.isType<Int32Grid>();
  const std::string type = grid.valueType();
  return grid.isType<MaskGrid>() || type == "bool" || type == "int32" || type == "int64" ||
         type == "float" || type == "double";
}

std::vector<const char*> preferredNames(GridUse use) {
  switch (use) {
    case GridUse::object:
      return {"object"};
    case GridUse::labels:
      return {"grain", "truth"};
    case GridUse::values:
      break;
  }
  return {"grain", "truth", "object"};
}

}  // namespace

AmbiguousGrid::AmbiguousGrid(const std::string& path, const std::string& grids)
    : InvalidInput(path + ": choose a grid by its name; the file holds " + grids), grids_(grids) {}

bool isVdbFile(const std::string& path) {
  if (isSlabFolder(path)) return true;
  try {
    // OpenVDB's magic number: ' BDV' as a little-endian 64-bit integer.
    if (detail::InputFile(path).head(8) == std::string(" BDV\0\0\0\0", 8)) return true;
  } catch (const IoError&) {  // nothing there to look at
  }
  return fileEnding(path) == ".vdb" && !looksLikeImage(path);
}

openvdb::GridBase::Ptr chooseGrid(const std::vector<openvdb::GridBase::Ptr>& grids,
                                  const std::string& path, GridUse use, const std::string& name) {
  std::string list;
  std::vector<openvdb::GridBase::Ptr> usable;
  for (const auto& grid : grids) {
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", grid->getName(), grid->valueType());
    if (isUsable(*grid, use) && !isRegion(*grid, grids)) usable.push_back(grid);
  }
  if (list.empty()) throw InvalidInput(path + ": the file holds no grid");
  if (!name.empty()) {
    for (const auto& grid : grids) {
      if (grid->getName() != name) continue;
      if (isUsable(*grid, use)) return grid;
      throw InvalidInput(fmt::format("{}: grid '{}' holds {} values, which this command cannot use",
                                     path, name, grid->valueType()));
    }
    throw InvalidInput(
        fmt::format("{}: there is no grid '{}'; the file holds {}", path, name, list));
  }
  for (const char* preferred : preferredNames(use))
    for (const auto& grid : usable)
      if (grid->getName() == preferred) return grid;
  if (usable.size() == 1) return usable[0];
  if (!usable.empty()) throw AmbiguousGrid(path, list);
  throw InvalidInput(fmt::format(
      "{}: there is no grid of {}; the file holds {}", path,
      use == GridUse::labels ? "labels (int32), such as segment writes" : "a mask or numbers",
      list));
}

}  // namespace vdb_madf
