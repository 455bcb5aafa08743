// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/mrcal/uncertainty_comparison.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/mrcal/mrcal_comparison.h"
#include "calib/mrcal/mrcal_parameters.h"
#include "calib/mrcal/mrcal_uncertainty.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig.h"
#include "calib/rig_and_boards.h"
#include "calib/solver/refined_minimum.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"
#include "calib/uncertainty/joint_information.h"

namespace vernier::internal {
namespace {

constexpr double distances_m[] = {0.5, 1, 5, 20, std::numeric_limits<double>::infinity()};

/// A grid from 5 to 95 % of the image, without pixels that have no ray.
std::vector<Eigen::Vector3d> rays(const Camera& camera) {
  std::vector<Eigen::Vector3d> found;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 7; ++column) {
      const Eigen::Vector2d share(0.05 + 0.15 * column, 0.05 + 0.225 * row);
      const Eigen::Vector2d pixel = share.cwiseProduct(camera.size_px.cast<double>());
      if (const auto ray = try_unproject(camera, pixel)) found.push_back(ray->normalized());
    }
  }
  return found;
}

/// Pixel pairs of points in front of the rig that both cameras see.
std::vector<PixelPair> pairs_of(const Rig& rig, int other) {
  std::vector<PixelPair> pairs;
  for (const double z : {0.7, 1.5, 4.0, 15.0}) {
    for (const Eigen::Vector2d& at : {Eigen::Vector2d(0, 0), {0.2, 0.15}, {-0.25, -0.1}}) {
      const auto pair = pixel_pair(rig, {z * at.x(), z * at.y(), z}, other);
      if (!pair || !in_image(rig.cameras[0], pair->first_px)) continue;
      if (in_image(rig.cameras[other], pair->other_px)) pairs.push_back(*pair);
    }
  }
  return pairs;
}

void add_queries(const Rig& rig, MrcalUncertaintyProblem& problem) {
  const auto cameras = static_cast<int>(rig.cameras.size());
  for (int c = 0; c < cameras; ++c) {
    for (const double distance : distances_m) {
      MrcalProjectionQuery query{c, std::isinf(distance), rays(rig.cameras[c])};
      for (Eigen::Vector3d& point : query.points) point *= query.at_infinity ? 1 : distance;
      problem.projection.push_back(std::move(query));
    }
    if (c == 0) continue;
    const std::vector<PixelPair> pairs = pairs_of(rig, c);
    if (pairs.empty()) continue;
    problem.triangulation.push_back({c, false, pairs});
    problem.triangulation.push_back({c, true, pairs});
  }
}

/// A basis of the free directions for mrcal, or std::nullopt if its own factorisation is accurate
/// enough. It loses as many digits as the condition of the scaled JᵀJ; if too many, the basis is in
/// standard deviations along the principal directions of our bound, which affects only the
/// rounding.
std::optional<Eigen::MatrixXd> basis_of(const RefinedMinimum& ours, const std::vector<bool>& held) {
  constexpr double greatest_condition = 1e8;
  const MrcalLift lift = mrcal_lift(ours.state.rig, held);
  const auto free = lift.L.cols();
  const Eigen::MatrixXd G = mrcal_by_tangent(ours.state.rig);
  const Eigen::MatrixXd C = G * ours.unit_bound * G.transpose();
  const Eigen::VectorXd sd = C.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = (sd.array() > 0).select(sd.cwiseInverse(), 0);
  const SymmetricEigen scaled(inverse.asDiagonal() * C * inverse.asDiagonal());
  const Eigen::VectorXd s = scaled.eigenvalues().tail(free);  // ascending; the held ones are zero
  if (s[0] > 0 && s[free - 1] < greatest_condition * s[0]) {
    return lift.native ? std::nullopt : std::optional(lift.L);
  }
  const double least = 1e-14 * s[free - 1];
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(lift.L.rows(), free);
  basis(lift.shown, Eigen::all) = sd.asDiagonal() * scaled.eigenvectors().rightCols(free) *
                                  s.cwiseMax(least).cwiseSqrt().asDiagonal();
  return basis;
}

/// Rig and boards with the board's shape fixed if it is, as in mrcal here.
RigAndBoards joint_of(const BoardObservations& observations,
                      const RefinedMinimum& ours,
                      double pixel_sigma_px) {
  ConditionalBoardPoses given = conditional_board_poses(observations, ours.state);
  given.warp_by_rig.setZero();
  given.warp_factor.setZero();
  return {ours.state.rig,
          ours.state.frames,
          ours.state.T_first_board,
          pixel_sigma_px * pixel_sigma_px * ours.unit_bound,
          std::make_shared<const ConditionalBoardPoses>(std::move(given)),
          pixel_sigma_px};
}

void compare_projection(const MrcalProjectionQuery& query,
                        const std::vector<Eigen::Matrix2d>& mrcals,
                        const ProjectionUncertainty& ours,
                        UncertaintyComparison& result) {
  for (std::size_t i = 0; i < query.points.size(); ++i) {
    const Eigen::Vector3d& x = query.points[i];
    const Eigen::Matrix2d C =
        query.at_infinity ? ours.covariance_of_direction(x) : ours.covariance_of_point(x);
    const double difference = normalised_difference(C, mrcals[i]).largest;
    ++result.projections;
    if (!is_worse(difference, result.max_projection_covariance_diff)) continue;
    result.max_projection_covariance_diff = difference;
    const Eigen::Vector2d pixel = project(ours.camera(), x);
    result.worst_projection = fmt::format(
        "{}, {}, pixel ({:.0f}, {:.0f})", ours.camera().name,
        query.at_infinity ? "infinity" : fmt::format("{:g} m", x.norm()), pixel.x(), pixel.y());
  }
}

void compare_triangulation(const MrcalTriangulationQuery& query,
                           const MrcalTriangulationAnswer& mrcals,
                           const TriangulationUncertainty& ours,
                           double pixel_sigma_px,
                           UncertaintyComparison& result) {
  const auto keep_largest = [](double difference, double& largest) {
    largest = worse(difference, largest);
  };
  for (std::size_t i = 0; i < query.pairs.size(); ++i) {
    const auto point = ours.at(query.pairs[i], pixel_sigma_px);
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    keep_largest(
        point ? normalised_difference(point->calibration, mrcals.calibration[i]).largest : nothing,
        result.max_triangulation_covariance_diff);
    if (point && !query.stabilised) {
      keep_largest(normalised_difference(point->observation, mrcals.observation[i]).largest,
                   result.max_observation_covariance_diff);
    }
    ++result.triangulations;
  }
}

}  // namespace

UncertaintyComparison compare_uncertainty(const std::filesystem::path& script,
                                          const BoardObservations& observations,
                                          const RefinedMinimum& ours,
                                          double pixel_sigma_px,
                                          const std::vector<bool>& held) {
  MrcalUncertaintyProblem problem{observations,         ours.state, pixel_sigma_px,
                                  basis_of(ours, held), {},         {}};
  add_queries(ours.state.rig, problem);
  const MrcalUncertaintyAnswer mrcals = run_mrcal_uncertainty(script, problem);
  UncertaintyComparison result;
  result.absent = mrcals.absent;
  if (!result.absent.empty()) return result;
  const RigAndBoards joint = joint_of(observations, ours, pixel_sigma_px);
  for (std::size_t q = 0; q < problem.projection.size(); ++q) {
    const MrcalProjectionQuery& query = problem.projection[q];
    compare_projection(query, mrcals.projection[q],
                       ProjectionUncertainty(joint, query.camera, PointFixedTo::boards), result);
  }
  for (std::size_t q = 0; q < problem.triangulation.size(); ++q) {
    const MrcalTriangulationQuery& query = problem.triangulation[q];
    const auto frame = query.stabilised ? TriangulationFrame::stabilised : TriangulationFrame::rig;
    compare_triangulation(query, mrcals.triangulation[q],
                          TriangulationUncertainty(joint, frame, query.other), pixel_sigma_px,
                          result);
  }
  return result;
}

}  // namespace vernier::internal
