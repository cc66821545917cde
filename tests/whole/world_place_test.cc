// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <sstream>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "support/mesh_files.h"
#include "support/vtk_arrays.h"
#include "vdb_madf/exports/clump_file.h"
#include "vdb_madf/exports/hexahedra_file.h"
#include "vdb_madf/exports/network_file.h"
#include "vdb_madf/exports/ome_zarr.h"
#include "vdb_madf/exports/vti_file.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/labels/grain_masks.h"
#include "vdb_madf/labels/grain_name.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/measure/grain_network.h"
#include "vdb_madf/method/voxel_weights.h"
#include "vdb_madf/pictures/preview_volume.h"
#include "vdb_madf/shapes/clumps.h"
#include "vdb_madf/shapes/level_sets.h"
#include "vdb_madf/volumes/read_labels.h"
#include "vdb_madf/volumes/write_image.h"

// A voxel (i,j,k) of labels without symmetry lies at the same point of the world in every format:
// its center at (i,j,k) * edge + shift.

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;

namespace {

constexpr double kEdge = 0.25;                       // mm; all places are exact, in float too
const Vec3d kCube(kEdge), kFlat(0.25, 0.5, 0.0625);  // voxels
const Vec3d kShift(10, -20.5, 3.25);
constexpr double kExact = 1e-12;

Vec3d placeOf(const Vec3d& voxel, const Vec3d& edges = kCube) {
  return edges * voxel + kShift;
}
Vec3d placeOf(const Coord& voxel, const Vec3d& edges = kCube) {
  return placeOf(voxel.asVec3d(), edges);
}
Coord voxelAt(const Vec3d& place, const Vec3d& edges) {
  return Coord::round((place - kShift) / edges);
}

Int32Grid::Ptr markedGrid(const Vec3d& edges = kCube) {
  const auto grid = labelGrid(marker());
  setVoxelSize(*grid, VoxelSize({edges[0] * 1e-3, edges[1] * 1e-3, edges[2] * 1e-3}));
  grid->transform().postTranslate(kShift);
  return grid;
}

/// Mean place of the voxels of each label.
std::map<int32_t, Vec3d> centroids() {
  std::map<int32_t, Vec3d> sums;
  for (const auto& [p, label] : marker()) sums[label] += placeOf(p);
  for (const auto& [label, count] : volumes(marker())) sums[label] /= double(count);
  return sums;
}

/// The three numbers behind a word.
Vec3d numbersAfter(const std::string& text, const std::string& word) {
  const size_t at = text.find(word);
  REQUIRE(at != std::string::npos);
  std::string rest = text.substr(at + word.size(), text.find('\n', at) - at - word.size());
  for (char& c : rest)
    if (c == '(' || c == ')' || c == ',') c = ' ';
  std::istringstream numbers(rest);
  Vec3d result;
  REQUIRE(numbers >> result[0] >> result[1] >> result[2]);
  return result;
}

std::vector<std::vector<double>> rowsOf(const std::string& text, char separator) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  std::string line;
  for (std::getline(lines, line); std::getline(lines, line);) {  // but the first
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, separator);)
      rows.back().push_back(cell.empty() ? NAN : std::stod(cell));
  }
  return rows;
}

bool near(const Vec3d& a, const Vec3d& b) {
  return (a - b).length() < kExact;
}

/// Label of each voxel with a label, at its place in an image of this first place.
void checkImage(const std::string& path, const Vec3d& first, const Vec3d& edges) {
  const auto labels = readLabels(*openImage(path));
  CHECK(labels->activeVoxelCount() == marker().size());
  for (const auto& [p, label] : marker()) {
    const Coord voxel = Coord::round((placeOf(p, edges) - first) / edges);
    CHECK(near(first + edges * voxel.asVec3d(), placeOf(p, edges)));
    CHECK(labels->tree().getValue(voxel) == label);
  }
}

}  // namespace

TEST_CASE("world_place: images that have an origin", "[world_place]") {
  const ScratchFolder folder;
  const CoordBBox box(Coord(-9, -8, 1), Coord(4, 6, 8));
  for (const auto& [edges, directions] : {std::pair(kCube, "(0.25,0,0) (0,0.25,0) (0,0,0.25)"),
                                          {kFlat, "(0.25,0,0) (0,0.5,0) (0,0,0.0625)"}}) {
    const auto grid = markedGrid(edges);
    for (const std::string name : {"a.mhd", "a.mha"}) {
      writeImage(folder / name, *grid, box, SampleType::int32);
      const std::string text = readFile(folder / name);
      CHECK(numbersAfter(text, "\nElementSpacing =") == edges);
      CHECK(near(numbersAfter(text, "\nOffset ="), placeOf(box.min(), edges)));
      checkImage(folder / name, numbersAfter(text, "\nOffset ="), edges);
    }
    writeImage(folder / "a.nrrd", *grid, box, SampleType::int32);
    const std::string text = readFile(folder / "a.nrrd");
    CHECK(text.find("\nspace dimension: 3\n") != std::string::npos);
    CHECK(text.find(std::string("\nspace directions: ") + directions + "\n") != std::string::npos);
    CHECK(text.find("\nspace units: \"mm\" \"mm\" \"mm\"\n") != std::string::npos);
    CHECK(near(numbersAfter(text, "\nspace origin:"), placeOf(box.min(), edges)));
    checkImage(folder / "a.nrrd", numbersAfter(text, "\nspace origin:"), edges);
    CHECK(openImage(folder / "a.nrrd")->info().voxelSize->edges() ==
          storedVoxelSize(*grid)->edges());
  }

  const auto grid = markedGrid();
  // Smaller voxels have transforms in micrometers, but these formats want millimeters.
  setVoxelSize(*grid, VoxelSize{1e-8});
  writeImage(folder / "b.mha", *grid, box, SampleType::int32);
  CHECK(near(numbersAfter(readFile(folder / "b.mha"), "\nOffset ="), 1e-5 * box.min().asVec3d()));
  // Without a size the unit is the voxel.
  setVoxelSize(*grid, std::nullopt);
  writeImage(folder / "c.mha", *grid, box, SampleType::int32);
  CHECK(numbersAfter(readFile(folder / "c.mha"), "\nOffset =") == box.min().asVec3d());
  writeImage(folder / "c.nrrd", *grid, box, SampleType::int32);
  CHECK(numbersAfter(readFile(folder / "c.nrrd"), "\nspace origin:") == box.min().asVec3d());
  CHECK_FALSE(openImage(folder / "c.nrrd")->info().voxelSize);
}

TEST_CASE("world_place: OME-Zarr", "[world_place]") {
  const ScratchFolder folder;
  const CoordBBox box(Coord(-9, -8, 1), Coord(4, 6, 8));
  for (const Vec3d& edges : {kCube, kFlat}) {
    const std::string path = folder / ("a" + std::to_string(edges[2]) + ".ome.zarr");
    const auto grid = markedGrid(edges);
    writeOmeZarr(path, *grid, box);
    const std::string labels = path + "/labels/grain";
    const Vec3d zyx = numbersAfter(readFile(labels + "/.zattrs"), "\"translation\":[");
    checkImage(labels, Vec3d(zyx[2], zyx[1], zyx[0]) * 1e-3, edges);  // micrometers
    CHECK(openImage(labels)->info().voxelSize->edges() == storedVoxelSize(*grid)->edges());
  }
}

TEST_CASE("world_place: VTI, compressed or not", "[world_place]") {
  const ScratchFolder folder;
  const CoordBBox box(Coord(-9, -8, 1), Coord(4, 6, 8));
  for (const auto& [compressed, edges] : {std::pair(false, kCube), {true, kCube}, {false, kFlat}}) {
    writeVti(folder / "a.vti", *markedGrid(edges), box, compressed);
    const VtkArrays file(readFile(folder / "a.vti"));
    const Vec3d origin = numbersAfter(file.attribute("ImageData", "Origin"), ""),
                spacing = numbersAfter(file.attribute("ImageData", "Spacing"), "");
    std::istringstream extent(file.attribute("Piece", "Extent"));
    int low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) extent >> low[axis] >> high[axis];
    CHECK(file.attribute("ImageData", "WholeExtent") == file.attribute("Piece", "Extent"));
    const auto values = file.values<int32_t>("grain_id");
    size_t i = 0, found = 0;
    for (int z = low[2]; z < high[2]; ++z)
      for (int y = low[1]; y < high[1]; ++y)
        for (int x = low[0]; x < high[0]; ++x) {
          const int32_t label = values.at(i++);
          if (label == 0) continue;
          ++found;
          const Vec3d middle = origin + spacing * Vec3d(x + 0.5, y + 0.5, z + 0.5);
          const Coord voxel = voxelAt(middle, edges);
          CHECK(near(middle, placeOf(voxel, edges)));
          CHECK(marker().at(voxel) == label);
        }
    CHECK(i == values.size());
    CHECK(found == marker().size());
  }
}

TEST_CASE("world_place: meshes", "[world_place]") {
  const ScratchFolder folder;
  for (const auto& [ending, edges] : std::vector<std::pair<std::string, Vec3d>>{{"ply", kCube},
                                                                                {"obj", kCube},
                                                                                {"stl", kCube},
                                                                                {"vtp", kCube},
                                                                                {"glb", kCube},
                                                                                {"obj", kFlat},
                                                                                {"glb", kFlat}}) {
    CAPTURE(ending, edges);
    const auto grid = markedGrid(edges);
    MeshFileOptions options;
    options.transform = grid->constTransformPtr();
    writeMesh(folder / ("m." + ending), grainMesh(*grid), options);
    std::map<int32_t, openvdb::BBoxd> found, wanted;
    for (const Face& face : readMesh(ending, readFile(folder / ("m." + ending))))
      for (const Vec3f& corner : face.corners) found[face.grain].expand(Vec3d(corner));
    for (const auto& [p, label] : marker())
      for (const double side : {-0.5, 0.5})
        wanted[ending == "stl" ? 0 : label].expand(placeOf(p.asVec3d() + Vec3d(side), edges));
    CHECK(found == wanted);
  }
}

TEST_CASE("world_place: grids for rendering, reduced or not", "[world_place]") {
  const Vec3d edges = GENERATE(kCube, kFlat);
  const auto grid = markedGrid(edges);
  const auto full = reduceLabels(*grid, 1);
  const auto preview = previewLabels(*grid, 1);
  CHECK(full->activeVoxelCount() == marker().size());
  CHECK(preview.density->activeVoxelCount() == marker().size());
  CHECK(preview.color->activeVoxelCount() == marker().size());
  for (auto voxel = full->cbeginValueOn(); voxel; ++voxel) {
    const Coord p = voxelAt(full->indexToWorld(voxel.getCoord()), edges);
    CHECK(near(placeOf(p, edges), full->indexToWorld(voxel.getCoord())));
    CHECK(marker().at(p) == *voxel);
  }
  for (auto voxel = preview.density->cbeginValueOn(); voxel; ++voxel) {
    const Vec3d place = preview.density->indexToWorld(voxel.getCoord());
    CHECK(marker().count(voxelAt(place, edges)) == 1);
    CHECK(near(place, preview.color->indexToWorld(voxel.getCoord())));
  }
  // Reduced, a coarse voxel lies at the middle of the eight that it stands for.
  const auto coarse = previewLabels(*grid, 2).density;
  std::map<Coord, int> counts;
  for (const auto& [p, label] : marker()) ++counts[{p.x() >> 1, p.y() >> 1, p.z() >> 1}];
  CHECK(coarse->activeVoxelCount() == counts.size());
  for (const auto& [p, count] : counts) {
    CHECK(coarse->tree().getValue(p) == Approx(count / 8.0));
    CHECK(near(coarse->indexToWorld(p), placeOf(2 * p.asVec3d() + Vec3d(0.5), edges)));
  }
}

TEST_CASE("world_place: a grid for each grain, and the surface", "[world_place]") {
  const auto grid = markedGrid();
  const auto levelSets = grainLevelSets(*grid);
  const auto masks = grainMasks(*grid);
  const auto surface = surfaceLevelSet(*grid);
  CoordBBox box = grid->evalActiveVoxelBoundingBox();
  box.expand(3);
  size_t n = 0;
  for (const auto& [label, count] : volumes(marker())) {
    CHECK(levelSets[n]->getName() == grainName(label));
    for (auto p = box.begin(); p; ++p) {
      const auto at = [&](const auto& other) {
        return other.tree().getValue(Coord::round(other.worldToIndex(placeOf(*p))));
      };
      const bool isInside = marker().count(*p) != 0, isOwn = isInside && marker().at(*p) == label;
      if ((at(*levelSets[n]) < 0) != isOwn || at(*masks[n]) != isOwn ||
          (at(*surface) < 0) != isInside)
        FAIL_CHECK("label " << label << " at " << *p);
    }
    ++n;
  }
}

TEST_CASE("world_place: networks", "[world_place]") {
  const ScratchFolder folder;
  const GrainNetwork network = grainNetwork(*markedGrid());
  for (const std::string ending : {"vtp", "graphml", "csv"})
    writeNetwork(folder / ("n." + ending), network);
  const VtkArrays vtp(readFile(folder / "n.vtp"));
  const auto ids = vtp.values<int32_t>("grain_id");
  const auto places = vtp.values<Vec3d>("Points");
  const auto csv = rowsOf(readFile(folder / "n.csv"), ',');
  const std::string graphml = readFile(folder / "n.graphml");
  const auto wanted = centroids();
  REQUIRE(ids.size() == wanted.size());
  REQUIRE(csv.size() == wanted.size());
  for (size_t i = 0; i < ids.size(); ++i) {
    CHECK(near(places[i], wanted.at(ids[i])));
    CHECK(near(Vec3d(vtp.values<double>("centroid_x")[i], vtp.values<double>("centroid_y")[i],
                     vtp.values<double>("centroid_z")[i]),
               wanted.at(ids[i])));
    CHECK(near(Vec3d(csv[i][0], csv[i][1], csv[i][2]), wanted.at(int32_t(csv[i][3]))));
    const std::string node =
        graphml.substr(graphml.find("<node id=\"n" + std::to_string(ids[i]) + "\">"));
    for (int axis = 0; axis < 3; ++axis) {
      const std::string key = std::string("<data key=\"node_") + "xyz"[axis] + "\">";
      CHECK(std::stod(node.substr(node.find(key) + key.size())) ==
            Approx(wanted.at(ids[i])[axis]).epsilon(kExact));
    }
  }
  // The only bond: between 2 and 3, of two faces.
  // (The first arrays of these names are the grains'.)
  const auto bond = [&](const std::string& name) { return vtp.values<double>(name, 1).at(0); };
  CHECK(near(Vec3d(bond("centroid_x"), bond("centroid_y"), bond("centroid_z")),
             placeOf(Vec3d(-6.5, 1, 2.5))));
}

TEST_CASE("world_place: clumps", "[world_place]") {
  const ScratchFolder folder;
  const Vec3d edges = GENERATE(kCube, kFlat);
  const auto grid = markedGrid(edges), balls = grid->deepCopy();
  if (edges == kFlat) setWeights(*balls, {16, 64, 1});
  for (auto ball = balls->beginValueOn(); ball; ++ball) ball.setValue(1);
  const auto made = clumps(*grid, *balls, {100, 0});
  for (const std::string ending : {"csv", "txt", "data"})
    writeClumps(folder / ("c." + ending), made, grid->transform());
  // A ball in every voxel; grain or number of the clump, place.
  const auto check = [&](const std::vector<std::pair<int, Vec3d>>& rows, bool hasLabels) {
    CHECK(rows.size() == marker().size());
    std::vector<int32_t> labels;
    for (const auto& [label, count] : volumes(marker())) labels.push_back(label);
    for (const auto& [number, place] : rows) {
      const Coord p = voxelAt(place, edges);
      CHECK(near(place, placeOf(p, edges)));
      CHECK(marker().at(p) == (hasLabels ? number : labels.at(size_t(number))));
    }
  };
  std::vector<std::pair<int, Vec3d>> csv, yade, lammps;
  for (const auto& row : rowsOf(readFile(folder / "c.csv"), ','))
    csv.push_back({int(row[0]), {row[1], row[2], row[3]}});
  for (const auto& row : rowsOf(readFile(folder / "c.txt"), ' '))
    yade.push_back({int(row[4]), {row[0], row[1], row[2]}});
  const std::string data = readFile(folder / "c.data");
  const std::string atoms = data.substr(data.find("\nAtoms") + 1);
  for (const auto& row : rowsOf("first line\n" + atoms.substr(atoms.find("\n\n") + 2), ' '))
    lammps.push_back({int(row[7]) - 1, {row[2], row[3], row[4]}});
  REQUIRE(lammps.size() == marker().size() + 1);  // grain 1 has one ball, and so a second in it
  const double shortest = std::min({edges[0], edges[1], edges[2]});
  CHECK(near(lammps.back().second, placeOf(Vec3d(2, 3, 5), edges) + Vec3d(shortest / 16, 0, 0)));
  lammps.pop_back();
  check(csv, true);
  check(yade, false);
  check(lammps, false);
}

TEST_CASE("world_place: elements", "[world_place]") {
  const ScratchFolder folder;
  const Vec3d edges = GENERATE(kCube, kFlat);
  writeHexahedra(folder / "h.vtu", *markedGrid(edges));
  writeHexahedra(folder / "h.inp", *markedGrid(edges));
  const VtkArrays vtu(readFile(folder / "h.vtu"));
  const auto nodes = vtu.values<Vec3d>("Points");
  const auto corners = vtu.values<int32_t>("connectivity"),
             grains = vtu.values<int32_t>("grain_id");
  REQUIRE(grains.size() == marker().size());
  for (size_t i = 0; i < grains.size(); ++i) {
    Vec3d middle(0);
    for (size_t n = 0; n < 8; ++n) middle += nodes.at(size_t(corners.at(8 * i + n))) / 8;
    const Coord p = voxelAt(middle, edges);
    CHECK(near(middle, placeOf(p, edges)));
    CHECK(marker().at(p) == grains[i]);
  }
  // Abaqus: the same nodes; its elements are those of hexa_file_test.cc.
  const std::string inp = readFile(folder / "h.inp");
  const size_t begin = inp.find("*NODE");
  const auto rows = rowsOf(inp.substr(begin, inp.find("\n*ELEMENT") - begin), ',');
  REQUIRE(rows.size() == nodes.size());
  for (size_t i = 0; i < rows.size(); ++i)
    CHECK(near(Vec3d(rows[i][1], rows[i][2], rows[i][3]), nodes[i]));
}

TEST_CASE("world_place: what needs cubes refuses other voxels", "[world_place]") {
  const auto flat = markedGrid(kFlat);
  const auto refuses = [](const auto& work) {
    CHECK_THROWS_WITH(work(), vdb_madf::test::Contains("needs cubic voxels") &&
                                  vdb_madf::test::Contains("0.25 x 0.5 x 0.0625"));
  };
  refuses([&] { grainLevelSets(*flat); });
  refuses([&] { surfaceLevelSet(*flat); });
}
