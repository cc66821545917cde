// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "pack_slabs.h"

#include "json_file.h"
#include "part_folder.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

void writePackSlabs(const std::string& out, const PackSlabs& slabs, const Common& common) {
  const PartFolder folder(out);
  Json index;
  index["format"] = "vdb_madf slabs";
  index["format_version"] = 1;
  index["version"] = kVersion;
  index["slabs"] = Json::array();
  for (size_t s = 0; s < slabs.slabCount(); ++s) {
    const BoolGrid::Ptr slab = toBoolGrid(*slabs.object(s, common.progress));
    markSlab(*slab, s, slabs.slabCount());
    writeVdb(folder.file(slabFileName(s)), {slab}, common.progress);
    index["slabs"].push_back({{"file", slabFileName(s)},
                              {"z_first", slabs.cuts()[s]},
                              {"z_last", slabs.cuts()[s + 1] - 1}});
  }
  index["object_voxels"] = slabs.objectVoxels();
  JsonFile(folder.file(kSlabIndex)).write(index);
  folder.commit();
}

}  // namespace vdb_madf::tools
