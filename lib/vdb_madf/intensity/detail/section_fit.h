// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <Eigen/Dense>
#include <vector>

namespace vdb_madf::detail {

/// The least section of two grains, of the areas of blurred sections across their bond.
///
/// The area at height z is taken as a + b k(z - s) + c (z - s) + d (z - s)^2 with
/// k(z) = |z| beyond t and z^2 / 2t + t / 2 within: of two balls t is 0, a fillet rounds the neck.
/// The blurred model is fitted by least squares for each shift s and rounding t of a grid, with the
/// covariance of neighboring sections; what it leaves is added to it, sharpened once (van Cittert).
/// The result is the mean over all s and t by their likelihood, with 1/2 for t = 0 beforehand.
///
/// Grains whose tips are a gap g apart have sections b (z - s - g/2) + d (z - s - g/2)^2 above and
/// with another b, and -z, below; none within the gap. The gap is the mean over all s and g
/// likewise. Where g is below 0 the curves meet above 0: there is a neck.
class SectionFit {
 public:
  /// Sections are taken with a Gaussian weight of this deviation along the normal.
  static constexpr double kThickness = 0.6;
  static constexpr int kSections = 21;
  static constexpr double kStep = 0.5;  ///< from one to the next, voxels
  static constexpr double kReach = 5;   ///< height of the last one

  static constexpr double height(int section) { return section * kStep - kReach; }

  using Sections = Eigen::Matrix<double, kSections, 1>;
  struct Area {
    double value, error;  ///< voxel faces; below 0: so much is missing, there is a gap
  };

  explicit SectionFit(double blur);

  /// @param variance of a section's area by noise
  Area leastArea(const Sections& sections, double variance) const;

  /// Width of the gap, voxels; below 0: there is none. Between -1 and 3.
  double gap(const Sections& sections, double variance) const;

 private:
  static constexpr int kTerms = 4;
  using Basis = Eigen::Matrix<double, kSections, kTerms>;
  struct Model {
    double rounding, shift;
    Basis basis, whitened;
    Eigen::Matrix<double, kTerms, kSections> inverse;  ///< of `whitened`
  };
  struct GapModel {
    double gap;
    Eigen::Matrix<double, kSections, 3> whitened;
    Eigen::Matrix<double, 3, kSections> inverse;
  };
  double leastOf(const Model& model, const Eigen::Matrix<double, kTerms, 1>& terms,
                 const Sections& sections) const;

  Eigen::Matrix<double, kSections, kSections> whitening_, blurring_;
  std::vector<Model> models_;
  std::vector<GapModel> gapModels_;
};

}  // namespace vdb_madf::detail
