// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "pack_slabs.h"

#include <filesystem>

#include "json_file.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

namespace {

namespace fs = std::filesystem;

/// A folder that goes again unless it is put in its place.
class PartFolder {
 public:
  explicit PartFolder(const std::string& out) : out_(out), path_(out + ".part") {
    checkSlabFolder(out_);
    std::error_code error;
    if (!fs::create_directory(path_, error))
      throw IoError("cannot make " + path_ + ": " +
                    (error ? error.message() + "; make its folder first"
                           : "it is there; remove it, or choose another name"));
  }
  ~PartFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  PartFolder(const PartFolder&) = delete;
  PartFolder& operator=(const PartFolder&) = delete;

  std::string file(const std::string& name) const { return (fs::path(path_) / name).string(); }
  void commit() const { commitSlabFolder(path_, out_); }

 private:
  std::string out_, path_;
};

}  // namespace

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
