// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/outliers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "calib/board/board_pose.h"
#include "calib/board/board_warp.h"
#include "calib/board/nearest_corners.h"
#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/observation_checks.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/solver/loss.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

using PerCorner = std::vector<std::vector<double>>;  // one per corner, view by view

constexpr double min_sigma_px = 1e-6;  // residuals below are rounding

/// Robust standard deviation of a coordinate, one per camera: lenses and images differ.
std::vector<double> camera_sigmas(const BoardObservations& observations,
                                  const CornerResiduals& residuals) {
  std::vector<CornerResiduals> of_camera(observations.size_px.size());
  for (std::size_t v = 0; v < residuals.size(); ++v) {
    of_camera[static_cast<std::size_t>(observations.views[v].camera)].push_back(residuals[v]);
  }
  std::vector<double> sigmas;
  sigmas.reserve(of_camera.size());
  for (const CornerResiduals& own : of_camera) {
    sigmas.push_back(std::max(min_sigma_px, robust_pixel_sigma(own)));
  }
  return sigmas;
}

/// Weights by the length of a residual in robust standard deviations, at least `least`.
PerCorner weights_of(const BoardObservations& observations,
                     const CornerResiduals& residuals,
                     const Loss& loss,
                     double least) {
  const std::vector<double> sigmas = camera_sigmas(observations, residuals);
  PerCorner weights;
  for (std::size_t v = 0; v < residuals.size(); ++v) {
    const double sigma = sigmas[static_cast<std::size_t>(observations.views[v].camera)];
    std::vector<double>& own = weights.emplace_back();
    for (const Eigen::Vector2d& r : residuals[v])
      own.push_back(std::max(least, weight_of(loss, r.norm() / sigma)));
  }
  return weights;
}

double largest_change(const PerCorner& a, const PerCorner& b) {
  double change = 0;
  for (std::size_t v = 0; v < a.size(); ++v) {
    for (std::size_t i = 0; i < a[v].size(); ++i) {
      change = std::max(change, std::abs(a[v][i] - b[v][i]));
    }
  }
  return change;
}

/// The minimum of Tukey's loss, reached through Huber's.
BoardState redescending_minimum(const BoardObservations& observations,
                                BoardState state,
                                ReprojectionProblem problem,
                                double limit) {
  constexpr int huber_rounds = 4, tukey_rounds = 15;
  problem.must_converge = false;
  for (int round = 0; round < huber_rounds + tukey_rounds; ++round) {
    const CornerResiduals residuals = corner_residuals(observations, state);
    const Loss loss =
        round < huber_rounds ? Loss{LossShape::huber, 2} : Loss{LossShape::tukey, limit};
    PerCorner weights = weights_of(observations, residuals, loss, 1e-6);
    if (round > huber_rounds && largest_change(weights, problem.corner_weights) < 1e-3) break;
    problem.corner_weights = std::move(weights);
    state = minimise_reprojection(observations, state, problem);
  }
  return state;
}

constexpr double rayleigh_median = 1.1774100225154747;  // of |r| / σ, √(2 ln 2)

/// Whether corner `i` stands out from its neighbours that are not out: its residual is longer than
/// `limit` of their robust standard deviations of a coordinate.
bool stands_out(const std::vector<Eigen::Vector2d>& residuals,
                const std::vector<std::size_t>& neighbours,
                std::size_t i,
                double limit) {
  std::vector<double> lengths;
  for (const std::size_t k : neighbours) lengths.push_back(residuals[k].norm());
  return residuals[i].norm() > limit * median_or_zero(std::move(lengths)) / rayleigh_median;
}

/// Whether corner `i` belongs to a cluster of wrong corners, of which some are out: it is moved
/// like one of these, and each neighbour is moved like it or quite differently. Where a lens that
/// the model does not fit moves corners more and more towards the edge of the image, there are
/// some in between.
bool is_in_cluster(const std::vector<Eigen::Vector2d>& residuals,
                   const std::vector<std::size_t>& all_neighbours,
                   const std::vector<bool>& out,
                   std::size_t i) {
  // Of the residual's length. A shift by a square differs by some per cent from corner to corner;
  // noise adds to that: residuals of six standard deviations differ by some 0.3 by it, so that near
  // the limit a cluster is found in part only.
  constexpr double alike = 0.3, unlike = 0.7;
  const double length = residuals[i].norm();
  bool like_one_out = false;
  for (const std::size_t k : all_neighbours) {
    const double apart = (residuals[k] - residuals[i]).norm();
    like_one_out = like_one_out || (out[k] && apart < alike * length);
    if (apart >= alike * length && apart <= unlike * length) return false;
  }
  return like_one_out;
}

/// One flag per corner of every view.
std::vector<std::vector<bool>> outlier_flags(const BoardObservations& observations,
                                             const BoardState& state,
                                             double limit) {
  const CornerResiduals residuals = corner_residuals(observations, state);
  const std::vector<double> sigmas = camera_sigmas(observations, residuals);
  std::vector<std::vector<bool>> flags;
  for (std::size_t v = 0; v < residuals.size(); ++v) {
    const BoardView& view = observations.views[v];
    const double beyond = limit * sigmas[static_cast<std::size_t>(view.camera)];
    const std::vector<Eigen::Vector2d>& own = residuals[v];
    const auto is_long = [&](const Eigen::Vector2d& r) { return r.norm() > beyond; };
    const auto longs = static_cast<std::size_t>(std::count_if(own.begin(), own.end(), is_long));
    std::vector<bool>& flag = flags.emplace_back(own.size(), 2 * longs > own.size());
    const auto neighbours = [&](std::size_t i, const std::vector<bool>& out) {
      return nearest_corners(observations.target_m, view, i, 8, out);
    };
    // Wrong corners side by side hide each other, until those at the rim are out.
    bool first = true;
    for (bool more = true; more; first = false) {
      const std::vector<bool> out = flag;
      for (std::size_t i = 0; i < own.size(); ++i) {
        if (flag[i] || !is_long(own[i])) continue;
        flag[i] = stands_out(own, neighbours(i, out), i, limit) &&
                  (first || is_in_cluster(own, neighbours(i, {}), out, i));
      }
      more = flag != out;
    }
  }
  return flags;
}

/// Whether some view has an rms three times the usual one of its camera: least squares spreads the
/// misfit of a wrong view over the others, so none of its corners need be an outlier by itself.
bool some_view_stands_out(const BoardObservations& observations, const BoardState& state) {
  std::vector<std::vector<double>> rms(observations.size_px.size());  // by camera
  const CornerResiduals residuals = corner_residuals(observations, state);
  for (std::size_t v = 0; v < residuals.size(); ++v) {
    double squares = 0;
    for (const Eigen::Vector2d& r : residuals[v]) squares += r.squaredNorm();
    rms[static_cast<std::size_t>(observations.views[v].camera)].push_back(
        std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, residuals[v].size()))));
  }
  return std::any_of(rms.begin(), rms.end(), [](const std::vector<double>& own) {
    return !own.empty() && *std::max_element(own.begin(), own.end()) >
                               3 * std::max(min_sigma_px, median_or_zero(own));
  });
}

bool any(const std::vector<std::vector<bool>>& flags) {
  return std::any_of(flags.begin(), flags.end(), [](const std::vector<bool>& view) {
    return std::find(view.begin(), view.end(), true) != view.end();
  });
}

/// The views and frames of `observations` without outliers, and the outliers.
RobustFit separated(const BoardObservations& observations,
                    const BoardState& state,
                    const std::vector<std::vector<bool>>& out) {
  RobustFit fit{observations, state, {}};
  fit.inliers.views.clear();
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    const BoardView& view = observations.views[v];
    BoardView inlier{view.frame, view.camera, view.image, {}, {}};
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      if (out[v][i]) continue;
      inlier.ids.push_back(view.ids[i]);
      inlier.pixels_px.push_back(view.pixels_px[i]);
    }
    const bool keep = 2 * inlier.ids.size() >= view.ids.size() &&
                      determines_pose(observations.target_m, inlier.ids);
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      if (keep && !out[v][i]) continue;
      fit.outliers.push_back(
          {view.frame, view.camera, view.ids[i], view.image, view.pixels_px[i], 0});
    }
    if (keep) fit.inliers.views.push_back(std::move(inlier));
  }
  fit.state = at_frames(state, frames_of(fit.inliers));
  return fit;
}

void check_camera(const Rig& rig, int camera, int frame) {
  if (camera >= 0 && camera < static_cast<int>(rig.cameras.size())) return;
  throw Error(fmt::format("frame {}", frame),
              fmt::format("the rig has {} cameras, so no camera {}", rig.cameras.size(), camera),
              "give the corners of this rig");
}

}  // namespace

CornerResiduals corner_residuals(const BoardObservations& observations, const BoardState& state) {
  const auto target_m = warped_target(observations.target_m, state.warp_m);
  CornerResiduals residuals;
  ViewLinearisation J;
  for (const BoardView& view : observations.views) {
    const std::size_t f = frame_index(state.frames, view.frame);
    check_camera(state.rig, view.camera, view.frame);
    linearise_view(state.rig.cameras[view.camera], state.rig.T_camera_first[view.camera],
                   state.T_first_board[f], target_m, view, Linearise::residual_only, J);
    std::vector<Eigen::Vector2d>& own = residuals.emplace_back();
    for (Eigen::Index i = 0; i < J.residual_px.size(); i += 2) {
      own.emplace_back(J.residual_px.segment<2>(i));
    }
  }
  return residuals;
}

double robust_pixel_sigma(const CornerResiduals& residuals) {
  std::vector<double> lengths;
  for (const auto& view : residuals) {
    for (const Eigen::Vector2d& r : view) lengths.push_back(r.norm());
  }
  return lengths.empty() ? 0 : median_or_zero(std::move(lengths)) / rayleigh_median;
}

std::optional<BoardState> robust_minimum(const BoardObservations& observations,
                                         const BoardState& state,
                                         const ReprojectionProblem& problem,
                                         double limit) {
  if (!any(outlier_flags(observations, state, limit)) &&
      !some_view_stands_out(observations, state)) {
    return {};
  }
  return redescending_minimum(observations, state, problem, limit);
}

bool place_outlying_boards(const BoardObservations& observations, BoardState& state, double limit) {
  const auto flags = outlier_flags(observations, state, limit);
  std::set<int> frames;
  for (std::size_t v = 0; v < flags.size(); ++v) {
    if (2 * std::count(flags[v].begin(), flags[v].end(), true) >
        static_cast<std::ptrdiff_t>(flags[v].size())) {
      frames.insert(observations.views[v].frame);
    }
  }
  const auto target_m = warped_target(observations.target_m, state.warp_m);
  bool moved = false;
  for (const int frame : frames) {
    const std::vector<BoardView> views = at_frames(observations, {frame}).views;
    Pose& T_first_board = state.T_first_board[frame_index(state.frames, frame)];
    const double rms_px = fit_board_pose(target_m, views, state.rig, T_first_board, 0).rms_px;
    try {
      const BoardPoseFit found = find_board_pose(target_m, views, state.rig);
      if (!(found.rms_px < 0.5 * rms_px)) continue;
      T_first_board = found.T_first_board;
      moved = true;
    } catch (const Error&) {  // an outlier it stays
    }
  }
  return moved;
}

RobustFit outliers_at(const BoardObservations& observations,
                      const BoardState& state,
                      double limit) {
  RobustFit fit = separated(observations, state, outlier_flags(observations, state, limit));
  measure_outliers(observations.target_m, fit.state, fit.outliers);
  return fit;
}

std::vector<std::string> overrejected_cameras(const BoardObservations& observations,
                                              const BoardObservations& inliers,
                                              const Rig& rig) {
  std::vector<std::string> words;
  for (int c = 0; c < static_cast<int>(rig.cameras.size()); ++c) {
    std::set<int> kept;
    for (const BoardView& view : inliers.views) {
      if (view.camera == c) kept.insert(view.frame);
    }
    std::vector<std::string> out;
    for (const BoardView& view : observations.views) {
      if (view.camera == c && !kept.contains(view.frame)) out.push_back(std::to_string(view.frame));
    }
    if (out.size() <= kept.size()) continue;
    words.push_back(
        fmt::format("{} of the {} views of camera {} (\"{}\") do not fit the others, too many to "
                    "exclude as outliers: inspect the images of frames {}",
                    out.size(), out.size() + kept.size(), c, rig.cameras[c].name, list_of(out)));
  }
  return words;
}

std::vector<std::string> images_left_out(const std::vector<CornerOutlier>& outliers,
                                         const BoardObservations& inliers) {
  std::map<std::pair<int, int>, std::string> out;  // by frame, camera
  for (const CornerOutlier& corner : outliers) {
    out[{corner.frame, corner.camera}] =
        view_label({corner.frame, corner.camera, corner.image, {}, {}});
  }
  for (const BoardView& view : inliers.views) out.erase({view.frame, view.camera});
  std::vector<std::string> images;
  for (const auto& [place, image] : out) images.push_back(image);
  return images;
}

void measure_outliers(const std::vector<Eigen::Vector3d>& target_m,
                      const BoardState& state,
                      std::vector<CornerOutlier>& outliers) {
  const auto warped_m = warped_target(target_m, state.warp_m);
  for (CornerOutlier& outlier : outliers) {
    check_camera(state.rig, outlier.camera, outlier.frame);
    if (outlier.id < 0 || outlier.id >= static_cast<int>(target_m.size())) {
      throw Error(fmt::format("frame {}, camera {}", outlier.frame, outlier.camera),
                  fmt::format("the target has no corner {}", outlier.id),
                  "give the outliers of this calibration");
    }
    const auto frame = std::lower_bound(state.frames.begin(), state.frames.end(), outlier.frame);
    if (frame == state.frames.end() || *frame != outlier.frame) {
      outlier.residual_px = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    const Pose& T_first_board = state.T_first_board[frame - state.frames.begin()];
    const Eigen::Vector3d x =
        state.rig.T_camera_first[outlier.camera] * (T_first_board * warped_m[outlier.id]);
    outlier.residual_px = (project(state.rig.cameras[outlier.camera], x) - outlier.pixel_px).norm();
  }
}

}  // namespace vernier::internal
