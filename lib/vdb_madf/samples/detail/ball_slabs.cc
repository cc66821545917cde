// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/ball_slabs.h"

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

BallSlabs::BallSlabs(const Coord& size, const Lattice& lattice)
    : size_(size), lattice_(lattice), ballsOf_(size_t((size.z() + kHeight - 1) / kHeight)) {}

std::pair<size_t, size_t> BallSlabs::slabsOf(const CoordBBox& ball) const {
  return {size_t(std::max(ball.min().z(), 0) / kHeight),
          size_t(std::min(ball.max().z(), size_.z() - 1) / kHeight)};
}

void BallSlabs::keep(const Ball& ball) {
  const auto [first, last] = slabsOf(ballBox(ball, lattice_));
  for (size_t s = first; s <= last; ++s) ballsOf_[s].push_back(uint32_t(balls_.size()));
  balls_.push_back(ball);
}

BallUnion BallSlabs::draw(const CoordBBox& box, Interrupter* interrupter) const {
  std::vector<Ball> balls;  // some twice
  const auto [first, last] = slabsOf(box);
  for (size_t s = first; s <= last; ++s)
    for (const uint32_t ball : ballsOf_[s])
      if (ballBox(balls_[ball], lattice_).hasOverlap(box)) balls.push_back(balls_[ball]);
  BallUnion drawn(size_, true, lattice_, box);
  drawn.add(balls, interrupter);
  return drawn;
}

BallUnion BallSlabs::drawSlab(size_t slab, Interrupter* interrupter) const {
  CoordBBox box(Coord(0), size_.offsetBy(-1));
  box.min().z() = int(slab) * kHeight;
  box.max().z() = std::min(box.max().z(), box.min().z() + kHeight - 1);
  return draw(box, interrupter);
}

int64_t BallSlabs::countNew(const Ball& ball) const {
  return draw(ballBox(ball, lattice_), nullptr).countNew(ball);
}

void BallSlabs::add(const Ball& ball) {
  voxelCount_ += countNew(ball);
  keep(ball);
}

void BallSlabs::add(const std::vector<Ball>& balls, Interrupter* interrupter) {
  for (const Ball& ball : balls) keep(ball);
  voxelCount_ = 0;
  for (size_t s = 0; s < slabCount(); ++s) {
    WorkPart part(interrupter, int(100 * s / slabCount()), int(100 * (s + 1) / slabCount()));
    voxelCount_ += drawSlab(s, &part).voxelCount();
  }
}

MaskTree::Ptr BallSlabs::slab(size_t slab, Interrupter* interrupter) const {
  return drawSlab(slab, interrupter).takeTree();
}

}  // namespace vdb_madf::detail
