// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/camera.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/field_spectrum.h"
#include "calib/noise/frame_rows.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"
#include "calib/statistics/random.h"

namespace vernier::test {

/// Components of which every one matters.
inline constexpr vernier::internal::CornerNoise all_parts{.white_px = 0.11,
                                                          .field_px = 0.09,
                                                          .field_length_m = 0.05,
                                                          .motion_rad = 1e-3,
                                                          .motion_m = 2e-4,
                                                          .shape_plane_m = 5e-5,
                                                          .shape_height_m = 1.5e-4};

/// A simulated board whose corners have all of calib/noise/corner_noise.h, with the truth of each.
struct NoisyBoard {
  SimulatedBoard board;
  std::vector<Eigen::Matrix<double, 6, 1>> motions;  ///< of each frame: rad, m
  std::vector<Eigen::Vector3d> shape_m;              ///< of each point of the target
};

/// Poses by (seed, poses), noise by (seed, trial).
inline NoisyBoard noisy_board(const Rig& rig,
                              const Chessboard& board,
                              SimulatedBoardOptions options,
                              const vernier::internal::CornerNoise& noise) {
  enum Draw : std::uint32_t { motion, field, shape };
  constexpr std::uint32_t test_source = 255;
  const auto draws = [&](Draw what, int frame, int camera) {
    return vernier::internal::RandomStream({.seed = options.seed,
                                            .trial = options.trial,
                                            .feature = what,
                                            .source = test_source,
                                            .eye = static_cast<std::uint32_t>(camera),
                                            .frame = static_cast<std::uint32_t>(frame)});
  };
  options.pixel_sigma_px = noise.white_px;
  NoisyBoard result{simulate_board(rig, board, options), {}, {}};
  BoardObservations& seen = result.board.observations;
  const auto& points = seen.target_m;
  const auto n = static_cast<Eigen::Index>(points.size());
  vernier::internal::RandomStream shapes = draws(shape, 0, 0);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double x = shapes.normal(), y = shapes.normal(), z = shapes.normal();
    result.shape_m.emplace_back(noise.shape_plane_m * x, noise.shape_plane_m * y,
                                noise.shape_height_m * z);
  }
  Eigen::MatrixXd L;
  if (noise.field_px > 0) {
    Eigen::MatrixXd K = vernier::internal::field_correlation(points, noise.field_length_m);
    K.diagonal().array() += 1e-9;
    L = noise.field_px * Eigen::MatrixXd(K.llt().matrixL());
  }
  for (BoardView& view : seen.views) {
    const auto f = static_cast<std::size_t>(view.frame);
    const int c = view.camera;
    const Pose& T = result.board.truth.T_first_board[f];
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const auto& X : points) centre += (T * X) / static_cast<double>(n);
    Eigen::Matrix<double, 6, 1> u = Eigen::Matrix<double, 6, 1>::Zero();
    if (c > 0) {
      vernier::internal::RandomStream motions = draws(motion, view.frame, c);
      for (int k = 0; k < 6; ++k)
        u[k] = motions.normal() * (k < 3 ? noise.motion_rad : noise.motion_m);
      if (noise.motion_baseline_m > 0) {
        const Eigen::Vector3d along = vernier::internal::motion_axes(rig, c).col(0);
        const double across = u.tail<3>().dot(along);
        u.tail<3>() += (noise.motion_baseline_m / noise.motion_m - 1) * across * along;
      }
      if (c == 1) result.motions.push_back(u);
    }
    vernier::internal::RandomStream fields = draws(field, view.frame, c);
    Eigen::MatrixX2d error = Eigen::MatrixX2d::Zero(n, 2);
    for (Eigen::Index i = 0; i < n; ++i) error.row(i) << fields.normal(), fields.normal();
    if (noise.field_px > 0) error = (L * error).eval();
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const int id = view.ids[i];
      const auto at = static_cast<std::size_t>(id);
      const Eigen::Vector3d P = T * (points[at] + result.shape_m[at]);
      const Eigen::Vector3d moved =
          centre + rotation_from_vector(u.head<3>()) * (P - centre) + u.tail<3>();
      const auto& there = rig.T_camera_first[static_cast<std::size_t>(c)];
      const auto& camera = rig.cameras[static_cast<std::size_t>(c)];
      view.pixels_px[i] +=
          project(camera, there * moved) - project(camera, there * (T * points[at]));
      if (noise.field_px > 0) view.pixels_px[i] += error.row(id).transpose();
    }
  }
  return result;
}

}  // namespace vernier::test
