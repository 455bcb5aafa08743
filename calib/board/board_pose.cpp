// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/board_pose.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Sum of squares and, if requested, the normal equations of the board's pose.
struct PoseEquations {
  Matrix6 N = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  double chi2 = 0;
  int residuals = 0;
};

bool in_front(const std::vector<Eigen::Vector3d>& target_m,
              const BoardView& view,
              const Pose& T_camera_board) {
  for (const int id : view.ids) {
    if (!((T_camera_board * target_m[id]).z() > 0)) return false;
  }
  return true;
}

PoseEquations pose_equations(const std::vector<Eigen::Vector3d>& target_m,
                             std::span<const BoardView> views,
                             const Rig& rig,
                             const Pose& T_first_board,
                             Linearise what) {
  PoseEquations equations;
  ViewLinearisation J;
  for (const BoardView& view : views) {
    const Pose& T_camera_first = rig.T_camera_first[view.camera];
    if (!in_front(target_m, view, T_camera_first * T_first_board)) {
      equations.chi2 = std::numeric_limits<double>::infinity();
      return equations;
    }
    linearise_view(rig.cameras[view.camera], T_camera_first, T_first_board, target_m, view, what,
                   J);
    equations.chi2 += J.residual_px.squaredNorm();
    equations.residuals += static_cast<int>(J.residual_px.size());
    if (what == Linearise::residual_only) continue;
    equations.N += J.by_board_pose.transpose() * J.by_board_pose;
    equations.g += J.by_board_pose.transpose() * J.residual_px;
  }
  return equations;
}

/// Normalised coordinates without distortion; beyond the fold of the model, those of the pinhole.
cv::Point2d undistorted(const Camera& camera, const Eigen::Vector2d& pixel) {
  if (const auto ray = try_unproject(camera, pixel)) return {ray->x(), ray->y()};
  return {(pixel.x() - camera.ox_px()) / (camera.f_px() * camera.ax()),
          (pixel.y() - camera.oy_px()) / camera.f_px()};
}

}  // namespace

Pose board_pose(const std::vector<Eigen::Vector3d>& target_m,
                const BoardView& view,
                const Camera& camera) {
  std::vector<cv::Point3d> target;
  std::vector<cv::Point2d> rays;
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const Eigen::Vector3d& X = target_m[view.ids[i]];
    target.emplace_back(X.x(), X.y(), X.z());
    rays.push_back(undistorted(camera, view.pixels_px[i]));
  }
  const Error misfit(
      "frame " + std::to_string(view.frame) + ", camera " + std::to_string(view.camera),
      "no pose fits its corners", "leave the view out");
  cv::Vec3d r, t;
  try {
    cv::solvePnP(target, rays, cv::Matx33d::eye(), cv::noArray(), r, t, false,
                 cv::SOLVEPNP_ITERATIVE);
  } catch (const cv::Exception&) {
    throw misfit;
  }
  Pose pose{rotation_from_vector({r[0], r[1], r[2]}), {t[0], t[1], t[2]}};
  if (!pose.t.allFinite() || !pose.R.allFinite()) throw misfit;
  return pose;
}

BoardPoseFit fit_board_pose(const std::vector<Eigen::Vector3d>& target_m,
                            std::span<const BoardView> views,
                            const Rig& rig,
                            const Pose& start,
                            int max_iterations) {
  BoardPoseFit fit{start, std::numeric_limits<double>::infinity()};
  PoseEquations now = pose_equations(target_m, views, rig, start, Linearise::with_jacobian);
  if (!(now.chi2 < std::numeric_limits<double>::infinity())) return fit;
  double damping = 1e-4;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    Matrix6 N = now.N;
    N.diagonal() *= 1 + damping;
    const Pose moved = retract(fit.T_first_board, Vector6(-N.ldlt().solve(now.g)));
    PoseEquations next = pose_equations(target_m, views, rig, moved, Linearise::with_jacobian);
    if (!(next.chi2 < now.chi2)) {
      damping *= 30;
      if (damping > 1e4) break;
      continue;
    }
    const bool settled = now.chi2 - next.chi2 < 1e-8 * now.chi2;
    fit.T_first_board = moved;
    now = next;
    damping *= 0.1;
    if (settled) break;
  }
  fit.rms_px = std::sqrt(now.chi2 / now.residuals);
  return fit;
}

Pose mirrored_board_pose(const std::vector<Eigen::Vector3d>& target_m,
                         const BoardView& view,
                         const Pose& T_camera_board) {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  for (const int id : view.ids) centre_m += target_m[id] / static_cast<double>(view.ids.size());
  const Eigen::Vector3d c = T_camera_board * centre_m, sight = c.normalized();
  const Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity() - 2 * sight * sight.transpose();
  Pose other;
  other.R = mirror * T_camera_board.R * Eigen::Vector3d(1, 1, -1).asDiagonal();
  other.t = c - other.R * centre_m;
  return other;
}

BoardPoseFit fit_board_pose_both_ways(const std::vector<Eigen::Vector3d>& target_m,
                                      const BoardView& view,
                                      const Rig& one,
                                      const Pose& start,
                                      int max_iterations) {
  const std::span<const BoardView> views(&view, 1);
  const BoardPoseFit fit = fit_board_pose(target_m, views, one, start, max_iterations);
  const BoardPoseFit other = fit_board_pose(
      target_m, views, one, mirrored_board_pose(target_m, view, fit.T_first_board), max_iterations);
  return other.rms_px < fit.rms_px ? other : fit;
}

BoardPoseFit find_board_pose(const std::vector<Eigen::Vector3d>& target_m,
                             std::span<const BoardView> views,
                             const Rig& rig,
                             int max_iterations) {
  BoardPoseFit best{{}, std::numeric_limits<double>::infinity()};
  std::optional<Error> misfit;
  for (const BoardView& view : views) {
    try {
      const Pose alone = board_pose(target_m, view, rig.cameras[view.camera]);
      for (const Pose& start : {alone, mirrored_board_pose(target_m, view, alone)}) {
        const BoardPoseFit fit =
            fit_board_pose(target_m, views, rig, rig.T_camera_first[view.camera].inverse() * start,
                           max_iterations);
        if (fit.rms_px < best.rms_px) best = fit;
      }
    } catch (const Error& error) {
      misfit = error;
    }
  }
  if (std::isfinite(best.rms_px)) return best;
  if (misfit) throw *misfit;
  throw Error("frame " + std::to_string(views.front().frame), "no board pose fits its corners",
              "leave the frame out");
}

}  // namespace vernier::internal
