// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/placement.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/samples/detail/random.h"

namespace vdb_madf::detail {

namespace {

/// Relative; half of what the documentation promises.
constexpr double kOverlapTolerance = 0.005;

/// Random centers tried for a ball that must not swallow the others.
constexpr int kMaxTries = 10000;
/// Moves tried on the way to the asked overlap before it counts as impossible.
constexpr int64_t kSearchMoves = 20000, kSearchMovesPerBall = 500;
/// Moves tried at the asked overlap, so that the balls forget the way they came.
constexpr int64_t kMixingMovesPerBall = 100;
constexpr int kPollInterval = 16;

enum Stream : uint64_t { kRadiusStream = 0, kCenterStream = 1, kMoveStream = 2 };

/// A ball on the lattice: for each row (dx, dy) of voxels, how far it reaches along z.
class LatticeBall {
 public:
  LatticeBall(double radius, const Coord& c) : center(c), radius_(radius) {
    reach_ = int(std::ceil(radius)) - 1;
    halfLengths_.resize(size_t(reach_ + 1) * (reach_ + 1), -1);
    for (int x = 0; x <= reach_; ++x)
      for (int y = 0; y <= reach_; ++y) {
        int& half = halfLengths_[size_t(x) * (reach_ + 1) + y];
        half = ballRow({0, 0, 0, radius}, x, y, 0, reach_).last;
        voxels_ += int64_t(2 * half + 1) * (x ? 2 : 1) * (y ? 2 : 1) * (half >= 0);
      }
  }

  Coord center;

  double radius() const { return radius_; }
  double volume() const { return 4.0 / 3.0 * M_PI * radius_ * radius_ * radius_; }
  int64_t voxels() const { return voxels_; }
  int reach() const { return reach_; }

  /// The part of row (x, y), along z.
  RowRange row(int x, int y) const {
    const int dx = std::abs(x - center.x()), dy = std::abs(y - center.y());
    if (dx > reach_ || dy > reach_) return {0, -1};
    const int half = halfLengths_[size_t(dx) * (reach_ + 1) + dy];
    return {center.z() - half, center.z() + half};
  }

 private:
  double radius_;
  int reach_;
  int64_t voxels_ = 0;
  std::vector<int> halfLengths_;  // -1: no voxel
};

double squaredDistance(const Coord& a, const Coord& b) {
  const double dx = a.x() - b.x(), dy = a.y() - b.y(), dz = a.z() - b.z();
  return dx * dx + dy * dy + dz * dz;
}

/// Walks through the placements of the balls, and knows the size of their union at each step.
class Placement {
 public:
  Placement(const SphereOptions& options, Interrupter* interrupter)
      : options_(options), interrupter_(interrupter), moves_(options.seed, kMoveStream) {}

  std::vector<Ball> find() {
    placeAtRandom();
    approachOverlap();
    mix();
    std::vector<Ball> result;
    for (const LatticeBall& ball : balls_)
      result.push_back({double(ball.center.x()), double(ball.center.y()), double(ball.center.z()),
                        ball.radius()});
    return result;
  }

 private:
  void placeAtRandom() {
    RandomSequence radii(options_.seed, kRadiusStream);
    RandomSequence centers(options_.seed, kCenterStream);
    for (int i = 0; i < options_.count; ++i) {
      balls_.emplace_back(radii.uniform(options_.minRadius, options_.maxRadius), Coord(0));
      int tries = 0;
      Share now;
      bool placed = false;
      do {
        poll(tries);
        if (tries++ == kMaxTries)
          throw InvalidInput("only " + std::to_string(i) + " of " + std::to_string(options_.count) +
                             " balls find a place: use fewer or smaller balls, or a larger size");
        balls_.back().center = anyCenter(balls_.back().radius(), centers);
        if (!ownsCenters(size_t(i))) continue;
        now = share(size_t(i));
        placed = fits(now);
      } while (!placed);
      unionVoxels_ += now.own;
      volume_ += balls_.back().volume();
      ballVoxels_ += balls_.back().voxels();
    }
  }

  /// Moves one ball at a time, never away from the goal.
  void approachOverlap() {
    const int64_t limit = kSearchMoves + kSearchMovesPerBall * options_.count;
    for (int64_t i = 0; !accepts(error()); ++i) {
      if (i == limit)
        throw InvalidInput("an overlap of " + std::to_string(options_.overlap) +
                           " cannot be met, the nearest found is " + std::to_string(overlap()) +
                           ": use another count, radius or size");
      poll(i);
      const double before = error();
      tryMove([&] { return error() <= before; });
    }
  }

  /// Symmetric proposals, accepted wherever the goal stays met: in the long run all placements that
  /// meet it are equally likely.
  void mix() {
    for (int64_t i = 0; i < kMixingMovesPerBall * options_.count; ++i) {
      poll(i);
      tryMove([&] { return accepts(error()); });
    }
  }

  /// Half of the moves go anywhere, the others nearby.
  template <typename Accept>
  void tryMove(const Accept& accept) {
    const size_t i = size_t(moves_.integer(0, options_.count - 1));
    LatticeBall& ball = balls_[i];
    const Coord oldCenter = ball.center;
    const int64_t oldUnion = unionVoxels_;
    Coord newCenter;
    if (moves_.integer(0, 1)) {
      newCenter = anyCenter(ball.radius(), moves_);
    } else {
      const int step = 1 + ball.reach() / 4;
      for (int axis = 0; axis < 3; ++axis)
        newCenter[axis] = oldCenter[axis] + moves_.integer(-step, step);
      if (!centerBox(ball.radius()).isInside(newCenter)) return;
    }
    ball.center = newCenter;
    if (ownsCenters(i)) {
      const Share now = share(i);
      ball.center = oldCenter;
      unionVoxels_ += now.own - share(i).own;
      ball.center = newCenter;
      if (fits(now) && accept()) return;
    }
    ball.center = oldCenter;
    unionVoxels_ = oldUnion;
  }

  /// Where a ball lies wholly inside, its real surface between the outermost voxels' centers.
  CoordBBox centerBox(double radius) const {
    const int margin = int(std::ceil(radius));
    return {Coord(margin), options_.size.offsetBy(-1 - margin)};
  }

  Coord anyCenter(double radius, RandomSequence& random) const {
    const CoordBBox box = centerBox(radius);
    Coord center;
    for (int axis = 0; axis < 3; ++axis)
      center[axis] = random.integer(box.min()[axis], box.max()[axis]);
    return center;
  }

  /// Does each of ball i and any other have the least power at its own center?
  bool ownsCenters(size_t i) const {
    const LatticeBall& ball = balls_[i];
    const double square = ball.radius() * ball.radius();
    for (size_t j = 0; j < balls_.size(); ++j)
      if (j != i && !(squaredDistance(ball.center, balls_[j].center) >
                      std::abs(square - balls_[j].radius() * balls_[j].radius())))
        return false;
    return true;
  }

  struct Share {
    int64_t own = 0;  ///< voxels that no other ball has
    int cover = 1;    ///< most balls that one of its voxels lies in
  };

  bool fits(const Share& share) const {
    return options_.maxCover == 0 || share.cover <= options_.maxCover;
  }

  /// How ball i shares its voxels with the others.
  Share share(size_t i) const {
    const LatticeBall& ball = balls_[i];
    std::vector<const LatticeBall*> others;
    for (size_t j = 0; j < balls_.size(); ++j) {
      const double touch = ball.radius() + balls_[j].radius();
      if (j != i && squaredDistance(ball.center, balls_[j].center) < touch * touch)
        others.push_back(&balls_[j]);
    }
    Share share;
    if (others.empty()) {
      share.own = ball.voxels();
      return share;
    }
    std::vector<RowRange> covered;
    const int r = ball.reach();
    for (int x = ball.center.x() - r; x <= ball.center.x() + r; ++x)
      for (int y = ball.center.y() - r; y <= ball.center.y() + r; ++y) {
        const RowRange row = ball.row(x, y);
        if (row.last < row.first) continue;
        covered.clear();
        for (const LatticeBall* other : others) {
          const RowRange part = other->row(x, y);
          if (part.first <= part.last && part.first <= row.last && part.last >= row.first)
            covered.push_back({std::max(part.first, row.first), std::min(part.last, row.last)});
        }
        addRow(row, covered, share);
      }
    return share;
  }

  static void addRow(const RowRange& row, std::vector<RowRange>& covered, Share& share) {
    std::sort(covered.begin(), covered.end(),
              [](const RowRange& a, const RowRange& b) { return a.first < b.first; });
    int next = row.first;
    for (const RowRange& part : covered) {
      const auto holds = [&](const RowRange& other) {
        return other.first <= part.first && other.last >= part.first;
      };
      share.cover =
          std::max(share.cover, 1 + int(std::count_if(covered.begin(), covered.end(), holds)));
      share.own += std::max(0, part.first - next);
      next = std::max(next, part.last + 1);
    }
    share.own += std::max(0, row.last + 1 - next);
  }

  double overlap() const { return (volume_ - double(unionVoxels_)) / double(unionVoxels_); }

  /// Distance from the goal. Overlap 0 means that no two balls share a voxel: there the volumes
  /// 4/3 pi r^3 would only tell how well voxels fill a ball.
  double error() const {
    if (options_.overlap == 0) return double(ballVoxels_ - unionVoxels_);
    return std::abs(overlap() - options_.overlap);
  }
  bool accepts(double e) const { return e <= kOverlapTolerance * options_.overlap; }

  void poll(int64_t step) const {
    if (step % kPollInterval == 0 && interrupter_ && interrupter_->wasInterrupted())
      throw Interrupted();
  }

  SphereOptions options_;
  Interrupter* interrupter_;
  RandomSequence moves_;
  std::vector<LatticeBall> balls_;
  double volume_ = 0;
  int64_t ballVoxels_ = 0, unionVoxels_ = 0;
};

}  // namespace

std::vector<Ball> placeSpheres(const SphereOptions& options, Interrupter* interrupter) {
  std::vector<Ball> balls = Placement(options, interrupter).find();
  sortByCenter(balls);
  return balls;
}

}  // namespace vdb_madf::detail
