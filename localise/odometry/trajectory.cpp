// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/trajectory.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/odometry.h"
#include "localise/odometry/step_consensus.h"
#include "localise/place.h"

namespace vernier::localise {

namespace {

using Eigen::Matrix3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Derivatives of a product of poses T = A B in the tangent of retract().
struct ProductDerivatives {
  Matrix6d by_first = Matrix6d::Identity(), by_second = Matrix6d::Zero();

  ProductDerivatives(const Pose& A, const Pose& B) {
    by_first.bottomLeftCorner<3, 3>() = -hat(A.R * B.t);
    by_second.topLeftCorner<3, 3>() = A.R;
    by_second.bottomRightCorner<3, 3>() = A.R;
  }
};

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
std::optional<MotionStep> linked_step(const Rig& rig,
                                      std::span<const StereoCorner> from,
                                      std::span<const StereoCorner> to,
                                      const Pose& expected,
                                      const CornerLinkOptions& linking,
                                      const StepOptions& options) {
  constexpr std::array search_windows_px{8.0, 16.0, 32.0, 64.0};
  constexpr double found_window_px = 4;
  const auto near = [&](const Pose& T_from_to, double window_px) {
    return estimate_step(rig, from, to,
                         link_corners_near(rig, from, to, T_from_to, window_px, linking), options);
  };
  const std::vector<CornerLink> unguided = link_corners(from, to, linking);
  auto found = estimate_step(rig, from, to, unguided, options);
  for (const double window_px : search_windows_px) {
    if (found) break;
    found = near(expected, window_px);
  }
  if (!found) return std::nullopt;
  auto again = near(found->T_from_to, found_window_px);
  if (again && again->inliers.size() >= found->inliers.size()) found = std::move(again);
  found->other_motion = internal::other_motion(rig, from, to, unguided, *found, options);
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
  for (std::size_t i = 1; i < moments.size(); ++i) {
    StepOptions of_step = options;
    of_step.step = static_cast<std::uint32_t>(i);
    path.steps.push_back(
        linked_step(rig, moments[i - 1], moments[i], last_motion, linking, of_step));
    const Pose& T = path.T_first_camera.back();
    if (const auto& step = path.steps.back()) {
      last_motion = step->T_from_to;
      const ProductDerivatives d(T, last_motion);
      path.end_covariance = d.by_first * path.end_covariance * d.by_first.transpose() +
                            d.by_second * step->covariance * d.by_second.transpose();
      path.end_by_rig = d.by_first * path.end_by_rig;
      if (step->by_rig.size() > 0) path.end_by_rig += d.by_second * step->by_rig;
    }
    path.T_first_camera.push_back(T * last_motion);
  }
  return path;
}

TrajectoryDrift drift_of(std::span<const Pose> estimate,
                         std::span<const Pose> truth,
                         double segment_m) {
  check_together(estimate, truth);
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
  return error.dot(C.ldlt().solve(error));
}

}  // namespace vernier::localise
