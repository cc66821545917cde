// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/fit_curvature.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace vdb_madf::detail {

namespace {

constexpr double kReach = 5;        // voxels: flattens interfaces of a lesser radius
constexpr int kMaxPoints = 32;      // of one interface: time, not memory
constexpr int kMinFaces = 10;       // for the six coefficients
constexpr double kSingular = 1e-5;  // least pivot of the scaled normal equations, of the largest

Eigen::Vector3d center(const InterfaceFace& face) {
  Eigen::Vector3d point(face.lower.x(), face.lower.y(), face.lower.z());
  point[face.axis] += 0.5;
  return point;
}

struct Jet {
  double mean, gaussian;
  double squares, weights;  ///< of the residuals
};

/// Faces in reach of one, relative to it and in units of the reach.
class Fit {
 public:
  std::optional<Jet> operator()(const std::vector<InterfaceFace>& faces, size_t at) {
    gather(faces, at);
    if (points_.size() < size_t(kMinFaces)) return std::nullopt;
    const Eigen::Vector3d normal = normals_.normalized();
    if (!(normals_.norm() > 0)) return std::nullopt;
    const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
    Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    rows_.clear();
    for (const Point& point : points_) {
      // By area, and none of a sheet that folds back.
      const double weight = normal[point.axis] * point.sign;
      if (weight <= 0) continue;
      const double a = point.position.dot(u), b = point.position.dot(v);
      Row row;
      row.terms << 1, a, b, a * a, a * b, b * b;
      row.height = point.position.dot(normal);
      row.weight = weight;
      matrix.noalias() += weight * row.terms * row.terms.transpose();
      right.noalias() += weight * row.height * row.terms;
      rows_.push_back(row);
    }
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(matrix);
    const auto pivots = solver.vectorD();
    if (rows_.size() < size_t(kMinFaces) || !(pivots.minCoeff() > kSingular * pivots.maxCoeff()))
      return std::nullopt;
    const Eigen::Matrix<double, 6, 1> c = solver.solve(right);
    const double hu = c[1], hv = c[2], huu = 2 * c[3], huv = c[4], hvv = 2 * c[5];
    const double metric = 1 + hu * hu + hv * hv;
    Jet jet;
    jet.mean = -((1 + hv * hv) * huu - 2 * hu * hv * huv + (1 + hu * hu) * hvv) /
               (2 * metric * std::sqrt(metric) * kReach);
    jet.gaussian = (huu * hvv - huv * huv) / (metric * metric * kReach * kReach);
    jet.squares = jet.weights = 0;
    for (const Row& row : rows_) {
      const double miss = kReach * (row.height - c.dot(row.terms));
      jet.squares += row.weight * miss * miss;
      jet.weights += row.weight;
    }
    return jet;
  }

 private:
  struct Point {
    Eigen::Vector3d position;
    int axis, sign;
  };
  struct Row {
    Eigen::Matrix<double, 6, 1> terms;
    double height, weight;
  };

  void gather(const std::vector<InterfaceFace>& faces, size_t at) {
    points_.clear();
    normals_.setZero();
    const Eigen::Vector3d here = center(faces[at]);
    const auto first =
        std::lower_bound(faces.begin(), faces.end(), int(std::floor(here.x() - kReach)) - 1,
                         [](const InterfaceFace& face, int x) { return face.lower.x() < x; });
    for (auto face = first; face != faces.end() && face->lower.x() <= here.x() + kReach; ++face) {
      const Eigen::Vector3d offset = center(*face) - here;
      if (offset.squaredNorm() > kReach * kReach) continue;
      points_.push_back({offset / kReach, face->axis, face->sign});
      normals_[face->axis] += face->sign;
    }
  }

  std::vector<Point> points_;
  std::vector<Row> rows_;
  Eigen::Vector3d normals_;
};

double deviation(double sum, double squares, double count) {
  const double mean = sum / count;
  return std::sqrt(std::max(0.0, squares / count - mean * mean));
}

}  // namespace

std::optional<InterfaceCurvature> fitCurvature(const std::vector<InterfaceFace>& faces) {
  const size_t count = std::min(faces.size(), size_t(kMaxPoints));
  InterfaceCurvature result;
  double mean = 0, meanSquares = 0, gaussian = 0, gaussianSquares = 0, squares = 0, weights = 0;
  Fit fit;
  for (size_t i = 0; i < count; ++i) {
    const auto jet = fit(faces, (2 * i + 1) * faces.size() / (2 * count));
    if (!jet) continue;
    ++result.points;
    mean += jet->mean;
    meanSquares += jet->mean * jet->mean;
    gaussian += jet->gaussian;
    gaussianSquares += jet->gaussian * jet->gaussian;
    squares += jet->squares;
    weights += jet->weights;
  }
  if (result.points == 0) return std::nullopt;
  result.mean = mean / result.points;
  result.meanDeviation = deviation(mean, meanSquares, result.points);
  result.gaussian = gaussian / result.points;
  result.gaussianDeviation = deviation(gaussian, gaussianSquares, result.points);
  result.residual = std::sqrt(squares / weights);
  return result;
}

}  // namespace vdb_madf::detail
