// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Reference numbers of real data: nmc.tif, the tomography of a battery electrode (phase 1, 301 x
// 301 x 251 voxels; NREL MATBOX example data). The folder that holds it is named by the environment
// variable VDB_MADF_DATA or, without it, by the definition VDB_MADF_DATA_DIR. An independent dense
// implementation of the method computed the numbers.

#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

#include "support/catch.h"
#include "support/invariants.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/scans/read_mask.h"
#include "vdb_madf/segmentation/segment.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

std::string dataFile() {
  const char* folder = std::getenv("VDB_MADF_DATA");
#ifdef VDB_MADF_DATA_DIR
  if (!folder) folder = VDB_MADF_DATA_DIR;
#endif
  return folder ? std::string(folder) + "/nmc.tif" : std::string();
}

/// Read once for all sections. Null, with a warning, if there is no such file.
MaskGrid::Ptr nmc() {
  static const MaskGrid::Ptr kMask = []() -> MaskGrid::Ptr {
    const std::string path = dataFile();
    if (path.empty() || !std::ifstream(path)) return nullptr;
    const auto image = openImage(path);
    return readMask(*image, Selection::phase(1));
  }();
  if (!kMask)
    WARN("SKIPPED: no nmc.tif"
         << (dataFile().empty() ? std::string() : " at " + dataFile())
         << ". Set VDB_MADF_DATA to the folder that holds it. Nothing was checked.");
  return kMask;
}

struct Row {
  Boundary boundary;
  int64_t gamma;
  int64_t medialBalls, keptBalls, criticalPoints;
  int64_t angle, both, neck;  // grains at theta -0.8
};

constexpr Row kRows[] = {{Boundary::closed, 0, 868123, 868123, 87324, 56699, 2047, 2098},
                         {Boundary::closed, 20, 868123, 103610, 11795, 4661, 2606, 2667},
                         {Boundary::closed, 160, 868123, 10864, 3216, 1697, 1624, 1626},
                         {Boundary::open, 0, 768750, 768750, 38793, 30506, 2156, 2188},
                         {Boundary::open, 20, 768750, 100368, 7927, 3901, 2232, 2254},
                         {Boundary::open, 160, 768750, 11756, 3205, 1815, 1747, 1748}};

int64_t grains(const ManifoldGraph& graph, double theta, MergeMode mode) {
  const Merging merging = merge(graph, {mode, 11, theta, 0, Adjacency::manifold});
  return int64_t(merging.representative.size());
}

}  // namespace

TEST_CASE("nmc: the image is read as described", "[nmc]") {
  const MaskGrid::Ptr mask = nmc();
  if (!mask) return;
  CHECK(mask->activeVoxelCount() == 11357945);
  CHECK(storedDomain(*mask) == CoordBBox(Coord(0), Coord(300, 300, 250)));
}

TEST_CASE("nmc: all reference counts", "[nmc]") {
  const MaskGrid::Ptr mask = nmc();
  if (!mask) return;
  for (const Row& row : kRows) {
    SegmentOptions options;
    options.gamma = row.gamma;
    options.boundary = row.boundary;
    options.merge = {MergeMode::both, 11, -0.8, 0, Adjacency::manifold};
    options.fillHoles = options.tidy = 0;
    const Segmentation result = segment(*mask, options);
    INFO((result.open ? "open" : "closed") << ", gamma " << row.gamma);
    CHECK(result.counts.objectVoxels == 11357945);
    CHECK(result.counts.medialBalls == row.medialBalls);
    CHECK(result.counts.keptBalls == row.keptBalls);
    CHECK(result.counts.criticalPoints == row.criticalPoints);
    CHECK(result.counts.grains == row.both);
    CHECK(grains(result.graph, -0.8, MergeMode::angle) == row.angle);
    CHECK(grains(result.graph, -0.8, MergeMode::both) == row.both);
    CHECK(grains(result.graph, -0.8, MergeMode::neck) == row.neck);
    if (row.gamma != 0) continue;
    const bool open = row.boundary == Boundary::open;
    CHECK(grains(result.graph, -0.9, MergeMode::angle) == (open ? 32638 : 66910));
    CHECK(grains(result.graph, -0.9, MergeMode::both) == (open ? 2315 : 2214));
    CHECK(grains(result.graph, -0.9, MergeMode::neck) == (open ? 2382 : 2291));
  }
}

TEST_CASE("nmc: cavities, and necks narrower by less than delta", "[nmc]") {
  struct Filled {
    Boundary boundary;
    int64_t fillHoles;
    int delta;
    int64_t cavities, cavityVoxels, medialBalls, criticalPoints, grains;
  };
  const MaskGrid::Ptr mask = nmc();
  if (!mask) return;
  for (const Filled& row : {Filled{Boundary::open, 0, 2, 0, 0, 768750, 38793, 2105},
                            Filled{Boundary::open, 27, 0, 326, 664, 767175, 38533, 2304},
                            Filled{Boundary::open, 27, 2, 326, 664, 767175, 38533, 2099},
                            Filled{Boundary::open, 100, 2, 328, 721, 767117, 38515, 2099},
                            Filled{Boundary::closed, 0, 2, 0, 0, 868123, 87324, 1995},
                            Filled{Boundary::closed, 27, 0, 291, 548, 866770, 87058, 2204},
                            Filled{Boundary::closed, 27, 2, 291, 548, 866770, 87058, 1988},
                            Filled{Boundary::closed, 100, 2, 292, 578, 866744, 87055, 1988}}) {
    SegmentOptions options;
    options.boundary = row.boundary;
    options.fillHoles = row.fillHoles;
    options.merge.mode = MergeMode::both;
    options.merge.delta = row.delta;
    const Segmentation result = segment(*mask, options);
    INFO((result.open ? "open" : "closed")
         << ", fill-holes " << row.fillHoles << ", delta " << row.delta);
    CHECK(result.counts.objectVoxels == 11357945);
    CHECK(result.counts.cavities == row.cavities);
    CHECK(result.counts.cavityVoxels == row.cavityVoxels);
    CHECK(result.counts.medialBalls == row.medialBalls);
    CHECK(result.counts.criticalPoints == row.criticalPoints);
    CHECK(result.counts.grains == row.grains);
    CHECK(result.flaws.inPieces == 0);
  }
}

TEST_CASE("nmc: grains by score", "[nmc]") {
  const MaskGrid::Ptr mask = nmc();
  if (!mask) return;
  const Segmentation result = segment(*mask);
  CHECK(result.counts.grains == 2145);
  CHECK(result.flaws.crumbs == 24);
  CHECK(result.flaws.slivers == 7);
  for (const auto& [strictness, grains] :
       {std::pair(10., 2106), {10.5, 2124}, {11.5, 2177}, {12., 2204}})
    CHECK(int(merge(result.graph, {MergeMode::score, strictness}).representative.size()) == grains);
}

TEST_CASE("nmc: the invariants hold", "[nmc]") {
  const MaskGrid::Ptr mask = nmc();
  if (!mask) return;
  SegmentOptions options;
  options.keepDistance = options.keepPower = options.keepManifold = options.keepBalls = true;
  for (const int64_t gamma : {0, 20}) {
    options.gamma = gamma;
    options.boundary = gamma == 0 ? Boundary::open : Boundary::closed;
    if (gamma > 0) options.fillHoles = options.tidy = 0;  // then more of them apply
    const Segmentation result = segment(*mask, options);
    INFO("gamma " << gamma);
    CHECK(anyViolation(result, *mask, gamma) == "");
  }
}
