// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/scan.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/samples/detail/bodies.h"
#include "vdb_madf/samples/detail/gaussian_blur.h"
#include "vdb_madf/samples/detail/object_change.h"
#include "vdb_madf/samples/detail/sample_options.h"
#include "vdb_madf/samples/detail/surface_distance.h"
#include "vdb_madf/samples/detail/white_noise.h"

namespace vdb_madf {

namespace {

using detail::FloatBox;

/// The samples themselves draw from streams 0 and 1.
constexpr uint64_t kSurfaceStream = 2;
constexpr uint64_t kNoiseStream = 3;

constexpr double kFarthestMove = 4;  // standard deviations
/// A voxel farther than this from all true ones is noise of its own.
constexpr int kNoiseReach = 2;
constexpr float kCut = 0.5f;

constexpr float kAirGray = 10000, kSolidGray = 30000, kMaxGray = 65535;
/// Gray values are made in blocks of so many voxels a side, by one thread each.
constexpr int kGrayBlock = 64;

/// A Gaussian random field on Z^3, the same whatever box is looked at. A Gaussian blur of white
/// noise by sigma has the correlation exp(-r^2 / (4 sigma^2)).
class SmoothNoise {
 public:
  /// Length 0: white noise.
  SmoothNoise(uint64_t seed, uint64_t stream, double deviation, double length)
      : seed_(seed),
        stream_(stream),
        kernel_(length == 0 ? std::vector<float>{1} : detail::gaussianKernel(length / 2)) {
    double squares = -double(kernel_[0]) * kernel_[0];
    for (const float weight : kernel_) squares += 2 * double(weight) * weight;
    factor_ = float(deviation / (squares * std::sqrt(squares)));
  }

  FloatBox in(CoordBBox box) const {
    box.expand(detail::kernelRadius(kernel_));
    FloatBox field =
        detail::blurred(detail::whiteNoise(box, seed_, stream_, nullptr), kernel_, nullptr);
    for (float& value : field.values) value *= factor_;
    return field;
  }

 private:
  uint64_t seed_, stream_;
  std::vector<float> kernel_;
  float factor_;
};

class SurfaceChange : public detail::ObjectChange {
 public:
  SurfaceChange(const Sample& sample, const ScanOptions& options)
      : ObjectChange(sample),
        noise_(options.seed, kSurfaceStream, options.surface, options.surfaceLength),
        farthest_(float(kFarthestMove * options.surface)) {}

  /// How far a new voxel is from the old object, at most.
  int reach() const { return int(std::ceil(farthest_ + 0.5f)); }

 private:
  FloatBox height(const CoordBBox& box) const override {
    FloatBox field = noise_.in(box);
    const FloatBox distance = detail::surfaceDistance(indicatorIn(box, reach()), reach());
    for (size_t i = 0; i < field.values.size(); ++i)
      field.values[i] = std::clamp(field.values[i], -farthest_, farthest_) - distance.values[i];
    return field;
  }

  SmoothNoise noise_;
  float farthest_;
};

std::vector<float> blurKernel(const ScanOptions& options) {
  return options.blur == 0 ? std::vector<float>{1} : detail::gaussianKernel(options.blur);
}

class GrayChange : public detail::ObjectChange {
 public:
  GrayChange(const Sample& sample, const ScanOptions& options)
      : ObjectChange(sample),
        kernel_(blurKernel(options)),
        noise_(options.seed, kNoiseStream, options.noise, options.noiseLength) {}

 private:
  FloatBox height(const CoordBBox& box) const override {
    FloatBox field =
        detail::blurred(indicatorIn(box, detail::kernelRadius(kernel_)), kernel_, nullptr);
    const FloatBox noise = noise_.in(box);
    for (size_t i = 0; i < field.values.size(); ++i) field.values[i] += noise.values[i] - kCut;
    return field;
  }

  std::vector<float> kernel_;
  SmoothNoise noise_;
};

class GrayScan {
 public:
  GrayScan(const detail::Bodies& bodies, const ScanOptions& options)
      : bodies_(bodies),
        kernel_(blurKernel(options)),
        noise_(options.seed, kNoiseStream, options.noise, options.noiseLength),
        hasNoise_(options.noise > 0) {}

  /// 0 in the air, 1 in the bodies.
  FloatBox in(const CoordBBox& box) const {
    CoordBBox seen = box;
    seen.expand(detail::kernelRadius(kernel_));
    FloatBox field = detail::blurred(bodies_.shares(seen), kernel_, nullptr);
    if (!hasNoise_) return field;
    const FloatBox noise = noise_.in(box);
    for (size_t i = 0; i < field.values.size(); ++i) field.values[i] += noise.values[i];
    return field;
  }

 private:
  const detail::Bodies& bodies_;
  std::vector<float> kernel_;
  SmoothNoise noise_;
  bool hasNoise_;
};

uint16_t grayOf(float value) {
  const float gray = kAirGray + (kSolidGray - kAirGray) * value;
  return uint16_t(std::clamp(gray, 0.0f, kMaxGray) + 0.5f);
}

std::vector<CoordBBox> grayBlocks(const CoordBBox& box) {
  std::vector<CoordBBox> blocks;
  for (int x = box.min().x(); x <= box.max().x(); x += kGrayBlock)
    for (int y = box.min().y(); y <= box.max().y(); y += kGrayBlock)
      for (int z = box.min().z(); z <= box.max().z(); z += kGrayBlock) {
        blocks.push_back({Coord(x, y, z), Coord(x, y, z).offsetBy(kGrayBlock - 1)});
        blocks.back().intersect(box);
      }
  return blocks;
}

}  // namespace

void checkScan(const ScanOptions& options) {
  detail::checkRange("surface", options.surface, 0, 8);
  detail::checkRange("length of the surface", options.surfaceLength, 1, 32);
  detail::checkRange("blur of the scan", options.blur, 0, 8);
  detail::checkRange("noise of the scan", options.noise, 0, 1);
  detail::checkRange("length of the noise", options.noiseLength, 0, 32);
}

Sample scanned(const Sample& sample, const ScanOptions& options, Interrupter* interrupter) {
  checkScan(options);
  if (options.surface > 0 || options.blur > 0 || options.noise > 0)
    requireCubicVoxels(*sample.object, "making a scan of a sample");
  auto source = detail::SourceText::of(*sample.object);
  const Coord size = storedDomain(*sample.object)->box().dim();
  const auto voxelSize = storedVoxelSize(*sample.object);
  Sample result = sample;
  if (options.surface > 0) {
    const SurfaceChange change(result, options);
    result = detail::changed(result, change, change.reach(), interrupter);
    source.range("surface", options.surface, options.surfaceLength);
    result = detail::described(result, size, source, voxelSize);
  }
  if (options.blur > 0 || options.noise > 0) {
    result = detail::changed(result, GrayChange(result, options), kNoiseReach, interrupter);
    source.add("scan-noise", detail::shortestDecimal(options.blur) + ":" +
                                 detail::shortestDecimal(options.noise) + ":" +
                                 detail::shortestDecimal(options.noiseLength));
    result = detail::described(result, size, source, voxelSize);
  }
  return result;
}

std::vector<uint16_t> grayValues(const Sample& sample, const ScanOptions& options,
                                 const CoordBBox& box, Interrupter* interrupter) {
  checkScan(options);
  if (!sample.bodies) throw InvalidInput("the sample has no bodies that a scan could show");
  if (options.surface > 0)
    throw InvalidInput("a surface is that of an object's voxels, not of bodies in a scan");
  if (options.blur > 0 || options.noise > 0)
    requireCubicVoxels(*sample.object, "making a scan of a sample");
  const GrayScan scan(*sample.bodies, options);
  const std::vector<CoordBBox> blocks = grayBlocks(box);
  const Coord dim = box.dim();
  std::vector<uint16_t> values(size_t(dim.x()) * dim.y() * dim.z());
  detail::parallelForEach(blocks.size(), 1, interrupter, [&](size_t block) {
    const FloatBox field = scan.in(blocks[block]);
    size_t i = 0;
    for (auto p = field.box.begin(); p; ++p, ++i) {
      const Coord at = *p - box.min();
      values[(size_t(at.z()) * dim.y() + at.y()) * dim.x() + at.x()] = grayOf(field.values[i]);
    }
  });
  return values;
}

}  // namespace vdb_madf
