// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/planning/smooth_noise.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board/board_warp.h"
#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

constexpr int degree = 3;

/// Number of different values, at most `most`.
int distinct(std::vector<double> values, int most) {
  std::set<long long> seen;
  for (const double v : values) seen.insert(std::llround(v * 1e6));
  return std::min(most, static_cast<int>(seen.size()));
}

/// An orthonormal basis of the polynomials over a view's corners, corners x modes.
Eigen::MatrixXd smooth_modes(const std::vector<Eigen::Vector3d>& target_m,
                             const std::vector<int>& ids) {
  std::vector<double> x, y;
  for (const int id : ids) {
    x.push_back(target_m[static_cast<std::size_t>(id)].x());
    y.push_back(target_m[static_cast<std::size_t>(id)].y());
  }
  const int most_x = distinct(x, degree + 1), most_y = distinct(y, degree + 1);
  const auto unit = [](const std::vector<double>& values, std::size_t i) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high > *low ? (2 * values[i] - *low - *high) / (*high - *low) : 0.0;
  };
  std::vector<Eigen::VectorXd> columns;
  for (int i = 0; i < most_x; ++i) {
    for (int j = 0; j < most_y && i + j <= degree; ++j) {
      Eigen::VectorXd column(static_cast<Eigen::Index>(ids.size()));
      for (std::size_t k = 0; k < ids.size(); ++k) {
        column[static_cast<Eigen::Index>(k)] = std::pow(unit(x, k), i) * std::pow(unit(y, k), j);
      }
      columns.push_back(std::move(column));
    }
  }
  if (columns.size() * 2 > ids.size()) return {};
  Eigen::MatrixXd X(static_cast<Eigen::Index>(ids.size()),
                    static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) X.col(static_cast<Eigen::Index>(k)) = columns[k];
  return orthonormal_basis(X);
}

struct FramePower {
  double power = 0;
  int modes = 0;
};

}  // namespace

SmoothNoise smooth_noise(const BoardObservations& observations,
                         const BoardState& state,
                         int parameters) {
  const auto target_m = warped_target(observations.target_m, state.warp_m);
  std::map<int, FramePower> frames;
  double squares = 0, coordinates_seen = 0;
  for (const BoardView& view : observations.views) {
    ViewLinearisation line;
    const auto camera = static_cast<std::size_t>(view.camera);
    linearise_view(state.rig.cameras[camera], state.rig.T_camera_first[camera],
                   state.T_first_board[frame_index(state.frames, view.frame)], target_m, view,
                   Linearise::residual_only, line);
    squares += line.residual_px.squaredNorm();
    coordinates_seen += static_cast<double>(line.residual_px.size());
    const Eigen::MatrixXd Q = smooth_modes(observations.target_m, view.ids);
    if (Q.size() == 0) continue;
    FramePower& frame = frames[view.frame];
    for (int coordinate = 0; coordinate < 2; ++coordinate) {
      const Eigen::VectorXd r = line.residual_px(Eigen::seqN(coordinate, Q.rows(), Eigen::fix<2>));
      frame.power += (Q.transpose() * r).squaredNorm();
      frame.modes += static_cast<int>(Q.cols());
    }
  }
  const auto count = static_cast<double>(frames.size());
  double power = 0, freedom = 0;
  const double fitted = 6 + parameters / std::max(1.0, count);
  for (const auto& [number, frame] : frames) {
    power += frame.power;
    freedom += frame.modes - fitted;
  }
  if (!(count >= 2) || !(freedom > 0)) {
    throw Error("noise", "the views show too few corners to tell how their noise is correlated",
                "take more views, or views that show more of the board");
  }
  const double mean = power / freedom;
  double scatter = 0;
  for (const auto& [number, frame] : frames) {
    scatter += std::pow(frame.power - mean * (frame.modes - fitted), 2);
  }
  const double dof = coordinates_seen - 6 * count - parameters;
  const double of_frames = std::sqrt(scatter * count / (count - 1)) / power;
  return {std::sqrt(mean), 0.5 * std::max(std::sqrt(2 / freedom), of_frames),
          mean * std::max(1.0, dof) / squares};
}

}  // namespace vernier::internal
