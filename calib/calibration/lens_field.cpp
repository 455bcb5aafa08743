// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/lens_field.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <variant>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {
namespace {

/// Corners whose pixels are within do not mislead the start, whose focal length may be 10 % off.
constexpr double surely_within_rad = 80 * 3.14159265358979323846 / 180;

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

/// The corners for which `is_kept` is true, in images that these determine the pose of.
template <class Keep>
BoardObservations kept(const BoardObservations& all, const Keep& is_kept) {
  BoardObservations some{all.size_px, all.target_m, {}};
  for (const BoardView& view : all.views) {
    BoardView own{view.frame, view.camera, view.image, {}, {}};
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      if (!is_kept(view, i)) continue;
      own.ids.push_back(view.ids[i]);
      own.pixels_px.push_back(view.pixels_px[i]);
    }
    const bool whole = own.ids.size() == view.ids.size();
    if (whole || determines_pose(all.target_m, own.ids)) some.views.push_back(std::move(own));
  }
  return some;
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

/// Of the corners of frames that the state places, those before their camera and within its field.
BoardObservations within_field(const BoardObservations& all, const BoardState& state) {
  return kept(all, [&](const BoardView& view, std::size_t i) {
    const auto frame = std::lower_bound(state.frames.begin(), state.frames.end(), view.frame);
    if (frame == state.frames.end() || *frame != view.frame) return false;
    if (!is_fisheye(state.rig.cameras[view.camera])) return true;
    const Pose& T_first_board = state.T_first_board[frame - state.frames.begin()];
    const Eigen::Vector3d x =
        state.rig.T_camera_first[view.camera] * (T_first_board * all.target_m[view.ids[i]]);
    return std::atan2(x.head<2>().norm(), x.z()) < fisheye_field_rad;
  });
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
                            std::vector<std::string>& warnings) {
  constexpr int most_rounds = 6;
  const std::vector<Camera>& cameras = state.rig.cameras;
  BoardObservations within = kept(observations, [&](const BoardView& view, std::size_t i) {
    return !is_beyond(cameras[view.camera], view.pixels_px[i], surely_within_rad);
  });
  if (same_corners(within, observations)) return;
  ReprojectionProblem hasty;
  hasty.must_converge = false;
  BoardState found;
  try {
    std::vector<CameraModel> models;
    for (const Camera& camera : cameras) models.push_back(camera.model);
    found = minimise_reprojection(within, initial_state(within, models), hasty);
    for (int round = 0; round < most_rounds; ++round) {
      BoardObservations next = within_field(observations, found);
      if (same_corners(next, within)) break;
      within = std::move(next);
      found = minimise_reprojection(within, at_frames(found, frames_of(within)), hasty);
    }
  } catch (const Error&) {  // too little is left: the start stays
    return;
  }
  if (same_corners(within, observations)) return;
  for (int c = 0; c < static_cast<int>(cameras.size()); ++c) {
    const std::size_t all = corners_of(observations, c), left = corners_of(within, c);
    if (left == all) continue;
    warnings.push_back(fmt::format(
        "{} of {} corners of camera \"{}\" lie 90 degrees from its axis or beyond, where {} has no "
        "rays: left out",
        all - left, all, cameras[c].name, model_name(cameras[c].model)));
  }
  observations = std::move(within);
  state = std::move(found);
}

}  // namespace vernier::internal
