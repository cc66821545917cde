// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/dense_volume.h"

#include <sstream>
#include <stdexcept>

#include "vdb_madf/leaves/leaf_grid.h"

namespace vdb_madf::test {

const std::array<Coord, 6> kSixNeighbors = {Coord(-1, 0, 0), Coord(1, 0, 0),  Coord(0, -1, 0),
                                            Coord(0, 1, 0),  Coord(0, 0, -1), Coord(0, 0, 1)};

CoordBBox boxAt(const Coord& origin, const Coord& dim) {
  return {origin, origin + dim - Coord(1)};
}

void addBlock(ObjectVolume& object, const Coord& center) {
  const CoordBBox block(center - Coord(1), center + Coord(1));
  for (auto p = block.begin(); p; ++p)
    if (object.contains(*p)) object[*p] = 1;
}

int64_t countObject(const ObjectVolume& object) {
  int64_t count = 0;
  for (int i = 0; i < object.size(); ++i) count += object[i] != 0;
  return count;
}

CoordBBox objectBox(const ObjectVolume& object) {
  CoordBBox box;
  for (int i = 0; i < object.size(); ++i)
    if (object[i]) box.expand(object.coord(i));
  return box;
}

ObjectVolume withBox(const ObjectVolume& object, const CoordBBox& box) {
  ObjectVolume result(box);
  for (int i = 0; i < result.size(); ++i) result[i] = object.get(result.coord(i), 0);
  return result;
}

ObjectVolume translated(const ObjectVolume& object, const Coord& by) {
  ObjectVolume result({object.box().min() + by, object.box().max() + by});
  for (int i = 0; i < result.size(); ++i) result[i] = object[i];
  return result;
}

Coord AxisMap::operator()(const Coord& p) const {
  Coord result;
  for (int axis = 0; axis < 3; ++axis) {
    const int value = p[from[size_t(axis)]];
    result[axis] = mirror[size_t(axis)] ? -value : value;
  }
  return result;
}

CoordBBox AxisMap::operator()(const CoordBBox& box) const {
  CoordBBox result;
  result.expand((*this)(box.min()));
  result.expand((*this)(box.max()));
  return result;
}

MaskGrid::Ptr toMask(const ObjectVolume& object, Tiles tiles) {
  constexpr int kSide = 8;
  auto mask = MaskGrid::create();
  auto accessor = mask->getAccessor();
  for (int i = 0; i < object.size(); ++i)
    if (object[i]) accessor.setValueOn(object.coord(i));
  if (tiles == Tiles::none) return mask;
  for (int i = 0; i < object.size(); ++i) {
    const Coord corner = object.coord(i);
    if ((corner.x() | corner.y() | corner.z()) & (kSide - 1)) continue;
    bool full = true;
    for (int x = 0; x < kSide && full; ++x)
      for (int y = 0; y < kSide && full; ++y)
        for (int z = 0; z < kSide && full; ++z) full = object.get(corner + Coord(x, y, z), 0) != 0;
    if (full) mask->tree().addTile(1, corner, true, true);
  }
  return mask;
}

ObjectVolume toObject(const MaskGrid& mask) {
  CoordBBox box;
  for (auto value = mask.cbeginValueOn(); value; ++value) box.expand(value.getBoundingBox());
  ObjectVolume object(box);
  for (auto value = mask.cbeginValueOn(); value; ++value) {
    CoordBBox part = value.getBoundingBox();
    for (auto p = part.begin(); p; ++p) object[*p] = 1;
  }
  return object;
}

Int32Grid::Ptr toGrid(const ObjectVolume& object, const DenseVolume<int64_t>& values) {
  auto grid = Int32Grid::create(0);
  auto accessor = grid->getAccessor();
  for (int i = 0; i < object.size(); ++i)
    if (object[i]) accessor.setValueOn(object.coord(i), int32_t(values[object.coord(i)]));
  return grid;
}

std::string difference(const std::string& what, const Int32Grid& grid, const ObjectVolume& object,
                       const DenseVolume<int64_t>& expected) {
  std::ostringstream text;
  const auto accessor = grid.getConstAccessor();
  for (int i = 0; i < object.size(); ++i) {
    const Coord p = object.coord(i);
    int32_t value = 0;
    const bool active = accessor.probeValue(p, value);
    const int64_t wanted = object[i] ? expected[p] : 0;
    if (active == (object[i] != 0) && value == wanted) continue;
    text << what << " at " << p << ": " << value << (active ? "" : " (inactive)") << ", expected "
         << wanted << (object[i] ? "" : " (inactive)");
    return text.str();
  }
  if (grid.background() != 0) text << what << ": background is " << grid.background();
  const auto active = int64_t(grid.activeVoxelCount());
  if (active != countObject(object))
    text << what << ": " << active << " active voxels, the object has " << countObject(object);
  return text.str();
}

std::string picture(const ObjectVolume& object) {
  if (object.size() == 0) return "(no voxels)\n";
  std::ostringstream text;
  const Coord lower = object.box().min(), upper = object.box().max();
  for (int x = lower.x(); x <= upper.x(); ++x) {
    text << "x = " << x << " (y from " << lower.y() << " down, z from " << lower.z()
         << " across)\n";
    for (int y = lower.y(); y <= upper.y(); ++y) {
      for (int z = lower.z(); z <= upper.z(); ++z) text << (object[Coord(x, y, z)] ? '#' : '.');
      text << '\n';
    }
  }
  return text.str();
}

ObjectVolume fromPicture(const std::string& picture, const Coord& origin) {
  std::vector<Coord> voxels;
  CoordBBox box;
  Coord p = origin;
  for (const char c : picture) {
    switch (c) {
      case '|':
        p = Coord(p.x() + 1, origin.y(), origin.z());
        break;
      case '/':
        p = Coord(p.x(), p.y() + 1, origin.z());
        break;
      case '#':
        voxels.push_back(p);
        [[fallthrough]];
      case '.':
        box.expand(p);
        ++p.z();
        break;
      default:
        throw std::invalid_argument("a picture is made of # . / |");
    }
  }
  ObjectVolume object(box);
  for (const Coord& voxel : voxels) object[voxel] = 1;
  return object;
}

std::string toString(const Coord& p) {
  std::ostringstream text;
  text << p;
  return text.str();
}

std::string toString(const CoordBBox& box) {
  return box.empty() ? "(empty)" : toString(box.min()) + ".." + toString(box.max());
}

}  // namespace vdb_madf::test
