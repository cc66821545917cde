// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/bed.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/samples/detail/ball_sample.h"
#include "vdb_madf/samples/detail/bodies.h"
#include "vdb_madf/samples/detail/mask_blocks.h"
#include "vdb_madf/samples/detail/object_change.h"
#include "vdb_madf/samples/detail/placement.h"
#include "vdb_madf/samples/detail/sample_options.h"

namespace vdb_madf {

namespace {

using detail::Ball;
using detail::FloatBox;

constexpr double kSigma = 2;
constexpr int kLevels = 1 << 16;

/// One round of sintering.
class Sintering : public detail::ObjectChange {
 public:
  Sintering(const Sample& sample, Interrupter* interrupter)
      : ObjectChange(sample), kernel_(detail::gaussianKernel(kSigma)) {
    level_ = float(volumeKeepingLevel(interrupter)) / kLevels;
  }

  /// No new voxel is farther than this from the old object.
  int reach() const { return 2 * detail::kernelRadius(kernel_); }

  FloatBox height(const CoordBBox& box) const override {
    FloatBox field = blurredIn(box);
    for (float& value : field.values) value -= level_;
    return field;
  }

 private:
  FloatBox blurredIn(const CoordBBox& box) const {
    return detail::blurred(indicatorIn(box, detail::kernelRadius(kernel_)), kernel_, nullptr);
  }

  /// The lowest level, in steps from 1 on, that no more voxels reach than the object has.
  int volumeKeepingLevel(Interrupter* interrupter) const {
    const detail::MaskBlocks blocks(domain().dim());
    detail::PerThread<std::vector<int64_t>> counts{std::vector<int64_t>(kLevels + 1, 0)};
    detail::parallelFor(blocks.count(), 1, interrupter, [&](size_t begin, size_t end) {
      std::vector<int64_t>& count = counts.local();
      for (size_t block = begin; block < end; ++block)
        for (const float value : blurredIn(blocks.box(block)).values)
          ++count[size_t(std::clamp(int(value * kLevels), 0, kLevels))];
    });
    const auto voxels = int64_t(object().activeVoxelCount());
    int64_t reached = 0;
    for (int level = kLevels; level > 0; --level) {
      for (const std::vector<int64_t>& count : counts) reached += count[size_t(level)];
      if (reached > voxels) return level + 1;
    }
    return 1;
  }

  std::vector<float> kernel_;
  float level_;
};

/// The object as the last round of sintering made it.
class SinteredBed : public detail::Bodies {
 public:
  SinteredBed(const Sample& before, Interrupter* interrupter)
      : before_{before.object, nullptr}, sintering_(before_, interrupter) {}

  const Sintering& sintering() const { return sintering_; }

  FloatBox shares(const CoordBBox& box) const override {
    CoordBBox grown = box;
    grown.expand(1);
    return detail::sharesAbove(sintering_.height(grown), 0);
  }

 private:
  Sample before_;
  Sintering sintering_;
};

}  // namespace

Sample generateBed(const BedOptions& options, Interrupter* interrupter) {
  detail::checkSize(options.size);
  detail::checkRadii(options.minRadius, options.maxRadius);
  detail::checkRange("rounds", options.rounds, 0, 1000);

  std::vector<Ball> balls = detail::dropBalls(options, interrupter);
  detail::sortByCenter(balls);
  detail::SourceText source("bed");
  source.size(options.size)
      .range("radius", options.minRadius, options.maxRadius)
      .add("rounds", std::to_string(options.rounds))
      .add("seed", std::to_string(options.seed));
  Sample sample = detail::described(detail::ballSample(balls, options.size, {}, interrupter),
                                    options.size, source);
  for (int round = 0; round < options.rounds; ++round) {
    const auto bed = std::make_shared<SinteredBed>(sample, interrupter);
    const Sintering& sintering = bed->sintering();
    sample = detail::described(detail::changed(sample, sintering, sintering.reach(), interrupter),
                               options.size, source);
    sample.bodies = bed;
  }
  return sample;
}

}  // namespace vdb_madf
