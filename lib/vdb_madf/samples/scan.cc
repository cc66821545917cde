// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/scan.h"

#include <openvdb/tree/ValueAccessor.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/samples/detail/carried_labels.h"
#include "vdb_madf/samples/detail/gaussian_blur.h"
#include "vdb_madf/samples/detail/mask_blocks.h"
#include "vdb_madf/samples/detail/sample_options.h"
#include "vdb_madf/samples/detail/surface_distance.h"
#include "vdb_madf/samples/detail/white_noise.h"

namespace vdb_madf {

namespace {

using detail::FloatBox;
using detail::MaskBlocks;

/// The samples themselves draw from streams 0 and 1.
constexpr uint64_t kSurfaceStream = 2;
constexpr uint64_t kNoiseStream = 3;

/// In standard deviations.
constexpr double kFarthestMove = 4;
/// A voxel farther than this from all true ones is noise of its own.
constexpr int kNoiseReach = 2;
constexpr float kCut = 0.5f;

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

/// 1 in the object, 0 outside; beyond the faces as at the faces.
FloatBox indicator(const MaskTree& object, const CoordBBox& domain, const CoordBBox& box) {
  FloatBox field(box);
  const openvdb::tree::ValueAccessor<const MaskTree> values(object);
  const auto inside = [&](int i, int axis) {
    return std::clamp(i, domain.min()[axis], domain.max()[axis]);
  };
  for (int x = box.min().x(); x <= box.max().x(); ++x)
    for (int y = box.min().y(); y <= box.max().y(); ++y) {
      float* row = field.values.data() + field.offset(x, y, box.min().z());
      for (int z = box.min().z(); z <= box.max().z(); ++z)
        *row++ = values.isValueOn({inside(x, 0), inside(y, 1), inside(z, 2)});
    }
  return field;
}

/// The object after one change, block by block; only the blocks at work are held as dense arrays.
class Change {
 public:
  explicit Change(const Sample& sample)
      : object_(sample.object->tree()), domain_(*storedDomain(*sample.object)) {}
  virtual ~Change() = default;

  MaskTree::Ptr apply(Interrupter* interrupter) const {
    MaskBlocks blocks(domain_.dim());
    detail::parallelFor(blocks.count(), 1, interrupter, [&](size_t begin, size_t end) {
      for (size_t block = begin; block < end; ++block) {
        const FloatBox field = height(blocks.box(block));
        size_t i = 0;
        for (auto p = field.box.begin(); p; ++p, ++i)
          if (field.values[i] >= 0) blocks.node(block).touchLeaf(*p)->setValueOn(*p);
      }
    });
    return blocks.takeTree();
  }

 protected:
  /// The object is where this is not negative.
  virtual FloatBox height(const CoordBBox& box) const = 0;

  FloatBox indicatorIn(CoordBBox box, int margin) const {
    box.expand(margin);
    return indicator(object_, domain_, box);
  }

 private:
  const MaskTree& object_;
  CoordBBox domain_;
};

class SurfaceChange : public Change {
 public:
  SurfaceChange(const Sample& sample, const ScanOptions& options)
      : Change(sample),
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

class GrayChange : public Change {
 public:
  GrayChange(const Sample& sample, const ScanOptions& options)
      : Change(sample),
        kernel_(options.blur == 0 ? std::vector<float>{1} : detail::gaussianKernel(options.blur)),
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

Sample changed(const Sample& sample, const Change& change, int reach, Interrupter* interrupter) {
  Sample result;
  result.object = MaskGrid::create(change.apply(interrupter));
  if (sample.truth)
    result.truth = Int32Grid::create(
        detail::carriedLabels(sample.truth->tree(), result.object->tree(), reach, interrupter));
  return result;
}

void describe(Sample& sample, const Coord& size, const detail::SourceText& source) {
  detail::describe(*sample.object, "object", size, source);
  if (sample.truth) detail::describe(*sample.truth, "truth", size, source);
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
  const Coord size = storedDomain(*sample.object)->dim();
  auto source = detail::SourceText::of(*sample.object);
  Sample result = sample;
  if (options.surface > 0) {
    const SurfaceChange change(result, options);
    result = changed(result, change, change.reach(), interrupter);
    describe(result, size, source.range("surface", options.surface, options.surfaceLength));
  }
  if (options.blur > 0 || options.noise > 0) {
    result = changed(result, GrayChange(result, options), kNoiseReach, interrupter);
    source.add("scan-noise", detail::shortestDecimal(options.blur) + ":" +
                                 detail::shortestDecimal(options.noise) + ":" +
                                 detail::shortestDecimal(options.noiseLength));
    describe(result, size, source);
  }
  return result;
}

}  // namespace vdb_madf
