// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/grain_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/leaves/detail/leaf_neighborhood.h"
#include "vdb_madf/pictures/detail/camera.h"
#include "vdb_madf/pictures/detail/smooth_surface.h"
#include "vdb_madf/pictures/detail/surface_raster.h"
#include "vdb_madf/pictures/detail/voxel_rays.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf {

namespace {

using Vec = openvdb::Vec3d;

constexpr int kMaxEdge = 16384;
constexpr size_t kRowGrain = 4;

/// Along each edge of a pixel at which something ends.
constexpr int kRays = detail::SurfaceRaster::kSamples;
constexpr int kMiddleRay = kRays * kRays / 2;
/// Voxels of so many pixels or more are not drawn as such, but as smoothed surfaces.
constexpr double kLeastPixels = 3;
constexpr int kSmoothing = 10;
constexpr double kStep = 3;  ///< shortest edges of a voxel: more of depth is an end of the surface

// Light, as shares of the grain's color. Found by eye.
constexpr double kAmbient = 0.5, kDiffuse = 0.65;
constexpr double kFarthest = 0.65;     ///< the back of the box against its front
constexpr double kOutside = 1;         ///< voxels off the surface, where the light is found
constexpr double kMostInwards = 0.75;  ///< less than kOutside: never through a thin plate
constexpr double kPlane = 0.2625;      ///< what is filled there around a plane

/// Where a ray of a pixel begins, of kRays * kRays; that in the middle goes through its center.
Vec rayOrigin(const detail::Camera& camera, int x, int y, int ray) {
  return camera.origin(x + (ray % kRays + 0.5) / kRays, y + double(ray / kRays + 0.5) / kRays);
}

/// The object as leaves without tiles, and nothing beyond the box.
MaskGrid::Ptr clipped(const MaskGrid::Ptr& object, const CoordBBox& box) {
  object->clip(box);  // makes tiles of full leaves
  object->tree().voxelizeActiveTiles();
  return object;
}

class Renderer {
 public:
  Renderer(const detail::VoxelRays& rays, const Int32Grid& labels, const CoordBBox& box,
           const Vec& edges, const GrainColors& colors, const detail::Camera& camera)
      : rays_(rays), labels_(labels), edges_(edges), colors_(colors), camera_(camera) {
    for (int axis = 0; axis < 3; ++axis)
      depth_ += std::abs(camera.direction[axis]) *
                (edges[axis] * (box.max()[axis] + 1) - edges[axis] * box.min()[axis]);
    light_ = (camera.up - 0.55 * camera.right - 1.1 * camera.direction).unit();
  }

  /// A ray through the center of each pixel.
  void drawRow(int y, GrainView& view, std::vector<float>& depths) const {
    Eye eye(*this);
    for (int x = 0; x < camera_.width; ++x) {
      const Sample sample = eye.look(x, y, kMiddleRay);
      if (!sample.label) continue;
      const size_t pixel = at(x, y);
      view.labels[pixel] = sample.label;
      view.picture.pixels[pixel] = sample.color;
      depths[pixel] = float(sample.t);
    }
  }

  /// Rays all over those pixels at which a grain or a surface ends. `view` has its first rays in
  /// all rows, `smooth` gets the result.
  void smoothRow(int y, const Picture& backdrop, const GrainView& view,
                 const std::vector<float>& depths, Picture& smooth) const {
    Eye eye(*this);
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

  /// The pixels of some rows by what is seen of smoothed surfaces there.
  void drawBand(int band, const detail::SurfaceRaster& raster, const Picture& backdrop,
                GrainView& view) const {
    detail::SurfaceRaster::Samples samples;
    raster.draw(band, samples);
    Eye eye(*this);
    const int first = band * raster.kBand, end = std::min(camera_.height, first + raster.kBand);
    for (int y = first; y < end; ++y)
      for (int x = 0; x < camera_.width; ++x)
        drawPixel(x, y, first, raster, samples, backdrop, eye, view);
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
          object_(renderer.rays_.object().getConstUnsafeAccessor()),
          labels_(renderer.labels_.getConstUnsafeAccessor()),
          surface_(renderer.rays_.object()),
          outside_(renderer.rays_.object()) {}
    Sample look(int x, int y, int ray) {
      const Vec origin = rayOrigin(renderer_.camera_, x, y, ray);
      Sample sample;
      Coord voxel;
      if (!renderer_.rays_.first(object_, origin, voxel, sample.t)) return sample;
      sample.label = labels_.getValue(voxel);
      const Vec hit = (origin + sample.t * renderer_.camera_.direction) / renderer_.edges_;
      sample.color = renderer_.shade(renderer_.colors_.colorOf(sample.label), *this, hit, sample.t);
      return sample;
    }
    detail::SmoothSurface& surface() { return surface_; }
    detail::SmoothSurface& outside() { return outside_; }

   private:
    const Renderer& renderer_;
    const MaskGrid::ConstUnsafeAccessor object_;
    const Int32Grid::ConstUnsafeAccessor labels_;
    detail::SmoothSurface surface_, outside_;  ///< where a ray hits; in front of that
  };

  void drawPixel(int x, int y, int firstRow, const detail::SurfaceRaster& raster,
                 const detail::SurfaceRaster::Samples& samples, const Picture& backdrop, Eye& eye,
                 GrainView& view) const {
    std::array<Sample, kRays * kRays> seen;
    float nearest = std::numeric_limits<float>::infinity(), farthest = -nearest;
    for (int i = 0; i < kRays * kRays; ++i) {
      const auto& sample = samples[raster.place(x, y - firstRow, i % kRays, i / kRays)];
      nearest = std::min(nearest, sample.t);
      farthest = std::max(farthest, sample.t);
      if (sample.triangle != raster.kNothing)
        seen[size_t(i)] = {raster.labelOf(sample.triangle), {}, sample.t};
    }
    const int32_t label = seen[kMiddleRay].label;
    view.labels[at(x, y)] = label;
    const bool isEven =
        std::all_of(seen.begin(), seen.end(), [&](const Sample& s) { return s.label == label; }) &&
        (label == 0 || farthest - nearest <= kStep + 3 * camera_.voxelsPerPixel);
    if (isEven && label == 0) return;
    std::array<int, 3> sum{};
    const int begin = isEven ? kMiddleRay : 0, end = isEven ? kMiddleRay + 1 : kRays * kRays;
    for (int i = begin; i < end; ++i) {
      const Sample& sample = seen[size_t(i)];
      const Vec hit = (rayOrigin(camera_, x, y, i) + sample.t * camera_.direction) / edges_;
      const Rgb color = sample.label ? shade(colors_.colorOf(sample.label), eye, hit, sample.t)
                                     : backdrop.at(x, y);
      for (size_t channel = 0; channel < 3; ++channel) sum[channel] += color[channel];
    }
    const int count = end - begin;
    for (size_t channel = 0; channel < 3; ++channel)
      view.picture.at(x, y)[channel] = uint8_t((sum[channel] + count / 2) / count);
  }

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
  Rgb shade(const Rgb& color, Eye& eye, const Vec& hit, double t) const {
    // The smooth surface lies where half of the surroundings are filled: on its outside, the light
    // and how much is near do not depend on the steps of the voxels.
    const auto first = eye.surface().at(hit);
    const double steepness = std::max(first.gradient.length(), 0.05);
    const double inwards =
        std::clamp((0.5 - first.fill) / steepness, -1.5, kMostInwards) - kOutside;
    const auto near = eye.outside().at(hit + inwards / steepness * first.gradient);
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

  const detail::VoxelRays& rays_;
  const Int32Grid& labels_;
  const Vec edges_;
  const GrainColors& colors_;
  const detail::Camera& camera_;
  Vec light_;
  double depth_ = 0;  ///< of the box along the rays
};

template <typename F>
void forEachRow(const detail::Camera& camera, Interrupter* interrupter, const F& work) {
  detail::parallelForEach(size_t(camera.height), kRowGrain, interrupter,
                          [&](size_t y) { work(int(y)); });
}

/// The leaves whose voxels some rays of each pixel meet first, ascending.
std::vector<Coord> leavesSeen(const detail::VoxelRays& rays, const detail::Camera& camera,
                              int firstRay, int endRay, Interrupter* interrupter) {
  detail::PerThread<std::vector<Coord>> found{std::vector<Coord>()};
  forEachRow(camera, interrupter, [&](int y) {
    const auto tree = rays.object().getConstUnsafeAccessor();
    std::vector<Coord>& leaves = found.local();
    const size_t before = leaves.size();
    for (int x = 0; x < camera.width; ++x)
      for (int ray = firstRay; ray < endRay; ++ray) {
        Coord voxel;
        double t = 0;
        if (!rays.first(tree, rayOrigin(camera, x, y, ray), voxel, t)) continue;
        const Coord leaf = voxel & ~7;
        if (leaves.empty() || leaves.back() != leaf) leaves.push_back(leaf);
      }
    detail::sortUnique(leaves, before);
  });
  std::vector<Coord> all;
  for (const std::vector<Coord>& part : found) all.insert(all.end(), part.begin(), part.end());
  detail::sortUnique(all);
  return all;
}

bool drawsSurfaces(const ViewOptions& options, const detail::Camera& camera) {
  return options.surfaces && kLeastPixels * camera.voxelsPerPixel <= 1;
}

/// Those leaves, and those of the object around them: what is near a smoothed surface that is seen.
std::vector<Coord> leavesAround(const std::vector<Coord>& leaves, const MaskGrid& object) {
  std::vector<Coord> found;
  for (const Coord& leaf : leaves)
    for (int side = 0; side < 27; ++side) {
      const Coord beside = detail::around(leaf, side);
      if (object.tree().probeConstLeaf(beside)) found.push_back(beside);
    }
  detail::sortUnique(found);
  return found;
}

/// The labels of the object's voxels in some leaves.
Int32Grid::Ptr labelsIn(const std::vector<Coord>& leaves, const MaskGrid& object,
                        const Int32Grid& labels, const CoordBBox& box) {
  const auto near = Int32Grid::create(0);
  setDomain(*near, Domain(box));
  const auto accessor = labels.getConstUnsafeAccessor();
  for (const Coord& origin : leaves) {
    auto leaf = std::make_unique<Int32Tree::LeafNodeType>(origin, 0);
    for (auto voxel = object.tree().probeConstLeaf(origin)->cbeginValueOn(); voxel; ++voxel)
      leaf->setValueOn(voxel.pos(), accessor.getValue(voxel.getCoord()));
    near->tree().addLeaf(leaf.release());
  }
  return near;
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
  const detail::VoxelRays rays(clipped(object, box), box, edges, camera.direction);
  const std::vector<Coord> leaves = leavesSeen(rays, camera, 0, kRays * kRays, interrupter);
  return drawsSurfaces(options, camera) ? leavesAround(leaves, *object) : leaves;
}

GrainView viewGrains(const MaskGrid::Ptr& object, const Int32Grid& labels, const CoordBBox& box,
                     const GrainColors& colors, const ViewOptions& options,
                     Interrupter* interrupter) {
  check(options);
  if (box.empty()) return {Picture(1, 1, options.background), {0}, 1};
  const Vec edges = detail::proportions(labels.transform());
  const detail::Camera camera(box, edges, options);
  Picture backdrop(camera.width, camera.height, options.background);
  if (options.box) detail::drawBox(camera, options.ink, backdrop);
  GrainView view{backdrop, std::vector<int32_t>(backdrop.pixels.size(), 0), camera.voxelsPerPixel};
  const detail::VoxelRays rays(clipped(object, box), box, edges, camera.direction);
  const Renderer renderer(rays, labels, box, edges, colors, camera);
  if (drawsSurfaces(options, camera)) {
    const std::vector<Coord> leaves =
        leavesSeen(rays, camera, kMiddleRay, kMiddleRay + 1, interrupter);
    const Int32Grid::Ptr near = labelsIn(leavesAround(leaves, *object), *object, labels, box);
    const GrainMesh mesh = grainMesh(*near, {kSmoothing}, interrupter);
    const detail::SurfaceRaster raster(mesh, edges, camera);
    detail::parallelForEach(size_t(raster.bandCount()), 1, interrupter, [&](size_t band) {
      renderer.drawBand(int(band), raster, backdrop, view);
    });
    return view;
  }
  std::vector<float> depths(view.labels.size(), 0);
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
