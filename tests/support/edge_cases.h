// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "support/dense_volume.h"

namespace vdb_madf::test {

struct EdgeCase {
  std::string name;
  ObjectVolume object;
  Tiles tiles = Tiles::none;
};

/// Small objects that every stage must do right, with active tiles and without.
inline std::vector<EdgeCase> edgeCases() {
  std::vector<EdgeCase> cases;
  const auto add = [&](const std::string& name, const ObjectVolume& object) {
    cases.push_back({name, object, Tiles::none});
    cases.push_back({name + ", tiles", object, Tiles::wherePossible});
  };
  const auto unionOf = [](const std::vector<CoordBBox>& parts) {
    CoordBBox box;
    for (const CoordBBox& part : parts) box.expand(part);
    ObjectVolume object(box);
    for (int i = 0; i < object.size(); ++i)
      for (const CoordBBox& part : parts) object[i] |= part.isInside(object.coord(i));
    return object;
  };
  const auto block = [](const Coord& origin, const Coord& dim) { return boxAt(origin, dim); };
  add("no voxels, no box", ObjectVolume());
  add("empty", ObjectVolume(block({-3, 5, 6}, Coord(4))));
  add("one voxel", unionOf({block({-1, -1, -1}, Coord(1))}));
  add("one voxel far out", unionOf({block({-100000008, 100000000, 7}, Coord(1))}));
  add("one leaf", unionOf({block({-8, 16, 0}, Coord(8))}));
  add("full block of leaves", unionOf({block({-8, 0, -8}, {16, 8, 24})}));
  add("block across leaves", unionOf({block({-3, 5, 6}, {9, 10, 11})}));
  add("sheet of one voxel", unionOf({block({-4, 7, -9}, {1, 12, 20})}));
  add("two components", unionOf({block({-20, -3, 2}, {9, 5, 7}), block({-10, -3, 2}, {12, 6, 6})}));
  add("corner to corner", unionOf({block({7, 7, 7}, Coord(1)), block({8, 8, 8}, Coord(1))}));
  add("two equal maxima", unionOf({block({-5, -5, -9}, Coord(5)), block({-3, -3, -4}, {1, 1, 4}),
                                   block({-5, -5, 0}, Coord(5))}));
  return cases;
}

}  // namespace vdb_madf::test
