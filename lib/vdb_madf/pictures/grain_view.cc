// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/grain_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/grids/object_mask.h"

namespace vdb_madf {

namespace {

using Vec = openvdb::Vec3d;
using MaskLeaf = MaskTree::LeafNodeType;

constexpr int kMaxEdge = 16384;
constexpr size_t kRowGrain = 4;

// Light, as shares of the grain's colour. Found by eye.
constexpr double kAmbient = 0.45, kDiffuse = 0.65;
constexpr double kFarthest = 0.6;  ///< the back of the box against its front

/// A walk through the cells of a lattice along a ray: Amanatides & Woo 1987. Cell (i, j, k) is the
/// box from (i, j, k) * size to (i + 1, j + 1, k + 1) * size, along each axis.
class CellWalk {
 public:
  /// From the ray's point at `t` on, which lies in (or, for rounding, next to) the cells from `low`
  /// to `high`.
  CellWalk(const Vec& origin, const Vec& direction, double t, const Vec& size, const Coord& low,
           const Coord& high)
      : origin_(origin), direction_(direction), size_(size), t_(t) {
    for (int axis = 0; axis < 3; ++axis) {
      const double p = (origin[axis] + t * direction[axis]) / size[axis];
      cell_[axis] = std::clamp(int(std::floor(p)), low[axis], high[axis]);
      setNext(axis);
    }
  }
  const Coord& cell() const { return cell_; }
  double t() const { return t_; }  ///< where the ray enters the cell
  void advance() {
    int axis = next_[0] <= next_[1] ? 0 : 1;
    if (next_[2] < next_[axis]) axis = 2;
    t_ = std::max(t_, next_[axis]);
    cell_[axis] += direction_[axis] > 0 ? 1 : -1;
    setNext(axis);
  }

 private:
  void setNext(int axis) {
    next_[axis] = direction_[axis] == 0
                      ? std::numeric_limits<double>::infinity()
                      : ((cell_[axis] + (direction_[axis] > 0)) * size_[axis] - origin_[axis]) /
                            direction_[axis];
  }
  const Vec& origin_;
  const Vec& direction_;
  const Vec& size_;
  Coord cell_;
  double t_;
  double next_[3];
};

/// The part of a ray within [low, high].
struct Span {
  double begin = -std::numeric_limits<double>::infinity();
  double end = std::numeric_limits<double>::infinity();

  Span(const Vec& origin, const Vec& direction, const Vec& low, const Vec& high) {
    for (int axis = 0; axis < 3; ++axis) {
      if (direction[axis] == 0) {
        if (origin[axis] < low[axis] || origin[axis] > high[axis]) end = begin;
        continue;
      }
      double a = (low[axis] - origin[axis]) / direction[axis];
      double b = (high[axis] - origin[axis]) / direction[axis];
      if (a > b) std::swap(a, b);
      begin = std::max(begin, a);
      end = std::min(end, b);
    }
  }
  bool empty() const { return !(begin < end); }
};

/// Smoothed indicator and its gradient at a voxel, from the 7^3 voxels around it.
class Smoothing {
 public:
  Smoothing() {
    for (int d = -kReach; d <= kReach; ++d)
      weight_[size_t(d + kReach)] = std::exp(-0.5 * d * d / (kSigma * kSigma));
    for (size_t bits = 0; bits < row_.size(); ++bits)
      for (int d = -kReach; d <= kReach; ++d)
        if (bits >> (d + kReach) & 1) {
          row_[bits].sum += weight_[size_t(d + kReach)];
          row_[bits].moment += d * weight_[size_t(d + kReach)];
        }
    total_ = std::pow(row_.back().sum, 3);
  }

  struct Surface {
    Vec normal;       ///< unit, out of the object; zero if there is none to be told
    double fill = 0;  ///< smoothed indicator, 0..1
  };

  /// @param edges of a voxel
  Surface at(const MaskGrid::ConstAccessor& object, const Coord& voxel, const Vec& edges) const {
    const Coord low = voxel - Coord(kReach);
    const Coord firstLeaf(low.x() & ~7, low.y() & ~7, low.z() & ~7);
    const MaskLeaf* leaves[2][2]
                          [2];  // the window is narrower than a leaf: it meets two along an axis
    for (int i = 0; i < 8; ++i)
      leaves[i >> 2][i >> 1 & 1][i & 1] =
          object.probeConstLeaf(firstLeaf + Coord(8 * (i >> 2), 8 * (i >> 1 & 1), 8 * (i & 1)));
    Vec gradient(0);
    double sum = 0;
    const int shift = low.z() - firstLeaf.z();
    for (int dx = 0; dx <= 2 * kReach; ++dx) {
      for (int dy = 0; dy <= 2 * kReach; ++dy) {
        const int x = low.x() + dx - firstLeaf.x(), y = low.y() + dy - firstLeaf.y();
        const auto& along = leaves[x >> 3][y >> 3];
        const unsigned bits = zRow(along[0], x & 7, y & 7) | zRow(along[1], x & 7, y & 7) << 8;
        const Row& row = row_[bits >> shift & 127];
        const double weight = weight_[size_t(dx)] * weight_[size_t(dy)];
        sum += weight * row.sum;
        gradient += weight * Vec((dx - kReach) * row.sum, (dy - kReach) * row.sum, row.moment);
      }
    }
    gradient = gradient / edges;
    const double length = gradient.length();
    return {length > 1e-9 ? gradient / -length : Vec(0), sum / total_};
  }

 private:
  static constexpr int kReach = 3;
  static constexpr double kSigma = 1.5;
  struct Row {
    double sum = 0, moment = 0;
  };

  static unsigned zRow(const MaskLeaf* leaf, int x, int y) {
    return leaf ? unsigned(leaf->getValueMask().getWord<uint64_t>(openvdb::Index(x)) >> (8 * y)) &
                      255u
                : 0u;
  }

  std::array<double, 2 * kReach + 1> weight_{};
  std::array<Row, 128> row_{};  ///< by the bits of seven voxels along z
  double total_ = 0;
};

/// The camera: where each pixel's ray starts, and how all rays run. Voxel (i, j, k) is here the
/// box from (i, j, k) to (i + 1, j + 1, k + 1), times its edges.
struct Camera {
  Vec right, up, direction;
  Vec center;  ///< of the box
  double voxelsPerPixel = 0;
  int width = 0, height = 0;

  Camera(const CoordBBox& box, const Vec& edges, const ViewOptions& options) {
    const double a = options.azimuth * M_PI / 180, e = options.elevation * M_PI / 180;
    const Vec towards(std::cos(e) * std::sin(a), -std::cos(e) * std::cos(a), std::sin(e));
    right = Vec(std::cos(a), std::sin(a), 0);
    up = towards.cross(right);
    direction = -towards;
    const Vec size = edges * box.extents().asVec3d();
    center = edges * box.min().asVec3d() + 0.5 * size;
    double across = 0, high = 0;
    for (int axis = 0; axis < 3; ++axis) {
      across += std::abs(right[axis]) * size[axis];
      high += std::abs(up[axis]) * size[axis];
    }
    voxelsPerPixel = std::max(across, high) / options.edge;
    width = std::clamp(int(std::ceil(across / voxelsPerPixel)), 1, options.edge);
    height = std::clamp(int(std::ceil(high / voxelsPerPixel)), 1, options.edge);
  }
  Vec origin(int x, int y) const {
    return center + (x + 0.5 - 0.5 * width) * voxelsPerPixel * right -
           (y + 0.5 - 0.5 * height) * voxelsPerPixel * up;
  }
};

class Renderer {
 public:
  /// @param edges of a voxel; the shortest is 1
  Renderer(const Int32Grid& labels, const CoordBBox& box, const Vec& edges,
           const GrainColors& colors, const Camera& camera)
      : labels_(labels),
        box_(box),
        edges_(edges),
        leafEdges_(8 * edges),
        colors_(colors),
        camera_(camera),
        object_(objectMask(labels)) {
    object_->clip(box_);  // makes tiles of full leaves
    object_->tree().voxelizeActiveTiles();
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = edges[axis] * box.min()[axis];
      high_[axis] = edges[axis] * (box.max()[axis] + 1);
      leafLow_[axis] = box.min()[axis] >> 3;
      leafHigh_[axis] = box.max()[axis] >> 3;
      depth_ += std::abs(camera.direction[axis]) * (high_[axis] - low_[axis]);
    }
    light_ = (camera.up - 0.55 * camera.right - 1.1 * camera.direction).unit();
  }

  void drawRow(int y, GrainView& view) const {
    const MaskGrid::ConstAccessor object = object_->getConstAccessor();
    const Int32Grid::ConstAccessor labels = labels_.getConstAccessor();
    for (int x = 0; x < camera_.width; ++x) {
      Coord voxel;
      double t = 0;
      if (!firstVoxel(object, camera_.origin(x, y), voxel, t)) continue;
      const int32_t label = labels.getValue(voxel);
      view.labels[size_t(y) * size_t(camera_.width) + size_t(x)] = label;
      view.picture.at(x, y) =
          shade(colors_.colorOf(label), smoothing_.at(object, voxel, edges_), t);
    }
  }

 private:
  /// The first object voxel that the ray meets, and where.
  bool firstVoxel(const MaskGrid::ConstAccessor& object, const Vec& origin, Coord& voxel,
                  double& t) const {
    const Span span(origin, camera_.direction, low_, high_);
    if (span.empty()) return false;
    CellWalk leaves(origin, camera_.direction, span.begin, leafEdges_, leafLow_, leafHigh_);
    for (; leaves.t() < span.end; leaves.advance()) {
      const Coord cell = leaves.cell();  // times 8: negative numbers must not be shifted left
      const Coord corner(cell.x() * 8, cell.y() * 8, cell.z() * 8);
      const MaskLeaf* leaf = object.probeConstLeaf(corner);
      if (!leaf) continue;
      CellWalk voxels(origin, camera_.direction, leaves.t(), edges_, corner, corner + Coord(7));
      for (; (voxels.cell() >> 3) == leaves.cell(); voxels.advance()) {
        if (!leaf->isValueOn(voxels.cell())) continue;
        voxel = voxels.cell();
        t = voxels.t();
        return true;
      }
    }
    return false;
  }

  Rgb shade(const Rgb& color, const Smoothing::Surface& surface, double t) const {
    // On a plane half of the surroundings are filled; in a neck more, on a tip less.
    const double openness = std::clamp(1.5 - surface.fill, 0.5, 1.2);
    const double light = kAmbient * openness + kDiffuse * std::max(0.0, surface.normal.dot(light_));
    // t is 0 on the plane through the box's centre.
    const double depth = std::clamp(t / depth_ + 0.5, 0.0, 1.0);
    const double factor = light * (1 + (kFarthest - 1) * depth);
    Rgb shaded{};
    for (size_t i = 0; i < 3; ++i)
      shaded[i] = uint8_t(std::lround(std::min(255.0, color[i] * factor)));
    return shaded;
  }

  const Int32Grid& labels_;
  const CoordBBox box_;
  const Vec edges_, leafEdges_;
  const GrainColors& colors_;
  const Camera& camera_;
  const MaskGrid::Ptr object_;  ///< no tiles, nothing beyond the box
  const Smoothing smoothing_;
  Vec low_, high_, light_;
  Coord leafLow_, leafHigh_;
  double depth_ = 0;  ///< of the box along the rays
};

void check(const ViewOptions& options) {
  if (!std::isfinite(options.azimuth))
    throw InvalidInput("the azimuth of the view is an angle in degrees");
  if (!(options.elevation >= -90 && options.elevation <= 90))
    throw InvalidInput("the elevation of the view must lie between -90 and 90 degrees");
  if (options.edge < 1 || options.edge > kMaxEdge)
    throw InvalidInput("the edge of the view must be 1 to " + std::to_string(kMaxEdge) + " pixels");
}

}  // namespace

GrainView viewGrains(const Int32Grid& labels, const CoordBBox& box, const GrainColors& colors,
                     const ViewOptions& options, Interrupter* interrupter) {
  check(options);
  if (box.empty()) return {Picture(1, 1, options.background), {0}, 1};
  const Vec edges = detail::proportions(labels.transform());
  const Camera camera(box, edges, options);
  GrainView view{Picture(camera.width, camera.height, options.background), {}, 0};
  view.labels.assign(view.picture.pixels.size(), 0);
  view.voxelsPerPixel = camera.voxelsPerPixel;
  const Renderer renderer(labels, box, edges, colors, camera);
  detail::parallelFor(size_t(camera.height), kRowGrain, interrupter, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) renderer.drawRow(int(y), view);
  });
  return view;
}

}  // namespace vdb_madf
