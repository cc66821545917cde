// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/pack.h"

#include <cmath>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/samples/detail/ball_slabs.h"
#include "vdb_madf/samples/detail/ball_union.h"
#include "vdb_madf/samples/detail/lattice.h"
#include "vdb_madf/samples/detail/random.h"
#include "vdb_madf/samples/detail/sample_options.h"

namespace vdb_madf {

namespace {

using detail::Ball;

/// Half of what the documentation promises.
constexpr double kFractionTolerance = 0.0025;

/// The last balls, fewer than this, are added one by one, each counted.
constexpr int64_t kMinBatch = 1024;
/// Bounds the memory of a batch, and the time until an interruption is seen.
constexpr int64_t kMaxBatch = 1 << 18;
/// A batch aims at this part of what is missing, many standard deviations short of the goal.
constexpr double kBatchPart = 0.8;

/// So many balls in a row that add nothing, or too much for what is missing: give up.
constexpr int kMaxFailures = 100000;
constexpr int kPollInterval = 64;

/// \p Balls: BallUnion or BallSlabs.
template <typename Balls>
class PackBuilder {
 public:
  /// \p balls: empty, gets them
  PackBuilder(const PackOptions& options, Balls& balls, Interrupter* interrupter)
      : options_(options),
        interrupter_(interrupter),
        random_(options.seed, 0),
        lattice_(options.voxelSize),
        voxels_(lattice_.voxels(options.size)),
        balls_(balls),
        boxVoxels_(double(voxels_.x()) * voxels_.y() * voxels_.z()),
        goal_(options.fraction * boxVoxels_) {
    // Centers lie in the box grown by the largest radius, so that the faces see as many balls as
    // the middle.
    const double grow = 2 * options.maxRadius;
    centerVolume_ =
        (options.size.x() + grow) * (options.size.y() + grow) * (options.size.z() + grow);
  }

  void build() {
    while (addBatch()) {
    }
    addSingly();
  }

 private:
  Ball drawBall() {
    const double r = options_.maxRadius;
    Ball ball;
    ball.radius = random_.uniform(options_.minRadius, options_.maxRadius);
    ball.x = random_.uniform(-0.5 - r, options_.size.x() - 0.5 + r);
    ball.y = random_.uniform(-0.5 - r, options_.size.y() - 0.5 + r);
    ball.z = random_.uniform(-0.5 - r, options_.size.z() - 0.5 + r);
    return ball;
  }

  bool meetsBox(const Ball& ball) const {
    CoordBBox box = detail::ballBox(ball, lattice_);
    box.intersect({Coord(0), voxels_.offsetBy(-1)});
    return !box.empty();
  }

  double missing() const { return goal_ - double(balls_.voxelCount()); }

  /// Draws balls until their volumes sum to a part of what the union can take before it reaches the
  /// goal. (A sum of volumes V in the volume of the centers covers at most V / that volume of what
  /// is still free.) False, and nothing drawn, if too few would do.
  bool addBatch() {
    const double r = options_.maxRadius;
    const double largest = 4.0 / 3.0 * M_PI * r * r * r;
    const double free = boxVoxels_ - double(balls_.voxelCount());
    const double volume = kBatchPart * missing() / free * centerVolume_;
    if (volume < double(kMinBatch) * largest) return false;
    std::vector<Ball> batch;
    double sum = 0;
    for (int64_t drawn = 0; sum < volume && drawn < kMaxBatch; ++drawn) {
      const Ball ball = drawBall();
      sum += 4.0 / 3.0 * M_PI * ball.radius * ball.radius * ball.radius;
      if (meetsBox(ball)) batch.push_back(ball);
    }
    balls_.add(batch, interrupter_);
    return true;
  }

  void addSingly() {
    const double tolerance = kFractionTolerance * boxVoxels_;
    int failures = 0;
    for (int64_t step = 0; missing() > tolerance; ++step) {
      if (step % kPollInterval == 0 && interrupter_ && interrupter_->wasInterrupted())
        throw Interrupted();
      const Ball ball = drawBall();
      const int64_t added = meetsBox(ball) ? balls_.countNew(ball) : 0;
      if (added > 0 && double(added) <= missing() + tolerance) {
        balls_.add(ball);
        failures = 0;
      } else if (++failures == kMaxFailures) {
        throw InvalidInput(
            "the fraction cannot be met with so large balls in so small a box: use smaller radii "
            "or a larger size");
      }
    }
  }

  PackOptions options_;
  Interrupter* interrupter_;
  detail::RandomSequence random_;
  detail::Lattice lattice_;
  Coord voxels_;
  Balls& balls_;
  double boxVoxels_, goal_, centerVolume_ = 0;
};

void checkBalls(const PackOptions& options) {
  detail::checkRadii(options.minRadius, options.maxRadius);
  detail::checkFraction(options.fraction);
}

Sample packOf(MaskTree::Ptr object, const PackOptions& options, const Coord& voxels) {
  detail::SourceText source("pack");
  source.size(options.size)
      .add("fraction", options.fraction)
      .range("radius", options.minRadius, options.maxRadius)
      .add("seed", std::to_string(options.seed))
      .edges(options.voxelSize);
  return detail::described({MaskGrid::create(object), nullptr}, voxels, source, options.voxelSize);
}

}  // namespace

Sample generatePack(const PackOptions& options, Interrupter* interrupter) {
  detail::checkSize(options.size);
  checkBalls(options);
  const detail::Lattice lattice(options.voxelSize);
  const Coord voxels = lattice.voxels(options.size);
  detail::BallUnion balls(voxels, true, lattice);
  PackBuilder(options, balls, interrupter).build();
  return packOf(balls.takeTree(), options, voxels);
}

PackSlabs::PackSlabs(const PackOptions& options, Interrupter* interrupter) : options_(options) {
  detail::checkSize({options.size.x(), options.size.y(), 1});
  detail::checkRange("size along z", options.size.z(), 1, kMaxImageSide);
  checkBalls(options);
  const detail::Lattice lattice(options.voxelSize);
  voxels_ = lattice.voxels(options.size);
  const auto balls = std::make_shared<detail::BallSlabs>(voxels_, lattice);
  PackBuilder(options, *balls, interrupter).build();
  balls_ = balls;
  for (size_t s = 0; s < balls->slabCount(); ++s)
    cuts_.push_back(int(s) * detail::BallSlabs::kHeight);
  cuts_.push_back((voxels_.z() + 7) / 8 * 8);
}

int64_t PackSlabs::objectVoxels() const {
  return balls_->voxelCount();
}

MaskGrid::Ptr PackSlabs::object(size_t slab, Interrupter* interrupter) const {
  return packOf(balls_->slab(slab, interrupter), options_, voxels_).object;
}

}  // namespace vdb_madf
