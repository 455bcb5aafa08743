// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/simulated_board.h"

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"

namespace vernier {

using namespace internal;

namespace {

constexpr auto board_source = static_cast<std::uint32_t>(DrawSource::simulated_board);

/// The board centred near the rig's axis, tilted and turned.
Pose draw_pose(RandomStream& draws,
               const Rig& rig,
               const Eigen::Vector3d& board_centre_m,
               const SimulatedBoardOptions& options) {
  // from the last coordinate to the first, the order in which all figures were drawn
  const double turn = draws.uniform(-1, 1) * 0.4;
  const double tilt_y = draws.uniform(-1, 1) * options.tilt_rad;
  const double tilt_x = draws.uniform(-1, 1) * options.tilt_rad;
  const double z = options.distance_m * draws.uniform(2.0 / 3, 4.0 / 3);
  const Camera& camera = rig.cameras[0];
  const double half_x = 0.5 * camera.size_px[0] / (camera.f_px() * camera.ax());
  const double half_y = 0.5 * camera.size_px[1] / camera.f_px();
  const double y = draws.uniform(-1, 1) * half_y * z, x = draws.uniform(-1, 1) * half_x * z;
  Pose T_first_board;
  T_first_board.R = rotation_from_vector({tilt_x, tilt_y, turn});
  T_first_board.t = Eigen::Vector3d(x, y, z) - T_first_board.R * board_centre_m;
  return T_first_board;
}

/// The noise-free view of the board; std::nullopt if a corner is outside the image.
std::optional<BoardView> view_of(const Rig& rig,
                                 int camera,
                                 const Pose& T_first_board,
                                 const std::vector<Eigen::Vector3d>& target_m) {
  constexpr double border_px = 5;
  BoardView view;
  view.camera = camera;
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    const Eigen::Vector3d x = rig.T_camera_first[camera] * (T_first_board * target_m[i]);
    if (x.z() < 0.1) return std::nullopt;
    const Eigen::Vector2d pixel = project(rig.cameras[camera], x);
    const Eigen::Vector2d size = rig.cameras[camera].size_px.cast<double>();
    if ((pixel.array() < border_px).any() || (pixel.array() > size.array() - border_px).any()) {
      return std::nullopt;
    }
    view.ids.push_back(static_cast<int>(i));
    view.pixels_px.push_back(pixel);
  }
  return view;
}

}  // namespace

SimulatedBoard simulate_board(const Rig& rig,
                              const Chessboard& board,
                              const SimulatedBoardOptions& options) {
  SimulatedBoard result;
  BoardObservations& observations = result.observations;
  observations.target_m = target_points(board);
  for (const Camera& camera : rig.cameras) observations.size_px.push_back(camera.size_px);
  result.truth.rig = rig;
  const Eigen::Vector3d centre =
      0.5 * (observations.target_m.front() + observations.target_m.back());
  for (int frame = 0; frame < options.frames; ++frame) {
    RandomStream poses({.seed = options.seed,
                        .trial = options.poses,
                        .feature = static_cast<std::uint32_t>(frame),
                        .source = board_source,
                        .eye = 3});
    std::vector<BoardView> views;
    Pose T_first_board;
    for (int attempt = 0; views.size() != rig.cameras.size(); ++attempt) {
      if (attempt == 1000) {
        throw Error("simulated board", "no view shows the whole board in every camera",
                    "use a smaller board or a greater distance");
      }
      views.clear();
      T_first_board = draw_pose(poses, rig, centre, options);
      for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
        auto view = view_of(rig, static_cast<int>(c), T_first_board, observations.target_m);
        if (!view) break;
        views.push_back(std::move(*view));
      }
    }
    result.truth.frames.push_back(frame);
    result.truth.T_first_board.push_back(T_first_board);
    for (BoardView& view : views) {
      view.frame = frame;
      // feature: (frame, camera); the eye field would hold only four cameras
      RandomStream noise(
          of_view({.seed = options.seed, .trial = options.trial, .source = board_source}, frame,
                  view.camera));
      for (auto& pixel : view.pixels_px) {
        pixel.x() += options.pixel_sigma_px * noise.normal();
        pixel.y() += options.pixel_sigma_px * noise.normal();
      }
      observations.views.push_back(std::move(view));
    }
  }
  return result;
}

}  // namespace vernier
