// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Files and folders of slabs whose content is not what was written into them.

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "support/catch.h"
#include "support/damage.h"
#include "support/temporary_folder.h"
#include "support/vdb_files.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/slab_folder_writer.h"
#include "vdb_madf/vdb/write_vdb.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// All that a volume holds, as the bytes of a file.
std::string contentOf(const std::string& path, const std::string& copy) {
  const auto grids = readVdb(path);
  writeVdb(copy, {grids.begin(), grids.end()});
  return bytesOf(copy);
}

/// Labels with a graph, and what is kept beside them; several trees, one of them shared.
Grids keptGrids(const Coord& center) {
  const auto labels = ballWithTiles<Int32Grid>(center, 9, "grain");
  setGraph(*labels, smallGraph());
  setDomain(*labels, CoordBBox(Coord(-400), Coord(400)));
  setVoxelSize(*labels, VoxelSize(8.5e-6));
  const auto sharing = labels->copyWithNewTree();
  sharing->setTree(labels->treePtr());
  sharing->setName("manifold");
  return {labels, ballWithTiles<FloatGrid>(center, 7, "distance"), sharing,
          ballWithTiles<BoolGrid>(center, 5, "object"), ballWithTiles<MaskGrid>(center, 5, "mask")};
}

/// What became of files with one changed bit.
struct Flips {
  int refused = 0, harmless = 0;
};

/// Flips a bit of a file again and again, half of them near its begin. @param isHarmless whether
/// what is read now is what was written
Flips flipBits(const std::string& file, int count, const std::function<bool()>& isHarmless) {
  const std::string bytes = bytesOf(file);
  Flips flips;
  std::mt19937 random(uint32_t(bytes.size()));
  for (int i = 0; i < count; ++i) {
    const size_t at = random() % (i % 2 ? std::min<size_t>(bytes.size(), 1500) : bytes.size());
    const int bit = int(random() % 8);
    std::string changed = bytes;
    changed[at] = char(changed[at] ^ (1 << bit));
    writeBytes(file, changed);
    INFO("bit " << bit << " of byte " << at << " of " << bytes.size());
    try {
      const bool harmless = isHarmless();
      REQUIRE(harmless);
      ++flips.harmless;
    } catch (const IoError& error) {
      requireOneLineNaming(error.what(), file);
      ++flips.refused;
    }
  }
  writeBytes(file, bytes);
  return flips;
}

}  // namespace

TEST_CASE("vdb_digest: a file with one bit changed is refused, or holds the same", "[vdb_digest]") {
  initialize();
  const TemporaryFolder folder;
  const std::string copy = folder.file("copy.vdb");
  const auto inRegion = ballWithTiles<Int32Grid>(Coord(0), 2, "grain");
  setDomain(*inRegion, Domain(ballWithTiles<MaskGrid>(Coord(0, -8, 0), 5, "mask")->tree()));
  // More than the buffer of a writer holds.
  const auto large = FloatGrid::create();
  std::mt19937 random(1);
  for (int i = 0; i < 300000; ++i)
    large->tree().setValue(Coord(i % 70, i / 70 % 70, i / 4900), float(random()));
  const auto check = [&](const std::string& name, const Grids& grids, int count) {
    INFO(name);
    const std::string path = folder.file(name);
    writeVdb(path, grids);
    const std::string content = contentOf(path, copy);
    const auto isHarmless = [&] { return contentOf(path, copy) == content; };
    const Flips flips = flipBits(path, count, isHarmless);
    INFO(flips.refused << " refused, " << flips.harmless << " harmless");
    CHECK(flips.refused > count * 9 / 10);
  };
  const int count = mutationsPerFormat(100);
  check("kept.vdb", keptGrids(Coord(-5, 3, 9)), count);
  check("region.vdb", {inRegion}, count);
  check("large.vdb", {large, keptGrids(Coord(3)).front()}, count / 20);
}

TEST_CASE("vdb_digest: any grid of a file that was changed is refused, unless that is meant",
          "[vdb_digest]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  writeVdb(path, keptGrids(Coord(-5, 3, 9)));
  std::string bytes = bytesOf(path);
  // The wanted grid is the first one, the changed one the last.
  const size_t at = bytes.rfind("mask", bytes.size() - 200);
  REQUIRE(at != std::string::npos);
  bytes[at] = 'M';
  writeBytes(path, bytes);
  VdbReadOptions reading;
  reading.wanted = [](const auto& grid) { return grid.getName() == "grain"; };
  const std::string error = errorOf(path, reading);
  requireOneLineNaming(error, path);
  CHECK_THAT(error, vdb_madf::test::Contains("is not what was written"));
  CHECK_THROWS_AS(readVdbHeaders(path, nullptr, /*verified=*/true), IoError);
  CHECK(readVdbHeaders(path).size() == 5);
  {
    const Unverified unverified;
    CHECK(errorOf(path, reading).empty());
    CHECK(readVdbHeaders(path, nullptr, /*verified=*/true).size() == 5);
  }
  // What another program writes has no digest.
  writeWithOpenVdb(path, keptGrids(Coord(-5, 3, 9)));
  CHECK(errorOf(path).empty());
}

TEST_CASE("vdb_digest: a folder of slabs with one bit changed is refused, or holds the same",
          "[vdb_digest]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.slabs"), copy = folder.file("copy.vdb");
  {
    const SlabFolderWriter writer(path, {-16, 0, 16});
    for (const int slab : {0, 1}) {
      const auto labels = Int32Grid::create();
      labels->setName("grain");
      for (int i = 0; i < 400; ++i)
        labels->tree().setValue(Coord(i % 20, i / 20, 16 * slab - 1 - i % 9), 1 + i / 50);
      writer.write(size_t(slab), {labels});
    }
    writer.commit(R"({"grains": 8, "strictness": 11.5, "input": "scan.tif"})");
  }
  const std::string index = (std::filesystem::path(path) / kSlabIndex).string();
  const auto indexContent = [&] {
    auto json = nlohmann::json::parse(bytesOf(index));
    json.erase("digest");
    return json;
  };
  const std::string content = contentOf(path, copy);
  const nlohmann::json said = indexContent();
  const auto isHarmless = [&] {
    if (contentOf(path, copy) != content) return false;
    // The digest may have lost its name; a folder of before this had none.
    const nlohmann::json found = indexContent();
    for (const auto& [key, value] : found.items())
      if (said.contains(key) ? value != said[key] : !value.is_string()) return false;
    return found.size() >= said.size();
  };
  REQUIRE(isHarmless());
  const int count = mutationsPerFormat(100);
  for (const std::string& file : {folder.file("a.slabs/slab-0001.vdb"), index}) {
    const Flips flips = flipBits(file, count, isHarmless);
    INFO(file << ": " << flips.refused << " refused, " << flips.harmless << " harmless");
    CHECK(flips.refused > count / 2);
  }
}
