// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/fit_curvature.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace vdb_madf::detail {

namespace {

constexpr double kReach = 5;          // mean edges of a voxel along the tangent plane
constexpr double kWithin = 1 + 1e-9;  // its square: ties, of which there are many, are in reach
constexpr double kRange = 5.5;      // likewise in space: of a ball of radius 7 all that is in reach
constexpr int kMaxPoints = 32;      // of one interface: time, not memory
constexpr int kMinFaces = 10;       // for the six coefficients
constexpr double kSingular = 1e-5;  // least pivot of the scaled normal equations, of the largest
constexpr int kMaxRounds = 10;
constexpr double kSettled = 1e-3;     // change of the curvatures, 1 / kReach
constexpr double kSteepest = 3. / 4;  // squared sine of the slope that a round surface may have

Eigen::Vector3d center(const InterfaceFace& face) {
  Eigen::Vector3d point(face.lower.x(), face.lower.y(), face.lower.z());
  point[face.axis] += 0.5;
  return point;
}

Eigen::Vector3d toEigen(const openvdb::Vec3d& v) {
  return {v[0], v[1], v[2]};
}

struct Jet {
  double mean, gaussian;
  double squares, weights;  ///< of the residuals
};

using Shape = Eigen::Matrix2d;  ///< second derivatives of the height
using Terms = Eigen::Matrix<double, 6, 1>;

/// How much deeper than a paraboloid a round surface lies at (a, b): a ball or cylinder of
/// curvature k is 1 - sqrt(1 - s^2) deep in units of 1/k, where s = k |(a, b)|, and the paraboloid
/// s^2 / 2.
double roundness(const Shape& shape, double a, double b) {
  const double slope = std::min((shape * Eigen::Vector2d(a, b)).squaredNorm(), kSteepest);
  return 2 / (1 + std::sqrt(1 - slope));
}

/// Faces in reach of one, relative to it and in units of the reach.
class Fit {
 public:
  explicit Fit(const VoxelShape& voxel)
      : edges_(toEigen(voxel.edges)),
        faceAreas_(voxel.faceArea(0), voxel.faceArea(1), voxel.faceArea(2)),
        reach_(kReach * voxel.meanEdge()),
        range_(kRange * voxel.meanEdge()) {}

  std::optional<Jet> operator()(const std::vector<InterfaceFace>& faces, size_t at) {
    gather(faces, at);
    if (!(normals_.norm() > 0)) return std::nullopt;
    makeRows(normals_.normalized());
    if (rows_.size() < size_t(kMinFaces)) return std::nullopt;
    // The first round fits a paraboloid; each other one is as deep as the curvatures before say.
    Shape shape = Shape::Zero();
    for (int round = 0; round < kMaxRounds; ++round) {
      if (!solve(shape)) return std::nullopt;
      Shape next;
      next << 2 * solution_[3], solution_[4], solution_[4], 2 * solution_[5];
      const double change = (next - shape).norm();
      shape = next;
      if (change < kSettled) break;
    }
    return jetOf(shape);
  }

 private:
  struct Point {
    Eigen::Vector3d position;
    int axis, sign;
  };
  struct Row {
    double a, b, height, weight;
    Terms terms = Terms::Zero();
  };

  void makeRows(const Eigen::Vector3d& normal) {
    const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
    rows_.clear();
    for (const Point& point : points_) {
      Row row;
      // Faces weigh by their area, and those of a sheet that folds back nothing.
      row.weight = normal[point.axis] * point.sign * faceAreas_[point.axis];
      row.a = point.position.dot(u);
      row.b = point.position.dot(v);
      // Distance counts along the plane: to leave out the deeper ones at the rim would flatten the
      // fit.
      if (row.weight <= 0 || row.a * row.a + row.b * row.b > kWithin) continue;
      row.height = point.position.dot(normal);
      rows_.push_back(row);
    }
  }

  bool solve(const Shape& shape) {
    Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
    Terms right = Terms::Zero();
    for (Row& row : rows_) {
      const double a = row.a, b = row.b, deeper = roundness(shape, a, b);
      row.terms << 1, a, b, deeper * a * a, deeper * a * b, deeper * b * b;
      matrix.noalias() += row.weight * row.terms * row.terms.transpose();
      right.noalias() += row.weight * row.height * row.terms;
    }
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(matrix);
    const auto pivots = solver.vectorD();
    if (!(pivots.minCoeff() > kSingular * pivots.maxCoeff())) return false;
    solution_ = solver.solve(right);
    return true;
  }

  Jet jetOf(const Shape& shape) const {
    const double hu = solution_[1], hv = solution_[2];
    const double huu = shape(0, 0), huv = shape(0, 1), hvv = shape(1, 1);
    const double metric = 1 + hu * hu + hv * hv;
    Jet jet;
    jet.mean = -((1 + hv * hv) * huu - 2 * hu * hv * huv + (1 + hu * hu) * hvv) /
               (2 * metric * std::sqrt(metric) * reach_);
    jet.gaussian = (huu * hvv - huv * huv) / (metric * metric * reach_ * reach_);
    jet.squares = jet.weights = 0;
    for (const Row& row : rows_) {
      const double miss = reach_ * (row.height - solution_.dot(row.terms));
      jet.squares += row.weight * miss * miss;
      jet.weights += row.weight;
    }
    return jet;
  }

  void gather(const std::vector<InterfaceFace>& faces, size_t at) {
    points_.clear();
    normals_.setZero();
    const Eigen::Vector3d here = center(faces[at]);
    const double alongX = range_ / edges_.x();
    const auto first =
        std::lower_bound(faces.begin(), faces.end(), int(std::floor(here.x() - alongX)) - 1,
                         [](const InterfaceFace& face, int x) { return face.lower.x() < x; });
    for (auto face = first; face != faces.end() && face->lower.x() <= here.x() + alongX; ++face) {
      const Eigen::Vector3d offset = (center(*face) - here).cwiseProduct(edges_);
      if (offset.squaredNorm() > range_ * range_) continue;
      points_.push_back({offset / reach_, face->axis, face->sign});
      normals_[face->axis] += face->sign * faceAreas_[face->axis];
    }
  }

  Eigen::Vector3d edges_, faceAreas_;  // of a voxel, and of its faces across each axis
  double reach_, range_;
  std::vector<Point> points_;
  std::vector<Row> rows_;
  Eigen::Vector3d normals_;
  Terms solution_;
};

double deviation(double sum, double squares, double count) {
  const double mean = sum / count;
  return std::sqrt(std::max(0.0, squares / count - mean * mean));
}

}  // namespace

std::optional<InterfaceCurvature> fitCurvature(const std::vector<InterfaceFace>& faces,
                                               const VoxelShape& voxel) {
  const size_t count = std::min(faces.size(), size_t(kMaxPoints));
  InterfaceCurvature result;
  double mean = 0, meanSquares = 0, gaussian = 0, gaussianSquares = 0, squares = 0, weights = 0;
  Fit fit(voxel);
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
