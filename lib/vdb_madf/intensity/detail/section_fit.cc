// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/detail/section_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vdb_madf::detail {

namespace {

constexpr double kRoundings[] = {0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 1.75, 2, 2.5, 3, 3.5, 4};
constexpr double kLastShift = 1.25, kShiftStep = 0.25;
constexpr double kLeastGap = -1, kMostGap = 3, kGapStep = 0.05, kGapShiftStep = 0.125;
/// Before the sections are seen.
constexpr double kCuspShare = 0.5;
/// What is uncertain of a section besides its noise, as a share of the noise's variance.
constexpr double kUncorrelated = 0.05;
constexpr double kLeastVariance = 0.1;  // voxel faces squared: the voxels' own grain
constexpr int kQuadrature = 200;        // steps over five deviations to either side

double rounded(double z, double rounding) {
  const double distance = std::abs(z);
  return distance >= rounding ? distance : z * z / (2 * rounding) + rounding / 2;
}

/// Takes sections to the terms that fit them best.
template <int kRows, int kColumns>
Eigen::Matrix<double, kColumns, kRows> inverseOf(
    const Eigen::Matrix<double, kRows, kColumns>& whitened) {
  return (whitened.transpose() * whitened).ldlt().solve(whitened.transpose());
}

}  // namespace

SectionFit::SectionFit(double blur) {
  const double deviation = std::hypot(blur, kThickness);
  Eigen::Matrix<double, kSections, kSections> covariance;
  for (int i = 0; i < kSections; ++i)
    for (int j = 0; j < kSections; ++j) {
      const double d = (i - j) * kStep;
      covariance(i, j) = std::exp(-d * d / (4 * kThickness * kThickness));
      blurring_(i, j) = std::exp(-d * d / (2 * deviation * deviation));
    }
  covariance.diagonal().array() += kUncorrelated;
  for (int i = 0; i < kSections; ++i) blurring_.row(i) /= blurring_.row(i).sum();
  whitening_ = covariance.llt().matrixL().solve(decltype(covariance)::Identity());
  std::vector<double> places, weights;
  double total = 0;
  for (int i = 0; i <= kQuadrature; ++i) {
    const double place = 10.0 * i / kQuadrature - 5;
    places.push_back(deviation * place);
    weights.push_back(std::exp(-0.5 * place * place));
    total += weights.back();
  }
  // The mean of f around a height, by the blur.
  const auto blurred = [&](double z, const auto& f) {
    double sum = 0;
    for (size_t i = 0; i < places.size(); ++i) sum += weights[i] * f(z + places[i]);
    return sum / total;
  };
  for (const double rounding : kRoundings)
    for (double shift = -kLastShift; shift <= kLastShift; shift += kShiftStep) {
      Model model{rounding, shift, {}, {}, {}};
      for (int i = 0; i < kSections; ++i) {
        const double z = height(i) - shift;
        const double arms = blurred(z, [&](double h) { return rounded(h, rounding); });
        model.basis.row(i) << 1, arms, z, z * z + deviation * deviation;
      }
      model.whitened = whitening_ * model.basis;
      model.inverse = inverseOf(model.whitened);
      models_.push_back(model);
    }
  for (int step = 0; kLeastGap + step * kGapStep <= kMostGap; ++step)
    for (double shift = -kLastShift; shift <= kLastShift; shift += kGapShiftStep) {
      GapModel model{kLeastGap + step * kGapStep, {}, {}};
      const auto arm = [&](double h) {
        const double beyond = std::abs(h) - model.gap / 2;
        return model.gap > 0 ? std::max(0.0, beyond) : beyond;
      };
      for (int i = 0; i < kSections; ++i) {
        const double z = height(i) - shift;
        model.whitened.row(i) << blurred(z, [&](double h) { return h > 0 ? arm(h) : 0; }),
            blurred(z, [&](double h) { return h > 0 ? 0 : arm(h); }),
            blurred(z, [&](double h) { return arm(h) * arm(h); });
      }
      model.whitened = whitening_ * model.whitened;
      model.inverse = inverseOf(model.whitened);
      gapModels_.push_back(model);
    }
}

double SectionFit::leastOf(const Model& model, const Eigen::Matrix<double, kTerms, 1>& terms,
                           const Sections& sections) const {
  const Sections left = sections - model.basis * terms;
  const Sections sharper = 2 * left - blurring_ * left;
  double least = std::numeric_limits<double>::infinity();
  constexpr double kFirst = -2, kLast = 2, kFine = 0.05;
  for (int i = 0; kFirst + i * kFine <= kLast; ++i) {
    const double z = kFirst + i * kFine, h = z - model.shift;
    const double place = (z + kReach) / kStep;
    const int before = std::min(int(place), kSections - 2);
    const double between = place - before;
    least = std::min(least, terms[0] + terms[1] * rounded(h, model.rounding) + terms[2] * h +
                                terms[3] * h * h + (1 - between) * sharper[before] +
                                between * sharper[before + 1]);
  }
  return least;
}

SectionFit::Area SectionFit::leastArea(const Sections& sections, double variance) const {
  variance = std::max(variance, kLeastVariance);
  const Sections whitened = whitening_ * sections;
  std::vector<double> misfits;
  double least = std::numeric_limits<double>::infinity();
  for (const Model& model : models_) {
    const Eigen::Matrix<double, kTerms, 1> terms = model.inverse * whitened;
    // Sections that shrink away from the bond show no neck.
    const double misfit = terms[1] > 0
                              ? (whitened - model.whitened * terms).squaredNorm() / variance
                              : std::numeric_limits<double>::infinity();
    misfits.push_back(misfit);
    least = std::min(least, misfit);
  }
  // No narrow place at all: the section at the bond is as good as any.
  if (std::isinf(least)) return {sections[kSections / 2], std::sqrt(variance)};
  // Where no model fits within the noise, all errors are larger by as much.
  constexpr int kFree = kSections - kTerms - 2;
  const double excess = std::max(1.0, least / kFree);
  const double roundShare = (1 - kCuspShare) / (std::size(kRoundings) - 1);
  double sum = 0, areas = 0, squares = 0;
  for (size_t i = 0; i < models_.size(); ++i) {
    const Model& model = models_[i];
    const double weight = (model.rounding == 0 ? kCuspShare : roundShare) *
                          std::exp(-0.5 * (misfits[i] - least) / excess);
    if (weight < 1e-6) continue;
    const double area = leastOf(model, model.inverse * whitened, sections);
    sum += weight;
    areas += weight * area;
    squares += weight * (area * area + excess * variance * model.inverse.row(0).squaredNorm());
  }
  const double mean = areas / sum;
  return {mean, std::sqrt(std::max(0.0, squares / sum - mean * mean))};
}

double SectionFit::gap(const Sections& sections, double variance) const {
  const Sections whitened = whitening_ * sections;
  constexpr int kFree = kSections - 3 - 2;
  std::vector<double> misfits;
  double least = std::numeric_limits<double>::infinity();
  for (const GapModel& model : gapModels_) {
    const Eigen::Vector3d terms = model.inverse * whitened;
    misfits.push_back(terms[0] > 0 && terms[1] > 0
                          ? (whitened - model.whitened * terms).squaredNorm()
                          : std::numeric_limits<double>::infinity());
    least = std::min(least, misfits.back());
  }
  if (std::isinf(least)) return 0;
  const double spread = std::max(std::max(variance, kLeastVariance), least / kFree);
  double sum = 0, gaps = 0;
  for (size_t i = 0; i < misfits.size(); ++i) {
    const double weight = std::exp(-0.5 * (misfits[i] - least) / spread);
    sum += weight;
    gaps += weight * gapModels_[i].gap;
  }
  return gaps / sum;
}

}  // namespace vdb_madf::detail
