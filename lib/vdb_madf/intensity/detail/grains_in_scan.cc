// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/detail/grains_in_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "vdb_madf/labels/detail/label_blocks.h"

namespace vdb_madf::detail {

namespace {

using GrayLeaf = FloatGrid::TreeType::LeafNodeType;

constexpr int64_t kFewestFaces = 100;  // of either side
constexpr double kLeastSlope = 0.05;   // of the contrast, a voxel

/// The faces between grains and what is around them that are normal to an axis.
struct Faces {
  int64_t count[2] = {0, 0};  // grain above, grain below
  double sum[2] = {0, 0};     // of the means of the two voxels
  double slopes = 0;          // of all: inside less outside

  void add(bool isBelow, double inside, double outside) {
    ++count[isBelow];
    sum[isBelow] += (inside + outside) / 2;
    slopes += inside - outside;
  }
  /// @param contrast of grains and what is around them, of any sign
  double shift(double contrast) const {
    if (count[0] < kFewestFaces || count[1] < kFewestFaces) return 0;
    const double slope = slopes / double(count[0] + count[1]) / contrast;
    const double difference = (sum[1] / double(count[1]) - sum[0] / double(count[0])) / contrast;
    return difference / (2 * std::max(slope, kLeastSlope));
  }
};

/// What of a leaf node is known.
struct LeafVoxels {
  std::array<bool, GrayLeaf::SIZE> isKnown{}, isGrain{};

  LeafVoxels(const GrayLeaf& gray, const Int32Tree& labels, const CoordBBox& known) {
    const auto* labeled = labels.probeConstLeaf(gray.origin());
    CoordBBox part = gray.getNodeBoundingBox();
    part.intersect(known);
    for (auto p = part.begin(); p; ++p) {
      const openvdb::Index i = GrayLeaf::coordToOffset(*p);
      isKnown[i] = std::isfinite(gray.getValue(i));
      isGrain[i] = labeled && labelAt(*labeled, labeled->buffer().data(), i) != 0;
    }
  }
};

void addFaces(const GrayLeaf& gray, const LeafVoxels& voxels, std::array<Faces, 3>& faces) {
  constexpr openvdb::Index kSteps[3] = {64, 8, 1};
  for (openvdb::Index i = 0; i < GrayLeaf::SIZE; ++i)
    for (size_t axis = 0; axis < 3; ++axis) {
      const openvdb::Index next = i + kSteps[axis];
      if (i / kSteps[axis] % 8 == 7 || !voxels.isKnown[i] || !voxels.isKnown[next] ||
          voxels.isGrain[i] == voxels.isGrain[next])
        continue;
      const auto [inside, outside] = voxels.isGrain[i] ? std::pair{i, next} : std::pair{next, i};
      faces[axis].add(voxels.isGrain[i], double(gray.getValue(inside)),
                      double(gray.getValue(outside)));
    }
}

}  // namespace

GrainsInScan grainsInScan(const Int32Tree& labels, const FloatGrid::TreeType& gray,
                          const CoordBBox& known, double middle) {
  int64_t voxels[2] = {0, 0}, bright[2] = {0, 0};  // of what is around grains, of grains
  double sums[2] = {0, 0};
  std::array<Faces, 3> faces;
  for (auto leaf = gray.cbeginLeaf(); leaf; ++leaf) {
    const LeafVoxels of(*leaf, labels, known);
    for (openvdb::Index i = 0; i < GrayLeaf::SIZE; ++i) {
      if (!of.isKnown[i]) continue;
      const double value = double(leaf->getValue(i));
      const bool isGrain = of.isGrain[i];
      ++voxels[isGrain];
      bright[isGrain] += value > middle;
      sums[isGrain] += value;
    }
    addFaces(*leaf, of, faces);
  }
  GrainsInScan found;
  if (voxels[0] == 0 || voxels[1] == 0) return found;
  found.brighter = double(bright[1]) / double(voxels[1]) - double(bright[0]) / double(voxels[0]);
  const double contrast = sums[1] / double(voxels[1]) - sums[0] / double(voxels[0]);
  for (int axis = 0; axis < 3 && contrast != 0; ++axis)
    found.shift[axis] = faces[size_t(axis)].shift(contrast);
  return found;
}

}  // namespace vdb_madf::detail
