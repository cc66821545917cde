// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/sintered.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/samples/detail/ball_union.h"
#include "vdb_madf/samples/detail/bodies.h"
#include "vdb_madf/samples/detail/gaussian_blur.h"
#include "vdb_madf/samples/detail/lattice.h"
#include "vdb_madf/samples/detail/mask_blocks.h"
#include "vdb_madf/samples/detail/placement.h"
#include "vdb_madf/samples/detail/power_cells.h"
#include "vdb_madf/samples/detail/sample_options.h"
#include "vdb_madf/samples/detail/white_noise.h"

namespace vdb_madf {

namespace {

using detail::Ball;
using detail::FloatBox;
using detail::Lattice;
using detail::MaskBlocks;

// The surface: rounded by the blur, roughened by the noise, cut a little outside the balls, where
// necks are thick.
constexpr double kBlurSigma = 2;
constexpr double kNoiseSigma = 1;
constexpr double kNoiseAmplitude = 1.5;
constexpr float kSinteredCut = 0.45f;

/// Stream 0 places the balls.
constexpr uint64_t kSurfaceNoiseStream = 1;

/// 1 inside the balls, 0 outside, at points of Z^3; also beyond the faces of the sample, so that
/// the blur sees no surface there.
FloatBox indicator(const CoordBBox& box, const std::vector<Ball>& balls) {
  FloatBox field(box);
  for (const Ball& ball : balls) {
    CoordBBox near = detail::ballBox(ball);
    near.intersect(box);
    for (int x = near.min().x(); x <= near.max().x(); ++x)
      for (int y = near.min().y(); y <= near.max().y(); ++y) {
        const auto row = detail::ballRow(ball, x, y, near.min().z(), near.max().z());
        if (row.last < row.first) continue;
        float* values = field.values.data() + field.offset(x, y, row.first);
        std::fill(values, values + (row.last - row.first + 1), 1.0f);
      }
  }
  return field;
}

/// The object is where this field reaches the cut.
class SinteredBodies : public detail::Bodies {
 public:
  SinteredBodies(const SinteredOptions& options, const std::vector<Ball>& balls,
                 const Lattice& lattice)
      : options_(options), balls_(balls), lattice_(lattice) {}

  FloatBox field(const CoordBBox& box) const {
    CoordBBox seen = detail::pointsSeen(box, lattice_, kBlurSigma);
    FloatBox field = detail::blurredAt(box, lattice_, indicator(seen, balls_), kBlurSigma);
    if (options_.roughness == 0) return field;
    seen = detail::pointsSeen(box, lattice_, kNoiseSigma);
    const FloatBox noise = detail::blurredAt(
        box, lattice_, detail::whiteNoise(seen, options_.seed, kSurfaceNoiseStream, nullptr),
        kNoiseSigma);
    const float amplitude = float(options_.roughness * kNoiseAmplitude);
    for (size_t i = 0; i < field.values.size(); ++i) field.values[i] += amplitude * noise.values[i];
    return field;
  }

  FloatBox shares(const CoordBBox& box) const override {
    CoordBBox grown = box;
    grown.expand(1);
    return detail::sharesAbove(field(grown), kSinteredCut);
  }

 private:
  SinteredOptions options_;
  std::vector<Ball> balls_;
  Lattice lattice_;
};

/// Fills the object block by block; only the pieces at work are held as dense arrays.
class SurfaceBuilder {
 public:
  SurfaceBuilder(const SinteredBodies& bodies, const Lattice& lattice, const Coord& voxels)
      : bodies_(bodies), blocks_(voxels) {
    for (int axis = 0; axis < 3; ++axis)
      piece_[axis] = std::max(1, int(MaskBlocks::kEdge / lattice.edge(axis)));
  }

  MaskTree::Ptr build(Interrupter* interrupter) {
    detail::parallelForEach(blocks_.count(), 1, interrupter,
                            [&](size_t block) { fillBlock(block); });
    return blocks_.takeTree();
  }

 private:
  /// Works in pieces that see about as many points as a block of cubes.
  void fillBlock(size_t block) {
    const CoordBBox box = blocks_.box(block);
    for (int x = box.min().x(); x <= box.max().x(); x += piece_.x())
      for (int y = box.min().y(); y <= box.max().y(); y += piece_.y())
        for (int z = box.min().z(); z <= box.max().z(); z += piece_.z()) {
          CoordBBox piece(Coord(x, y, z), piece_.offsetBy(-1) + Coord(x, y, z));
          piece.intersect(box);
          fillPiece(block, piece);
        }
  }

  void fillPiece(size_t block, const CoordBBox& box) {
    const FloatBox field = bodies_.field(box);
    for (int x = box.min().x(); x <= box.max().x(); ++x)
      for (int y = box.min().y(); y <= box.max().y(); ++y)
        for (int z = box.min().z(), next; z <= box.max().z(); z = next) {
          next = (z | 7) + 1;  // the next leaf
          const float* values = field.values.data() + field.offset(x, y, z);
          const int count = std::min(next, box.max().z() + 1) - z;
          uint64_t row = 0;
          for (int i = 0; i < count; ++i) row |= uint64_t(values[i] >= kSinteredCut) << i;
          if (row == 0) continue;
          auto& mask = blocks_.node(block).touchLeaf({x, y, z})->getValueMask();
          mask.getWord<uint64_t>(x & 7) |= row << (8 * (y & 7) + (z & 7));
        }
  }

  const SinteredBodies& bodies_;
  MaskBlocks blocks_;
  Coord piece_;
};

}  // namespace

Sample generateSintered(const SinteredOptions& options, Interrupter* interrupter) {
  detail::checkSize(options.size);
  detail::checkCount(options.count);
  detail::checkRadii(options.minRadius, options.maxRadius);
  detail::checkRange("neck", options.neck, 0, 10);
  detail::checkRange("roughness", options.roughness, 0, 10);

  const Lattice lattice(options.voxelSize);
  const Coord voxels = lattice.voxels(options.size);
  const std::vector<Ball> balls = detail::placeSintered(options, interrupter);
  Sample sample;
  const auto bodies = std::make_shared<SinteredBodies>(options, balls, lattice);
  sample.object = MaskGrid::create(SurfaceBuilder(*bodies, lattice, voxels).build(interrupter));
  sample.truth =
      Int32Grid::create(detail::powerCells(sample.object->tree(), balls, interrupter, lattice));
  sample.bodies = bodies;
  detail::SourceText source("sintered");
  source.size(options.size)
      .add("count", std::to_string(options.count))
      .range("radius", options.minRadius, options.maxRadius)
      .add("neck", options.neck)
      .add("roughness", options.roughness)
      .add("seed", std::to_string(options.seed))
      .edges(options.voxelSize);
  return detail::described(sample, voxels, source, options.voxelSize);
}

}  // namespace vdb_madf
