// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/lens_field.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>

#include "calib/board/board_pose.h"
#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {
namespace {

/// Corners whose pixels are within do not mislead the start, whose focal length may be 10 % off.
constexpr double surely_within_rad = 80 * std::numbers::pi / 180;

bool is_fisheye(const Camera& camera) { return std::holds_alternative<Fisheye4>(camera.model); }

/// Radius in the normalised image of a ray at this angle from the axis, θ (1 + k1 θ² + …); nothing
/// if the polynomial does not rise up to there.
std::optional<double> radius_of(const Camera& camera, double angle_rad) {
  constexpr int steps = 64;
  const auto k = camera.parameters.tail<4>();
  double last = 0;
  for (int i = 1; i <= steps; ++i) {
    const double t = angle_rad * i / steps, t2 = t * t;
    const double radius = t * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
    if (!(radius > last)) return std::nullopt;
    last = radius;
  }
  return last;
}

std::size_t corners_of(const BoardObservations& observations, int camera) {
  std::size_t corners = 0;
  for (const BoardView& view : observations.views) {
    if (view.camera == camera) corners += view.ids.size();
  }
  return corners;
}

bool same_corners(const BoardObservations& a, const BoardObservations& b) {
  return std::equal(a.views.begin(), a.views.end(), b.views.begin(), b.views.end(),
                    [](const BoardView& v, const BoardView& w) {
                      return v.frame == w.frame && v.camera == w.camera && v.ids == w.ids;
                    });
}

/// The corners whose pixels show what is up to `angle_rad` from the axis.
BoardObservations seen_within(const BoardObservations& all, const Rig& rig, double angle_rad) {
  return with_corners(all, [&](const BoardView& view, std::size_t i) {
    return !is_beyond(rig.cameras[view.camera], view.pixels_px[i], angle_rad);
  });
}

/// With the other frames of `all` placed by what their pixels show within the field, as far as a
/// pose fits it.
BoardState with_all_placed(const BoardObservations& all, const BoardState& found) {
  BoardState placed = found;
  const auto target_m = warped_target(all.target_m, found.warp_m);
  const BoardObservations seen = seen_within(all, found.rig, fisheye_field_rad);
  for (const int frame : frames_of(seen)) {
    const auto at = std::lower_bound(placed.frames.begin(), placed.frames.end(), frame);
    if (at != placed.frames.end() && *at == frame) continue;
    try {
      const std::vector<BoardView> views = at_frames(seen, {frame}).views;
      const Pose pose = find_board_pose(target_m, views, found.rig).T_first_board;
      placed.T_first_board.insert(placed.T_first_board.begin() + (at - placed.frames.begin()),
                                  pose);
      placed.frames.insert(at, frame);
    } catch (const Error&) {  // it is counted as without a pose
    }
  }
  return placed;
}

/// Where a corner is: within the field of its lens model, beyond it, or in a frame without a pose.
enum class Place { within, beyond, unknown };

Place place_of(const BoardObservations& all,
               const BoardState& placed,
               const BoardView& view,
               std::size_t corner) {
  const auto frame = std::lower_bound(placed.frames.begin(), placed.frames.end(), view.frame);
  if (frame == placed.frames.end() || *frame != view.frame) return Place::unknown;
  if (!is_fisheye(placed.rig.cameras[view.camera])) return Place::within;
  const Pose& T_first_board = placed.T_first_board[frame - placed.frames.begin()];
  const Eigen::Vector3d x =
      placed.rig.T_camera_first[view.camera] * (T_first_board * all.target_m[view.ids[corner]]);
  return std::atan2(x.head<2>().norm(), x.z()) < fisheye_field_rad ? Place::within : Place::beyond;
}

/// What camera `c` loses where `left` stays, in words. Good corners are lost with images that show
/// too little within.
void warn_of_loss(const BoardObservations& all,
                  const BoardObservations& left,
                  const BoardState& placed,
                  int c,
                  std::vector<std::string>& warnings) {
  std::size_t beyond = 0, unknown = 0;
  for (const BoardView& view : all.views) {
    if (view.camera != c) continue;
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const Place place = place_of(all, placed, view, i);
      beyond += place == Place::beyond;
      unknown += place == Place::unknown;
    }
  }
  const Camera& camera = placed.rig.cameras[c];
  const std::size_t corners = corners_of(all, c);
  const std::size_t others = corners - corners_of(left, c) - beyond - unknown;
  if (beyond > 0) {
    warnings.push_back(fmt::format(
        "{} of {} corners of camera \"{}\" lie {} degrees from its axis or beyond, where {} has no "
        "rays: left out{}",
        beyond, corners, camera.name, fisheye_field_deg, model_name(camera.model),
        others == 0
            ? ""
            : fmt::format(", with them {} within, of images that show too little else", others)));
  }
  if (unknown > 0) {
    warnings.push_back(fmt::format(
        "{} of {} corners of camera \"{}\" were left out: no pose of the board fits what their "
        "frames show within {} degrees of the axis; inspect these images",
        unknown, corners, camera.name, fisheye_field_deg));
  }
}

}  // namespace

bool is_beyond(const Camera& camera, const Eigen::Vector2d& pixel, double angle_rad) {
  if (!is_fisheye(camera)) return false;
  const std::optional<double> radius = radius_of(camera, angle_rad);
  const Eigen::Vector2d x((pixel[0] - camera.ox_px()) / (camera.f_px() * camera.ax()),
                          (pixel[1] - camera.oy_px()) / camera.f_px());
  return radius && x.norm() > *radius;
}

void leave_out_beyond_field(BoardObservations& observations,
                            BoardState& state,
                            const std::vector<HeldParameter>& held,
                            ReprojectionProblem problem,
                            std::vector<std::string>& warnings) {
  constexpr int most_rounds = 6;  // one to four settle; a corner that flickers at the limit ends it
  const int cameras = static_cast<int>(state.rig.cameras.size());
  BoardObservations within = seen_within(observations, state.rig, surely_within_rad);
  if (same_corners(within, observations)) return;
  problem.must_converge = false;
  BoardState found, placed;
  try {
    BoardState start = initial_state(within, models_of(state.rig));
    start.rig = with_held_values(start.rig, held);
    found = minimise_reprojection(within, start, problem);
    for (int round = 0; round < most_rounds; ++round) {
      placed = with_all_placed(observations, found);
      BoardObservations next =
          with_corners(observations, [&](const BoardView& view, std::size_t i) {
            return place_of(observations, placed, view, i) == Place::within;
          });
      if (same_corners(next, within)) break;
      within = std::move(next);
      found = minimise_reprojection(within, at_frames(placed, frames_of(within)), problem);
    }
  } catch (const Error& error) {  // too little is left: the start stays
    for (int c = 0; c < cameras; ++c) {
      const std::size_t all = corners_of(observations, c), left = corners_of(within, c);
      if (left == all) continue;
      warnings.push_back(fmt::format(
          "{} of {} corners of camera \"{}\" may lie beyond the field of {} and were kept: the "
          "others do not calibrate by themselves ({}); show the board nearer to the middle too",
          all - left, all, state.rig.cameras[c].name, model_name(state.rig.cameras[c].model),
          error.what()));
    }
    return;
  }
  if (same_corners(within, observations)) return;
  for (int c = 0; c < cameras; ++c) warn_of_loss(observations, within, placed, c, warnings);
  observations = std::move(within);
  state = std::move(found);
}

}  // namespace vernier::internal
