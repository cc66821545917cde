// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/snow.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/samples/detail/gaussian_blur.h"
#include "vdb_madf/samples/detail/mask_blocks.h"
#include "vdb_madf/samples/detail/sample_options.h"
#include "vdb_madf/samples/detail/white_noise.h"

namespace vdb_madf {

namespace {

using detail::FloatBox;
using detail::MaskBlocks;

/// The field is so smooth that it is made on every n-th voxel only, its Gaussian's sigma at least
/// this many lattice steps, and interpolated by cubic splines: of the peak wavelength, 0.01 % of
/// the amplitude turns up at others.
constexpr double kSigmaSteps = 2.5;

/// Shorter waves are not resolved by voxels.
constexpr double kMinLength = 4;

/// White noise under the filter -Laplace(Gaussian of this sigma) has the spectrum k^4 exp(-k^2
/// sigma^2) with its peak at k^2 = 2 / sigma^2. On a lattice of step 1 the sum of differences falls
/// short of the Laplacian by the factor 1 - k^2/20, averaged over the directions, and the spline
/// blurs with variance 1/3: the peak stays at k = 2 pi / length if sigma^2 = 2 / k^2 - 1/10 - 1/3.
double gaussianSigma(double length) {
  const double k = 2 * M_PI / length;
  return std::sqrt(2 / (k * k) - (1.0 / 10 + 1.0 / 3));
}

int latticeStep(double length) {
  return std::max(1, int(gaussianSigma(length) / kSigmaSteps));
}

/// Gaussian random field at the voxels of [0, size - 1], in blocks of one leaf.
class RandomField {
 public:
  RandomField(const SnowOptions& options, Interrupter* interrupter)
      : step_(latticeStep(options.length)), field_(makeLattice(options, interrupter)) {
    // The uniform cubic B-spline: the weights of four lattice values, at each of the voxels between
    // the middle two.
    for (int i = 0; i < step_; ++i) {
      const float t = float(i) / float(step_), u = 1 - t;
      weights_.push_back({u * u * u / 6, (t * t * (3 * t - 6) + 4) / 6,
                          (u * u * (3 * u - 6) + 4) / 6, t * t * t / 6});
    }
  }

  /// Values of the leaf at x*64 + y*8 + z, also beyond the box.
  void evaluate(const Coord& leaf, float* values) const {
    const Coord lower(leaf.x() / step_ - 1, leaf.y() / step_ - 1, leaf.z() / step_ - 1);
    const Coord count((leaf.x() + 7) / step_ + 3 - lower.x(),
                      (leaf.y() + 7) / step_ + 3 - lower.y(), 0);
    float alongZ[kMaxPatch][kMaxPatch][8];
    for (int x = 0; x < count.x(); ++x)
      for (int y = 0; y < count.y(); ++y) {
        const float* row =
            field_.values.data() + field_.offset(lower.x() + x, lower.y() + y, lower.z());
        for (int z = 0; z < 8; ++z) {
          const Weights& w = weights_[(leaf.z() + z) % step_];
          const float* at = row + ((leaf.z() + z) / step_ - 1 - lower.z());
          alongZ[x][y][z] = w.at[0] * at[0] + w.at[1] * at[1] + w.at[2] * at[2] + w.at[3] * at[3];
        }
      }
    float alongY[kMaxPatch][8][8];
    for (int x = 0; x < count.x(); ++x)
      for (int y = 0; y < 8; ++y) {
        const Weights& w = weights_[(leaf.y() + y) % step_];
        const auto* at = &alongZ[x][(leaf.y() + y) / step_ - 1 - lower.y()];
        for (int z = 0; z < 8; ++z)
          alongY[x][y][z] =
              w.at[0] * at[0][z] + w.at[1] * at[1][z] + w.at[2] * at[2][z] + w.at[3] * at[3][z];
      }
    for (int x = 0; x < 8; ++x) {
      const Weights& w = weights_[(leaf.x() + x) % step_];
      const auto* at = &alongY[(leaf.x() + x) / step_ - 1 - lower.x()];
      for (int y = 0; y < 8; ++y)
        for (int z = 0; z < 8; ++z)
          *values++ = w.at[0] * at[0][y][z] + w.at[1] * at[1][y][z] + w.at[2] * at[2][y][z] +
                      w.at[3] * at[3][y][z];
    }
  }

 private:
  struct Weights {
    float at[4];
  };
  /// Lattice points that a leaf needs along an axis at most: its 8 (step 1), one before, two
  /// after.
  static constexpr int kMaxPatch = 11;

  FloatBox makeLattice(const SnowOptions& options, Interrupter* interrupter) const {
    // Up to the end of the last leaf, and two points beyond for the cubics.
    const Coord last = (options.size.offsetBy(-1) & ~7).offsetBy(7);
    const CoordBBox lattice(
        Coord(-1), Coord(last.x() / step_ + 2, last.y() / step_ + 2, last.z() / step_ + 2));
    const auto kernel = detail::gaussianKernel(gaussianSigma(options.length / step_));
    CoordBBox noiseBox = lattice;
    noiseBox.expand(detail::kernelRadius(kernel) + 1);
    const FloatBox smooth = detail::blurred(
        detail::whiteNoise(noiseBox, options.seed, 0, interrupter), kernel, interrupter);

    // The one layer around the lattice that is left serves the differences.
    FloatBox field(lattice);
    const ptrdiff_t sx = ptrdiff_t(smooth.box.dim().y()) * smooth.box.dim().z();
    const ptrdiff_t sy = smooth.box.dim().z();
    detail::parallelFor(size_t(lattice.dim().x()), 1, interrupter, [&](size_t begin, size_t end) {
      for (int x = int(begin) - 1; x < int(end) - 1; ++x)
        for (int y = lattice.min().y(); y <= lattice.max().y(); ++y) {
          const float* in = smooth.values.data() + smooth.offset(x, y, lattice.min().z());
          float* out = field.values.data() + field.offset(x, y, lattice.min().z());
          for (int z = 0; z < lattice.dim().z(); ++z)
            out[z] = 6 * in[z] - (in[z - sx] + in[z + sx]) - (in[z - sy] + in[z + sy]) -
                     (in[z - 1] + in[z + 1]);
        }
    });
    return field;
  }

  int step_;
  FloatBox field_;
  std::vector<Weights> weights_;
};

/// Maps floats to 16 bits without changing their order: sign, exponent and the first 7 bits of the
/// fraction.
uint32_t orderedBits(float value) {
  uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return (bits & 0x80000000u ? ~bits : bits | 0x80000000u) >> 16;
}

/// Clips [0, 8) from a leaf's corner to the box.
Coord leafExtent(const Coord& leaf, const CoordBBox& box) {
  return Coord::minComponent(box.max() - leaf, Coord(7)).offsetBy(1);
}

class SnowBuilder {
 public:
  SnowBuilder(const SnowOptions& options, Interrupter* interrupter)
      : options_(options),
        interrupter_(interrupter),
        field_(options, interrupter),
        blocks_(options.size) {}

  MaskTree::Ptr build() {
    const uint32_t cut = findCut();
    detail::parallelForEach(blocks_.count(), 1, interrupter_,
                            [&](size_t block) { fillBlock(block, cut); });
    return blocks_.takeTree();
  }

 private:
  /// The ordered bits from which on values are ice, by a histogram over all voxels. A bin is 1/128
  /// of the threshold wide at most, 0.2 % of the voxels: the nearer of its edges is within 0.1 %.
  uint32_t findCut() const {
    std::vector<std::atomic<int64_t>> histogram(1 << 16);
    detail::parallelFor(blocks_.count(), 1, interrupter_, [&](size_t begin, size_t end) {
      std::vector<int64_t> local(histogram.size());
      float values[512];
      for (size_t block = begin; block < end; ++block) {
        const CoordBBox box = blocks_.box(block);
        detail::forEachLeafOrigin(box, [&](const Coord& leaf) {
          field_.evaluate(leaf, values);
          const Coord extent = leafExtent(leaf, box);
          for (int x = 0; x < extent.x(); ++x)
            for (int y = 0; y < extent.y(); ++y)
              for (int z = 0; z < extent.z(); ++z) ++local[orderedBits(values[x * 64 + y * 8 + z])];
        });
      }
      for (size_t i = 0; i < local.size(); ++i)
        if (local[i]) histogram[i] += local[i];
    });

    const double goal =
        options_.fraction * options_.size.x() * options_.size.y() * double(options_.size.z());
    int64_t above = 0;
    for (size_t i = histogram.size(); i-- > 0;) {
      const int64_t with = above + histogram[i];
      if (double(with) >= goal)
        return double(with) - goal <= goal - double(above) ? uint32_t(i) : uint32_t(i + 1);
      above = with;
    }
    return 0;
  }

  void fillBlock(size_t block, uint32_t cut) {
    const CoordBBox box = blocks_.box(block);
    float values[512];
    detail::forEachLeafOrigin(box, [&](const Coord& leaf) {
      field_.evaluate(leaf, values);
      const Coord extent = leafExtent(leaf, box);
      uint64_t words[8] = {};
      uint64_t any = 0, all = ~uint64_t(0);
      for (int x = 0; x < 8; ++x) {
        for (int y = 0; y < extent.y() && x < extent.x(); ++y)
          for (int z = 0; z < extent.z(); ++z)
            words[x] |= uint64_t(orderedBits(values[x * 64 + y * 8 + z]) >= cut) << (y * 8 + z);
        any |= words[x];
        all &= words[x];
      }
      if (any == 0) return;
      MaskBlocks::Node& node = blocks_.node(block);
      if (all == ~uint64_t(0)) return MaskBlocks::makeTile(node, leaf);
      auto& mask = node.touchLeaf(leaf)->getValueMask();
      for (int x = 0; x < 8; ++x) mask.getWord<uint64_t>(x) = words[x];
    });
  }

  SnowOptions options_;
  Interrupter* interrupter_;
  RandomField field_;
  MaskBlocks blocks_;
};

}  // namespace

Sample generateSnow(const SnowOptions& options, Interrupter* interrupter) {
  detail::checkSize(options.size);
  detail::checkFraction(options.fraction);
  detail::checkRange("length", options.length, kMinLength, kMaxExtent);

  detail::SourceText source("snow");
  source.size(options.size)
      .add("fraction", options.fraction)
      .add("length", options.length)
      .add("seed", std::to_string(options.seed));
  const auto object = MaskGrid::create(SnowBuilder(options, interrupter).build());
  return detail::described({object, nullptr}, options.size, source);
}

}  // namespace vdb_madf
