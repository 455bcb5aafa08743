// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/simulated_board.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
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

void check_board(const Chessboard& board) {
  constexpr int most = 1000;  // along a side; a larger number is a typing error
  if (board.columns < 2 || board.rows < 2 || board.columns > most || board.rows > most) {
    throw Error(name_of(board), fmt::format("fewer than 2 or more than {} along a side", most),
                "count the inner corners");
  }
  const bool has_lengths = board.square_m > 0 && board.row_m >= 0;
  if (!has_lengths || !std::isfinite(board.square_m) || !std::isfinite(board.row_m)) {
    throw Error(name_of(board), "the distance between its corners is not above 0",
                "give square_m in metres, and row_m or 0");
  }
}

void check_options(const SimulatedBoardOptions& options) {
  constexpr int most_frames = 100'000;
  const std::string place = "simulated board";
  if (options.frames < 1 || options.frames > most_frames) {
    throw Error(place, fmt::format("{} frames", options.frames),
                fmt::format("give 1 to {}", most_frames));
  }
  if (!(options.pixel_sigma_px >= 0) || !std::isfinite(options.pixel_sigma_px)) {
    throw Error(place, fmt::format("pixel noise of {} px", options.pixel_sigma_px),
                "give 0 or more");
  }
  if (!(options.distance_m > 0) || !std::isfinite(options.distance_m)) {
    throw Error(place, fmt::format("a distance of {} m", options.distance_m),
                "give a number above 0");
  }
  if (!std::isfinite(options.tilt_rad)) {
    throw Error(place, fmt::format("a tilt of {} rad", options.tilt_rad), "give a finite number");
  }
}

void check_cameras(const Rig& rig) {
  if (rig.cameras.empty()) throw Error("simulated board", "the rig has no camera", "give one");
  if (rig.T_camera_first.size() != rig.cameras.size() || !parameters(rig).allFinite()) {
    throw Error("simulated board", "the rig lacks a pose or has a number that is not finite",
                "give every camera a pose and finite parameters");
  }
}

}  // namespace

SimulatedBoard simulate_board(const Rig& rig,
                              const Chessboard& board,
                              const SimulatedBoardOptions& options) {
  check_board(board);
  check_options(options);
  check_cameras(rig);
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
