// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/grain_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/pictures/detail/camera.h"
#include "vdb_madf/pictures/detail/smooth_surface.h"

namespace vdb_madf {

namespace {

using Vec = openvdb::Vec3d;
using MaskLeaf = MaskTree::LeafNodeType;

constexpr int kMaxEdge = 16384;
constexpr size_t kRowGrain = 4;

constexpr int kRays = 3;  ///< along each edge of a pixel at which something ends
constexpr int kMiddleRay = kRays * kRays / 2;
constexpr double kStep = 3;  ///< shortest edges of a voxel: more of depth is an end of the surface

// Light, as shares of the grain's color. Found by eye.
constexpr double kAmbient = 0.5, kDiffuse = 0.65;
constexpr double kFarthest = 0.65;     ///< the back of the box against its front
constexpr double kOutside = 1;         ///< voxels off the surface, where the light is found
constexpr double kMostInwards = 0.75;  ///< less than kOutside: never through a thin plate
constexpr double kPlane = 0.2625;      ///< what is filled there around a plane

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

/// Where a ray of a pixel begins, of kRays * kRays; that in the middle goes through its center.
Vec rayOrigin(const detail::Camera& camera, int x, int y, int ray) {
  return camera.origin(x + (ray % kRays + 0.5) / kRays, y + double(ray / kRays + 0.5) / kRays);
}

/// The object in a box, as rays meet it.
class SeenObject {
 public:
  SeenObject(const MaskGrid::Ptr& object, const CoordBBox& box, const Vec& edges,
             const detail::Camera& camera)
      : edges_(edges), leafEdges_(8 * edges), camera_(camera), object_(object) {
    object_->clip(box);  // makes tiles of full leaves
    object_->tree().voxelizeActiveTiles();
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = edges[axis] * box.min()[axis];
      high_[axis] = edges[axis] * (box.max()[axis] + 1);
      leafLow_[axis] = box.min()[axis] >> 3;
      leafHigh_[axis] = box.max()[axis] >> 3;
      depth_ += std::abs(camera.direction[axis]) * (high_[axis] - low_[axis]);
    }
  }

  const detail::Camera& camera() const { return camera_; }
  const MaskGrid& object() const { return *object_; }  ///< no tiles, nothing beyond the box
  const Vec& edges() const { return edges_; }
  double depth() const { return depth_; }  ///< of the box along the rays

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

 private:
  const Vec edges_, leafEdges_;
  const detail::Camera& camera_;
  const MaskGrid::Ptr object_;
  Vec low_, high_;
  Coord leafLow_, leafHigh_;
  double depth_ = 0;
};

class Renderer {
 public:
  Renderer(const SeenObject& seen, const Int32Grid& labels, const GrainColors& colors)
      : seen_(seen),
        labels_(labels),
        colors_(colors),
        camera_(seen.camera()),
        edges_(seen.edges()),
        depth_(seen.depth()) {
    light_ = (camera_.up - 0.55 * camera_.right - 1.1 * camera_.direction).unit();
  }

  /// A ray through the center of each pixel.
  void drawRow(int y, GrainView& view, std::vector<float>& depths) const {
    const Eye eye(*this);
    for (int x = 0; x < camera_.width; ++x) {
      const Sample sample = eye.look(x, y, kMiddleRay);
      if (!sample.label) continue;
      const size_t pixel = at(x, y);
      view.labels[pixel] = sample.label;
      view.picture.pixels[pixel] = sample.color;
      depths[pixel] = float(sample.t);
    }
  }

  /// Rays all over those pixels at which a grain or a surface ends. `view` has its first rays in all
  /// rows, `smooth` gets the result.
  void smoothRow(int y, const Picture& backdrop, const GrainView& view,
                 const std::vector<float>& depths, Picture& smooth) const {
    const Eye eye(*this);
    for (int x = 0; x < camera_.width; ++x) {
      if (!isEdge(x, y, view, depths)) continue;
      std::array<int, 3> sum{};
      for (int i = 0; i < kRays * kRays; ++i) {
        Rgb color = view.picture.at(x, y);
        if (i != kMiddleRay) {
          const Sample sample = eye.look(x, y, i);
          color = sample.label ? sample.color : backdrop.at(x, y);
        }
        for (size_t channel = 0; channel < 3; ++channel) sum[channel] += color[channel];
      }
      for (size_t channel = 0; channel < 3; ++channel)
        smooth.at(x, y)[channel] = uint8_t((sum[channel] + kRays * kRays / 2) / (kRays * kRays));
    }
  }

 private:
  struct Sample {
    int32_t label = 0;  ///< 0: background
    Rgb color{};
    double t = 0;
  };

  /// Looks along rays; one a thread.
  class Eye {
   public:
    explicit Eye(const Renderer& renderer)
        : renderer_(renderer),
          object_(renderer.seen_.object().getConstAccessor()),
          labels_(renderer.labels_.getConstAccessor()) {}
    Sample look(int x, int y, int ray) const {
      const Vec origin = rayOrigin(renderer_.camera_, x, y, ray);
      Sample sample;
      Coord voxel;
      if (!renderer_.seen_.firstVoxel(object_, origin, voxel, sample.t)) return sample;
      sample.label = labels_.getValue(voxel);
      const Vec hit = (origin + sample.t * renderer_.camera_.direction) / renderer_.edges_;
      sample.color =
          renderer_.shade(renderer_.colors_.colorOf(sample.label), object_, hit, sample.t);
      return sample;
    }

   private:
    const Renderer& renderer_;
    const MaskGrid::ConstAccessor object_;
    const Int32Grid::ConstAccessor labels_;
  };

  size_t at(int x, int y) const { return size_t(y) * size_t(camera_.width) + size_t(x); }

  bool isEdge(int x, int y, const GrainView& view, const std::vector<float>& depths) const {
    const size_t pixel = at(x, y);
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= camera_.width || y + dy >= camera_.height)
          continue;
        const size_t other = at(x + dx, y + dy);
        if (view.labels[other] != view.labels[pixel] ||
            std::abs(depths[other] - depths[pixel]) > kStep + 3 * camera_.voxelsPerPixel)
          return true;
      }
    return false;
  }

  /// The light on the surface near the point (in voxels) that a ray hits.
  Rgb shade(const Rgb& color, const MaskGrid::ConstAccessor& object, const Vec& hit,
            double t) const {
    // The smooth surface lies where half of the surroundings are filled: on its outside, the light
    // and how much is near do not depend on the steps of the voxels.
    const auto first = detail::smoothValue(object, hit);
    const double steepness = std::max(first.gradient.length(), 0.05);
    const double inwards =
        std::clamp((0.5 - first.fill) / steepness, -1.5, kMostInwards) - kOutside;
    const auto near = detail::smoothValue(object, hit + inwards / steepness * first.gradient);
    Vec normal = -near.gradient / edges_;
    if (normal.length() > 1e-6) normal.normalize();
    if (normal.dot(camera_.direction) > 0) normal = -normal;
    const double openness = std::clamp(1 + 2 * (kPlane - near.fill), 0.5, 1.25);
    const double light = kAmbient * openness + kDiffuse * std::max(0.0, normal.dot(light_));
    // t is 0 on the plane through the box's center.
    const double depth = std::clamp(t / depth_ + 0.5, 0.0, 1.0);
    const double factor = light * (1 + (kFarthest - 1) * depth);
    Rgb shaded{};
    for (size_t i = 0; i < 3; ++i)
      shaded[i] = uint8_t(std::lround(std::min(255.0, color[i] * factor)));
    return shaded;
  }

  const SeenObject& seen_;
  const Int32Grid& labels_;
  const GrainColors& colors_;
  const detail::Camera& camera_;
  const Vec& edges_;
  const double depth_;
  Vec light_;
};

template <typename F>
void forEachRow(const detail::Camera& camera, Interrupter* interrupter, const F& work) {
  detail::parallelFor(size_t(camera.height), kRowGrain, interrupter, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) work(int(y));
  });
}

/// Of those from `first` on.
void sortUnique(std::vector<Coord>& leaves, size_t first) {
  std::sort(leaves.begin() + std::ptrdiff_t(first), leaves.end());
  leaves.erase(std::unique(leaves.begin() + std::ptrdiff_t(first), leaves.end()), leaves.end());
}

void check(const ViewOptions& options) {
  if (!std::isfinite(options.azimuth))
    throw InvalidInput("the azimuth of the view is an angle in degrees");
  if (!(options.elevation >= -90 && options.elevation <= 90))
    throw InvalidInput("the elevation of the view must lie between -90 and 90 degrees");
  if (options.edge < 1 || options.edge > kMaxEdge)
    throw InvalidInput("the edge of the view must be 1 to " + std::to_string(kMaxEdge) + " pixels");
}

}  // namespace

std::vector<Coord> seenLeaves(const MaskGrid::Ptr& object, const CoordBBox& box,
                              const ViewOptions& options, Interrupter* interrupter) {
  check(options);
  if (box.empty()) return {};
  const Vec edges = detail::proportions(object->transform());
  const detail::Camera camera(box, edges, options);
  const SeenObject seen(object, box, edges, camera);
  detail::PerThread<std::vector<Coord>> found{std::vector<Coord>()};
  forEachRow(camera, interrupter, [&](int y) {
    const auto tree = object->getConstAccessor();
    std::vector<Coord>& leaves = found.local();
    const size_t before = leaves.size();
    for (int ray = 0; ray < camera.width * kRays * kRays; ++ray) {
      const int i = ray % (kRays * kRays), x = ray / (kRays * kRays);
      Coord voxel;
      double t = 0;
      if (!seen.firstVoxel(tree, rayOrigin(camera, x, y, i), voxel, t)) continue;
      const Coord leaf = voxel & ~7;
      if (leaves.empty() || leaves.back() != leaf) leaves.push_back(leaf);
    }
    sortUnique(leaves, before);
  });
  std::vector<Coord> all;
  for (const std::vector<Coord>& part : found) all.insert(all.end(), part.begin(), part.end());
  sortUnique(all, 0);
  return all;
}

GrainView viewGrains(const MaskGrid::Ptr& object, const Int32Grid& labels, const CoordBBox& box,
                     const GrainColors& colors, const ViewOptions& options,
                     Interrupter* interrupter) {
  check(options);
  if (box.empty()) return {Picture(1, 1, options.background), {0}, 1};
  const Vec edges = detail::proportions(labels.transform());
  const detail::Camera camera(box, edges, options);
  Picture backdrop(camera.width, camera.height, options.background);
  if (options.box) detail::drawBox(camera, backdrop);
  GrainView view{backdrop, std::vector<int32_t>(backdrop.pixels.size(), 0), camera.voxelsPerPixel};
  std::vector<float> depths(view.labels.size(), 0);
  const SeenObject seen(object, box, edges, camera);
  const Renderer renderer(seen, labels, colors);
  forEachRow(camera, interrupter, [&](int y) { renderer.drawRow(y, view, depths); });
  Picture smooth = view.picture;
  forEachRow(camera, interrupter,
             [&](int y) { renderer.smoothRow(y, backdrop, view, depths, smooth); });
  view.picture = std::move(smooth);
  return view;
}

GrainView viewGrains(const Int32Grid& labels, const CoordBBox& box, const GrainColors& colors,
                     const ViewOptions& options, Interrupter* interrupter) {
  check(options);
  if (box.empty()) return {Picture(1, 1, options.background), {0}, 1};
  return viewGrains(objectMask(labels), labels, box, colors, options, interrupter);
}

}  // namespace vdb_madf
