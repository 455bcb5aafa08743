// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/initial_camera.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/base/shown_text.h"
#include "calib/board/board_homography.h"
#include "calib/board/board_pose.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double outlying = 5;        // times the median residual: excluded from the fit
constexpr double good_share = 0.002;  // of the image's longer side: an acceptable residual
constexpr int steps = 8;

/// Root mean square of the smaller three quarters: decreases whenever the typical views fit better,
/// regardless of a few bad ones.
double typical(std::vector<double> rms) {
  std::sort(rms.begin(), rms.end());
  rms.resize((3 * rms.size() + 3) / 4);
  double sum = 0;
  for (const double r : rms) sum += r * r;
  return std::sqrt(sum / static_cast<double>(rms.size()));
}

/// The views of one camera as a rig, and the fit of a guess to them.
class OneCamera {
 public:
  OneCamera(const BoardObservations& observations, const std::vector<BoardView>& views)
      : target_m_(observations.target_m), views_(views) {
    for (std::size_t i = 0; i < views_.size(); ++i) {
      views_[i].camera = 0;
      views_[i].frame = static_cast<int>(i);
    }
  }

  /// The guess with newly estimated poses.
  InitialCamera with_poses(const Camera& camera) const {
    InitialCamera guess{camera, {}, infinite};
    for (const BoardView& view : views_) {
      guess.T_camera_board.push_back(board_pose(target_m_, view, camera));
    }
    return turned_over(std::move(guess), 4);
  }

  InitialCamera with_refined_poses(InitialCamera guess, int iterations) const {
    return with_poses_by(
        std::move(guess), [&](const BoardView& view, const Rig& rig, const Pose& start) {
          return fit_board_pose(target_m_, std::span(&view, 1), rig, start, iterations);
        });
  }

  /// The same, each from its start or from its mirror image, whichever fits better.
  InitialCamera turned_over(InitialCamera guess, int iterations) const {
    return with_poses_by(std::move(guess),
                         [&](const BoardView& view, const Rig& rig, const Pose& start) {
                           return fit_board_pose_both_ways(target_m_, view, rig, start, iterations);
                         });
  }

  /// A Gauss–Newton step of some of the camera's parameters, with the poses eliminated, halved
  /// until it helps. std::nullopt if it does not.
  std::optional<InitialCamera> improved(const InitialCamera& guess,
                                        const std::vector<int>& free) const {
    Eigen::VectorXd step;
    try {
      step = newton_step(guess, free);
    } catch (const Error&) {
      return std::nullopt;  // a view does not determine its board's pose: discard this guess
    }
    if (!step.allFinite()) return std::nullopt;
    for (double length = 1; length > 0.05; length /= 3) {
      InitialCamera next = guess;
      for (std::size_t i = 0; i < free.size(); ++i) {
        next.camera.parameters[free[i]] += length * step[static_cast<Eigen::Index>(i)];
      }
      if (!(next.camera.f_px() > 0.2 * guess.camera.f_px() && next.camera.ax() > 0.3)) continue;
      next = with_refined_poses(std::move(next), 3);
      if (next.typical_rms_px < guess.typical_rms_px) return next;
    }
    return std::nullopt;
  }

 private:
  template <class Fit>
  InitialCamera with_poses_by(InitialCamera guess, const Fit& fit) const {
    const Rig rig{{guess.camera}, {Pose{}}};
    for (std::size_t i = 0; i < views_.size(); ++i) {
      guess.T_camera_board[i] = fit(views_[i], rig, guess.T_camera_board[i]).T_first_board;
    }
    guess.typical_rms_px = typical(residuals(guess));
    return guess;
  }

  std::vector<double> residuals(const InitialCamera& guess) const {
    const Rig rig{{guess.camera}, {Pose{}}};
    std::vector<double> rms;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      rms.push_back(
          fit_board_pose(target_m_, std::span(&views_[i], 1), rig, guess.T_camera_board[i], 0)
              .rms_px);
    }
    return rms;
  }

  Eigen::VectorXd newton_step(const InitialCamera& guess, const std::vector<int>& free) const {
    const std::vector<double> rms = residuals(guess);
    BoardObservations typical{{guess.camera.size_px}, target_m_, {}};
    BoardState state{{{guess.camera}, {Pose{}}}, {}, {}, {0, 0}};
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (!(rms[i] <= outlying * guess.typical_rms_px) || rms[i] == infinite) continue;
      typical.views.push_back(views_[i]);
      state.frames.push_back(views_[i].frame);
      state.T_first_board.push_back(guess.T_camera_board[i]);
    }
    const ReducedNormalEquations equations = reduced_normal_equations(typical, state, 1);
    const Eigen::VectorXd score = equations.scores.rowwise().sum();
    // scaled, with a little damping: a few views of one camera may leave a direction almost
    // undetermined
    Eigen::MatrixXd S = equations.information(free, free);
    const Eigen::VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
    S = scale.asDiagonal() * S * scale.asDiagonal();
    S.diagonal().array() += 1e-6;
    return -(
        scale.asDiagonal() *
        solve_symmetric(S, Eigen::VectorXd(scale.asDiagonal() * Eigen::VectorXd(score(free)))));
  }

  const std::vector<Eigen::Vector3d>& target_m_;
  std::vector<BoardView> views_;
};

/// Improves f and k1, then also ax and k2, as far as the model has them, then all parameters. A
/// better camera tells better on which side of the line of sight a board is tilted.
InitialCamera improve(const OneCamera& views, InitialCamera guess) {
  constexpr int f = 0, ax = 1, k1 = core_parameter_count;
  const int last = static_cast<int>(guess.camera.parameters.size()) - 1;
  std::vector<std::vector<int>> stages{{f, ax}};
  if (last >= k1) stages = {{f, k1}, {f, ax, k1}};
  if (last >= k1 + 1) stages.push_back({f, ax, k1, k1 + 1});
  std::vector<int> all(last + 1);
  std::iota(all.begin(), all.end(), 0);
  stages.push_back(all);
  for (const std::vector<int>& free : stages) {
    for (int i = 0; i < steps; ++i) {
      const auto next = views.improved(guess, free);
      if (!next) break;
      const bool settled = next->typical_rms_px > 0.995 * guess.typical_rms_px;
      guess = *next;
      if (settled) break;
    }
    guess = views.turned_over(std::move(guess), 6);
  }
  return guess;
}

}  // namespace

InitialCamera initial_camera(const BoardObservations& observations,
                             const std::vector<BoardView>& views,
                             const CameraModel& model,
                             const std::string& place) {
  if (views.size() < 3) {
    throw Error(place, counted(static_cast<std::int64_t>(views.size()), "view") + " of the board",
                "at least three, at different tilts, are needed");
  }
  check_flat(observations.target_m);
  const Eigen::Vector2i size = observations.size_px[views.front().camera];
  Camera camera;
  camera.size_px = size;
  camera.model = model;
  camera.parameters = Eigen::VectorXd::Zero(parameter_count(model));
  camera.parameters.head<4>() << 1, 1, 0.5 * (size[0] - 1), 0.5 * (size[1] - 1);
  const OneCamera one(observations, views);
  const double good_px = good_share * size.maxCoeff();

  InitialCamera best;
  best.typical_rms_px = infinite;
  const auto consider = [&](double f_px) {
    camera.parameters[0] = f_px;
    InitialCamera guess = improve(one, one.with_poses(camera));
    if (best.T_camera_board.empty() || guess.typical_rms_px < best.typical_rms_px) {
      best = std::move(guess);
    }
  };
  std::vector<BoardHomography> homographies;
  homographies.reserve(views.size());
  for (const BoardView& view : views) {
    homographies.push_back(board_homography(observations.target_m, view));
  }
  if (const auto f = focal_length_px(homographies, size)) consider(*f);
  consider(0.8 * size.maxCoeff());  // a common lens, in case noise and distortion mislead the first
  if (best.typical_rms_px < good_px) return best;
  for (const double widths : {0.5, 0.7, 0.35, 1.0, 0.25, 1.4, 2.0, 3.0}) {
    consider(widths * size[0]);
    if (best.typical_rms_px < good_px) break;
  }
  return best;
}

}  // namespace vernier::internal
