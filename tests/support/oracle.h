// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <stdexcept>
#include <vector>

#include "support/dense_volume.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/segmentation/segment.h"

// The whole method by brute force, from its definitions, on dense volumes. Of the library it uses
// the plain data of the public headers (options, graph, counts) and no code. Steps are those of
// "The method" in the README.md of the project. All squared lengths are those of the weights; the
// weights of a grid's transform are not looked at.

namespace vdb_madf::test {

/// The definitions give no result: what the library must report as InvalidInput.
class Undefined : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A function X -> X as indices into the volume of the body; kNoSite where it has no value.
using SiteMap = DenseVolume<int>;
constexpr int kNoSite = -1;

struct OraclePower {
  SiteMap site;                ///< Pi(p)
  DenseVolume<int64_t> power;  ///< pi of p to the ball at its site
};

/// Volumes are those of the body: distance, power and so on have values in cavities too; grain has
/// none there.
struct OracleResult {
  DenseVolume<int64_t> distance;  ///< D
  OraclePower unfiltered;         ///< Pi, pi
  OraclePower filtered;           ///< Pi', pi'; the same at gamma 0
  DenseVolume<int64_t> manifold;  ///< critical points 1..K in lexicographic order
  DenseVolume<int64_t> grain;     ///< 1..N
  std::vector<MedialBall> balls;  ///< of Pi, lexicographic
  std::vector<Coord> kept;        ///< of these, the ones that the filter keeps
  ManifoldGraph graph;
  Merging merging;
  SegmentCounts counts;
  LabelFlaws flaws;
  bool open = false;
};

/// The domain B: a box, or the voxels of a region.
class OracleDomain {
 public:
  OracleDomain() = default;
  OracleDomain(const CoordBBox& box) : box_(box) {}  // NOLINT: a box is a domain
  explicit OracleDomain(const ObjectVolume& region) : box_(objectBox(region)), region_(region) {}
  const CoordBBox& box() const { return box_; }
  bool isInside(const Coord& p) const {
    return region_ ? region_->get(p, 0) != 0 : box_.isInside(p);
  }

 private:
  CoordBBox box_;
  std::optional<ObjectVolume> region_;
};

inline int64_t squaredLength(const Coord& d, const VoxelWeights& w) {
  return int64_t(w.x) * d.x() * d.x() + int64_t(w.y) * d.y() * d.y() + int64_t(w.z) * d.z() * d.z();
}

/// Before all steps: is the boundary open (boundary.h)? @throw Undefined
bool oracleBoundary(const ObjectVolume& object, Boundary boundary,
                    const std::optional<OracleDomain>& domain);

/// Step 0: what is filled if the options do not say it.
int64_t oracleFillHoles(const SegmentOptions& options, const std::optional<OracleDomain>& domain);

/// Step 0, the body: the object and its cavities, and how many there are.
struct OracleBody {
  ObjectVolume voxels;  ///< in a box that holds the object's
  int64_t cavities = 0;
};
OracleBody oracleBody(const ObjectVolume& object, const std::optional<OracleDomain>& domain,
                      bool open, int64_t fillHoles);

/// Step 1. `domain` is used if open. @throw Undefined if there is no background.
DenseVolume<int64_t> oracleDistance(const ObjectVolume& object, bool open,
                                    const OracleDomain& domain, const VoxelWeights& weights = {});

/// Step 2, over the balls of some sites only; kNoSite where none of their balls has a negative
/// power.
OraclePower oraclePower(const ObjectVolume& object, const DenseVolume<int64_t>& distance,
                        const ObjectVolume& sites, const VoxelWeights& weights = {});

/// Step 3: the medial balls and the sizes of their cells.
std::vector<MedialBall> oracleBalls(const OraclePower& power, const DenseVolume<int64_t>& distance);

/// Number of the 6-connected component of each object voxel, from 1 on; 0: background.
DenseVolume<int> sixComponents(const ObjectVolume& object);

/// Step 4: the balls that the filter keeps.
ObjectVolume oracleKeptBalls(const ObjectVolume& object, const OraclePower& power,
                             const std::vector<MedialBall>& balls, int64_t gamma);
/// Step 4: the power map of the kept balls, completed within the grains.
OraclePower oracleFilteredPower(const ObjectVolume& object, const DenseVolume<int64_t>& distance,
                                const ObjectVolume& kept, const VoxelWeights& weights = {});

/// Step 5: the critical point, as an index, that each voxel reaches.
SiteMap oracleFlow(const SiteMap& site);

/// Step 6.
ManifoldGraph oracleGraph(const ObjectVolume& object, const DenseVolume<int64_t>& distance,
                          const OraclePower& power, const SiteMap& critical);

/// Steps 7 and 8: the classes, numbered. @throw Undefined unless theta is in [-1, 1]
Merging oracleMerge(const ManifoldGraph& graph, const MergeOptions& options);

/// Step 7 by score: all joins of classes, each class named by its representative's node.
struct OracleHierarchy {
  struct Join {
    uint32_t first, second;  ///< first < second
    int64_t score;           ///< in units of 1/512
  };
  std::vector<uint32_t> classOf;  ///< of each node, before any join
  std::vector<Join> joins;
};
OracleHierarchy oracleHierarchy(const ManifoldGraph& graph);
/// The class of each node at a strictness.
std::vector<uint32_t> oracleCut(const ManifoldGraph& graph, const OracleHierarchy& hierarchy,
                                double strictness);
/// Step 7, small grains: what each node's grain (0: none) has joined.
std::vector<uint32_t> oracleJoinSmall(const ManifoldGraph& graph,
                                      const std::vector<int32_t>& grainOfNode, int64_t least);
/// The score of a pair of classes, a of the smaller top.
int64_t oracleScore(int64_t voxelsA, int64_t topA, int64_t voxelsB, int64_t topB, int64_t faces,
                    int64_t height, const VoxelWeights& weights = {});
/// The score of a pair of classes in a plane, whose two weights are given.
int64_t oraclePlaneScore(int64_t voxelsA, int64_t topA, int64_t voxelsB, int64_t topB,
                         int64_t faces, int64_t height, int64_t weightX = 1, int64_t weightY = 1);

/// Step 9, on labels of the object (0: none), given the representatives of grains 1, 2, ...
DenseVolume<int64_t> oracleTidy(const DenseVolume<int64_t>& labels,
                                const std::vector<Coord>& representatives, int rounds,
                                const VoxelWeights& weights = {});

/// What is wrong with labels (label_flaws.h).
LabelFlaws oracleFlaws(const DenseVolume<int64_t>& labels, int64_t grains,
                       const std::optional<OracleDomain>& domain);

/// All of it. @throw Undefined
OracleResult oracleSegment(const ObjectVolume& object, const std::optional<OracleDomain>& domain,
                           const SegmentOptions& options);

}  // namespace vdb_madf::test
