// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/trajectory.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/odometry.h"
#include "localise/odometry/estimated_step.h"
#include "localise/odometry/path_covariance.h"
#include "localise/odometry/step_consensus.h"
#include "localise/place.h"

namespace vernier::localise {

namespace {

using internal::EstimatedStep;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

void check_together(std::span<const Pose> estimate, std::span<const Pose> truth) {
  if (estimate.size() == truth.size() && truth.size() >= 2) return;
  throw Error("trajectory",
              "has " + std::to_string(estimate.size()) + " poses, the true one " +
                  std::to_string(truth.size()),
              "give a true pose for each of two or more moments");
}

/// The step between two moments, from corners that look alike nowhere else, or else from those near
/// where `expected` has them. Once found, the step itself says which of those that look alike
/// belong together.
std::optional<EstimatedStep> linked_step(const Rig& rig,
                                         std::span<const StereoCorner> from,
                                         std::span<const StereoCorner> to,
                                         const Pose& expected,
                                         const CornerLinkOptions& linking,
                                         const StepOptions& options) {
  constexpr std::array search_windows_px{8.0, 16.0, 32.0, 64.0};
  constexpr double found_window_px = 4;
  const auto near = [&](const Pose& T_from_to, double window_px) {
    return estimated_step(rig, from, to,
                          link_corners_near(rig, from, to, T_from_to, window_px, linking), options);
  };
  const std::vector<CornerLink> unguided = link_corners(from, to, linking);
  auto found = estimated_step(rig, from, to, unguided, options);
  for (const double window_px : search_windows_px) {
    if (found) break;
    found = near(expected, window_px);
  }
  if (!found) return std::nullopt;
  auto again = near(found->step.T_from_to, found_window_px);
  if (again && again->step.inliers.size() >= found->step.inliers.size()) found = std::move(again);
  found->step.other_motion = internal::other_motion(rig, from, to, unguided, found->step, options);
  return found;
}

}  // namespace

OdometryPath odometry_path(const Rig& rig,
                           std::span<const std::vector<StereoCorner>> moments,
                           const CornerLinkOptions& linking,
                           const StepOptions& options) {
  OdometryPath path;
  path.end_covariance.setZero();
  path.end_by_rig = Eigen::MatrixXd::Zero(6, parameter_count(rig));
  if (moments.empty()) return path;
  path.T_first_camera.push_back({});
  Pose last_motion;
  internal::PathCovariance noise;
  for (std::size_t i = 1; i < moments.size(); ++i) {
    StepOptions of_step = options;
    of_step.step = static_cast<std::uint32_t>(i);
    std::optional<EstimatedStep> found =
        linked_step(rig, moments[i - 1], moments[i], last_motion, linking, of_step);
    const Pose& T = path.T_first_camera.back();
    path.steps.emplace_back();
    if (found) {
      last_motion = found->step.T_from_to;
      const internal::ProductDerivatives d(T, last_motion);
      noise.add(d, found->step.inliers, found->influences);
      path.end_by_rig = d.by_first * path.end_by_rig;
      if (found->step.by_rig.size() > 0) path.end_by_rig += d.by_second * found->step.by_rig;
      path.steps.back() = std::move(found->step);
    }
    path.T_first_camera.push_back(T * last_motion);
  }
  path.end_covariance = noise.covariance();
  const bool whole = std::all_of(path.steps.begin(), path.steps.end(),
                                 [](const auto& step) { return step.has_value(); });
  if (!whole) {
    path.end_covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
    path.end_by_rig.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return path;
}

TrajectoryDrift drift_of(std::span<const Pose> estimate,
                         std::span<const Pose> truth,
                         double segment_m) {
  check_together(estimate, truth);
  if (!(segment_m > 0) || !std::isfinite(segment_m)) {
    throw Error("trajectory", "the length of a segment is not above 0", "give it in metres");
  }
  std::vector<double> along_m{0};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    along_m.push_back(along_m.back() + (truth[i].t - truth[i - 1].t).norm());
  }
  const auto error_between = [&](std::size_t a, std::size_t b) {
    const Pose moved = truth[a].inverse() * truth[b], as_seen = estimate[a].inverse() * estimate[b];
    return moved.inverse() * as_seen;
  };
  TrajectoryDrift drift;
  drift.length_m = along_m.back();
  const Pose end = error_between(0, truth.size() - 1);
  drift.end_error_m = end.t.norm();
  drift.end_error_rad = vector_from_rotation(end.R).norm();
  for (std::size_t a = 0; a < truth.size(); ++a) {
    const auto last = std::lower_bound(along_m.begin(), along_m.end(), along_m[a] + segment_m);
    if (last == along_m.end()) break;
    const auto b = static_cast<std::size_t>(last - along_m.begin());
    const Pose error = error_between(a, b);
    const double length = along_m[b] - along_m[a];
    drift.translation_share += error.t.norm() / length;
    drift.rotation_rad_per_m += vector_from_rotation(error.R).norm() / length;
    ++drift.segments;
  }
  if (drift.segments > 0) {
    drift.translation_share /= drift.segments;
    drift.rotation_rad_per_m /= drift.segments;
  }
  return drift;
}

double step_nees(const MotionStep& step,
                 const Pose& true_T_from_to,
                 const Eigen::MatrixXd& calibration) {
  Vector6d error;
  error << vector_from_rotation(step.T_from_to.R * true_T_from_to.R.transpose()),
      step.T_from_to.t - true_T_from_to.t;
  Matrix6d C = step.covariance;
  if (calibration.size() > 0) {
    if (calibration.rows() != step.by_rig.cols() || calibration.cols() != step.by_rig.cols()) {
      throw Error("odometry", "the covariance is not of the rig's parameters",
                  "give the covariance of the rig that the step was made with");
    }
    C += step.by_rig * calibration * step.by_rig.transpose();
  }
  const Vector6d sd = C.diagonal().cwiseMax(0).cwiseSqrt();
  const Vector6d z = error.cwiseQuotient(sd);  // of rad and m alike
  const Matrix6d correlation = sd.cwiseInverse().asDiagonal() * C * sd.cwiseInverse().asDiagonal();
  const auto decomposed = correlation.ldlt();
  const bool is_sound = z.allFinite() && correlation.allFinite() &&
                        decomposed.info() == Eigen::Success && decomposed.vectorD().minCoeff() > 0;
  if (!is_sound) {
    throw Error("odometry", "a pose is not finite, or the step's covariance not positive definite",
                "give a step as estimated, a true one and a covariance of the rig");
  }
  return z.dot(decomposed.solve(z));
}

}  // namespace vernier::localise
