// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/clump_folder.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Mat3d;
using openvdb::Vec3d;

namespace {

/// All numbers of a file that has commas between them.
std::vector<double> numbersOf(const std::string& path) {
  std::string text = readFile(path);
  for (char& c : text)
    if (c == ',') c = ' ';
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (double number; stream >> number;) numbers.push_back(number);
  return numbers;
}

}  // namespace

TEST_CASE("clump_folder: with its axes a clump lies as in the scan", "[clump_folder]") {
  const ScratchFolder folder;
  LabelMap voxels;  // a bent rod without symmetry, label 12, and a voxel without balls
  for (int i = 0; i < 12; ++i) {
    voxels[Coord(i, i / 2, 3)] = voxels[Coord(i, i / 2, 4)] = 12;
    if (i > 6) voxels[Coord(i, i / 2 + 1, 3)] = 12;
  }
  voxels[Coord(30, 0, 0)] = 13;
  for (const Vec3d& edges : {Vec3d(0.5), Vec3d(0.5, 1, 2)}) {
    const auto grid = labelGrid(voxels);
    setProportions(*grid, {edges[0], edges[1], edges[2]});
    grid->transform().postTranslate(Vec3d(10, -20, 3));
    const std::vector<Clump> clumps = {{12, {{Coord(2, 1, 3), 2}, {Coord(8, 4, 3), 5}}, 29, 0, 0},
                                       {13, {}, 1, 1, 0}};
    const std::string path = folder / ("to" + std::to_string(int(edges[2])));
    writeClumpFolder(path, clumps, measure(*grid).grains, grid->transform());
    CHECK(std::distance(std::filesystem::directory_iterator(path), {}) == 2);

    // The grain's volume, centroid and tensor of inertia, from its voxels as boxes.
    double mass = 0;
    Vec3d center(0);
    for (const auto& [p, label] : voxels) {
      if (label != 12) continue;
      mass += edges[0] * edges[1] * edges[2];
      center += edges[0] * edges[1] * edges[2] * grid->indexToWorld(p);
    }
    center /= mass;
    Mat3d moments = Mat3d::zero();
    for (const auto& [p, label] : voxels) {
      if (label != 12) continue;
      const Vec3d at = grid->indexToWorld(p) - center;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          moments(i, j) += edges[0] * edges[1] * edges[2] *
                           (at[i] * at[j] + (i == j ? edges[i] * edges[i] / 12 : 0));
    }
    const Mat3d wanted =
        Mat3d::identity() * (moments(0, 0) + moments(1, 1) + moments(2, 2)) - moments;

    const std::string grain = path + "/grain_000012/";
    CHECK(numbersOf(grain + "Inertia/Mass.txt")[0] == Approx(mass));
    const auto pd = numbersOf(grain + "Inertia/PD.txt"), toi = numbersOf(grain + "Inertia/TOI.txt"),
               balls = numbersOf(grain + "Clump/Clump.txt");
    REQUIRE(pd.size() == 9);
    REQUIRE(toi.size() == 9);
    REQUIRE(balls.size() == 8);
    const Mat3d turn(pd.data());  // its columns are the axes
    CHECK(turn.det() == Approx(1));
    const Mat3d inertia = turn * Mat3d(toi.data()) * turn.transpose();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) CHECK(inertia(i, j) == Approx(wanted(i, j)).margin(1e-9 * mass));
    for (size_t ball = 0; ball < 2; ++ball) {
      const Vec3d at = center + turn * Vec3d(&balls[4 * ball]);
      CHECK((at - grid->indexToWorld(clumps[0].balls[ball].center)).length() < 1e-9);
      CHECK(balls[4 * ball + 3] == Approx(0.5 * std::sqrt(clumps[0].balls[ball].squaredRadius)));
    }
    std::istringstream places(readFile(path + "/places.csv"));
    std::string line;
    std::getline(places, line);
    CHECK(line == "grain_id,x,y,z");
    std::array<double, 4> place{};
    char comma = 0;
    places >> place[0] >> comma >> place[1] >> comma >> place[2] >> comma >> place[3];
    CHECK(place[0] == 12);
    CHECK((Vec3d(&place[1]) - center).length() < 1e-9);

    CHECK_THROWS_AS(writeClumpFolder(path, clumps, {}, grid->transform()), IoError);
    CHECK_THROWS_AS(writeClumpFolder(path + "2", clumps, {}, grid->transform()), InvalidInput);
    CHECK_FALSE(std::filesystem::exists(path + "2"));
  }
}
