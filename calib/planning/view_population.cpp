// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/planning/view_population.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/solver/normal_equations.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"

namespace vernier::internal {
namespace {

constexpr auto kinds_source = static_cast<std::uint32_t>(DrawSource::planned_views);
constexpr std::size_t pose_size = 6;

Eigen::Vector3d middle_of(const std::vector<Eigen::Vector3d>& target_m) {
  Eigen::Vector3d low = target_m[0], high = target_m[0];
  for (const Eigen::Vector3d& x : target_m) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return 0.5 * (low + high);
}

PoseCoordinates coordinates_of(const Pose& T_camera_board, const Eigen::Vector3d& middle_m) {
  const Eigen::Vector3d x = T_camera_board * middle_m, w = vector_from_rotation(T_camera_board.R);
  return {std::log(x.z()), x.x() / x.z(), x.y() / x.z(), w.x(), w.y(), w.z()};
}

Pose pose_of(const PoseCoordinates& c, const Eigen::Vector3d& middle_m) {
  Pose T_camera_board;
  T_camera_board.R = rotation_from_vector({c[3], c[4], c[5]});
  const double z = std::exp(c[0]);
  T_camera_board.t = Eigen::Vector3d(c[1] * z, c[2] * z, z) - T_camera_board.R * middle_m;
  return T_camera_board;
}

/// The noise-free corners of a pose; none if one of the cameras does not see all of them.
std::optional<std::vector<BoardView>> seen_whole(const Rig& rig,
                                                 const std::vector<Eigen::Vector3d>& target_m,
                                                 const Pose& T_first_board,
                                                 const std::vector<int>& cameras,
                                                 int frame) {
  std::vector<BoardView> views;
  for (const int camera : cameras) {
    const auto c = static_cast<std::size_t>(camera);
    BoardView view;
    view.frame = frame;
    view.camera = camera;
    for (std::size_t i = 0; i < target_m.size(); ++i) {
      const Eigen::Vector3d x = rig.T_camera_first[c] * (T_first_board * target_m[i]);
      if (!(x.z() > 1e-3)) return std::nullopt;
      const Eigen::Vector2d pixel = project(rig.cameras[c], x);
      if (!in_image(rig.cameras[c], pixel)) return std::nullopt;
      view.ids.push_back(static_cast<int>(i));
      view.pixels_px.push_back(pixel);
    }
    views.push_back(std::move(view));
  }
  return views;
}

struct DrawnPoses {
  std::vector<PoseCoordinates> poses;
  BoardObservations observations;
  BoardState state;
};

/// `count` poses that the cameras see whole, uniform about the mean with these half-widths.
DrawnPoses draw_poses(const Rig& rig,
                      const std::vector<Eigen::Vector3d>& target_m,
                      const Eigen::Vector2d& warp_m,
                      const PosePopulation& population,
                      const PoseCoordinates& half_width,
                      const std::vector<int>& cameras,
                      int count,
                      RandomStream& draws) {
  const Eigen::Vector3d middle_m = middle_of(target_m);
  const auto shape_m = warped_target(target_m, warp_m);
  const Pose T_first_camera = rig.T_camera_first[static_cast<std::size_t>(cameras[0])].inverse();
  DrawnPoses drawn;
  for (const Camera& camera : rig.cameras) drawn.observations.size_px.push_back(camera.size_px);
  drawn.observations.target_m = target_m;
  drawn.state.rig = rig;
  drawn.state.warp_m = warp_m;
  const int most_tries = 200 * count;
  for (int tries = 0; static_cast<int>(drawn.poses.size()) < count; ++tries) {
    if (tries == most_tries) {
      throw Error("planned views", "hardly any pose like those given shows the whole board",
                  "give views in which cameras see all of the board");
    }
    PoseCoordinates c;
    for (std::size_t k = 0; k < pose_size; ++k) {
      c[k] = population.mean[k] + half_width[k] * draws.uniform(-1, 1);
    }
    const Pose T_first_board = T_first_camera * pose_of(c, middle_m);
    const auto frame = static_cast<int>(drawn.poses.size());
    auto views = seen_whole(rig, shape_m, T_first_board, cameras, frame);
    if (!views) continue;
    for (BoardView& view : *views) drawn.observations.views.push_back(std::move(view));
    drawn.state.frames.push_back(frame);
    drawn.state.T_first_board.push_back(T_first_board);
    drawn.poses.push_back(c);
  }
  return drawn;
}

PosePopulation moments(const std::vector<PoseCoordinates>& poses) {
  PosePopulation result;
  const auto n = static_cast<double>(poses.size());
  result.poses = static_cast<int>(poses.size());
  for (std::size_t k = 0; k < pose_size; ++k) {
    double sum = 0, squares = 0;
    for (const PoseCoordinates& c : poses) sum += c[k];
    result.mean[k] = sum / n;
    for (const PoseCoordinates& c : poses) squares += std::pow(c[k] - result.mean[k], 2);
    result.sd[k] = std::sqrt(squares / (n - 1));
  }
  return result;
}

/// χ² with so many degrees of freedom.
double chi_squared(int dof, RandomStream& draws) {
  double sum = 0;
  for (int i = 0; i < dof; ++i) sum += std::pow(draws.normal(), 2);
  return sum;
}

}  // namespace

PosePopulation pose_population(const std::vector<Pose>& T_camera_board,
                               const std::vector<Eigen::Vector3d>& target_m) {
  if (T_camera_board.size() < 3) {
    throw Error("plan", "fewer than three views do not show how the board is held",
                "take more views");
  }
  const Eigen::Vector3d middle_m = middle_of(target_m);
  std::vector<PoseCoordinates> poses;
  for (const Pose& pose : T_camera_board) poses.push_back(coordinates_of(pose, middle_m));
  return moments(poses);
}

PosePopulation redrawn(const PosePopulation& population, std::uint64_t seed, std::uint32_t number) {
  PosePopulation other = population;
  const int dof = population.poses - 1;
  for (std::size_t k = 0; k < pose_size; ++k) {
    RandomStream draws({.seed = seed,
                        .trial = number,
                        .feature = static_cast<std::uint32_t>(k),
                        .source = kinds_source,
                        .eye = 1});
    // Coordinates are nearer to uniform than to normal: 2/(n-1) becomes 0.8/n of the variance's.
    const double chi2 = chi_squared(dof, draws) / dof;
    constexpr double kurtosis_share = 0.4;
    other.sd[k] *= std::pow(chi2, -0.5 * std::sqrt(kurtosis_share));
    other.mean[k] += other.sd[k] / std::sqrt(population.poses) * draws.normal();
  }
  return other;
}

std::vector<Eigen::MatrixXd> population_views(const Rig& rig,
                                              const std::vector<Eigen::Vector3d>& target_m,
                                              const Eigen::Vector2d& warp_m,
                                              const PosePopulation& population,
                                              const std::vector<int>& cameras,
                                              int count,
                                              std::uint64_t seed,
                                              std::uint32_t number) {
  RandomStream draws({.seed = seed, .trial = number, .source = kinds_source});
  const double root_three = std::sqrt(3.0);
  PoseCoordinates half_width;
  for (std::size_t k = 0; k < pose_size; ++k) half_width[k] = root_three * population.sd[k];
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    const auto taken = moments(
        draw_poses(rig, target_m, warp_m, population, half_width, cameras, 60, draws).poses);
    for (std::size_t k = 0; k < pose_size; ++k) {
      if (!(taken.sd[k] > 0)) continue;
      half_width[k] *= std::clamp(population.sd[k] / taken.sd[k], 0.8, 1.25);
      half_width[k] = std::min(half_width[k], 2.0 * root_three * population.sd[k]);
    }
  }
  const DrawnPoses drawn =
      draw_poses(rig, target_m, warp_m, population, half_width, cameras, count, draws);
  return reduced_normal_equations(drawn.observations, drawn.state, 1).frame_information;
}

}  // namespace vernier::internal
