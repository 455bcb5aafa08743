// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/servo/desired_view.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/mount_error.h"
#include "sim/noise_free_view.h"
#include "sim/robot.h"
#include "sim/sense.h"
#include "sim/servo/goal_alignment.h"
#include "sim/servo/stereo_line.h"
#include "sim/visual_servo.h"

namespace vernier::sim::internal {

namespace {

constexpr std::uint32_t recorded_trial = 0x80000000u;
constexpr std::uint32_t last_frame = (1u << 22) - 1;

/// By length, and without those beside a longer one.
std::vector<SeenLine> chosen(std::vector<SeenLine> lines, double focal_px) {
  constexpr double shortest_px = 60, beside_px = 6;
  std::stable_sort(lines.begin(), lines.end(),
                   [](const SeenLine& a, const SeenLine& b) { return a.length_px > b.length_px; });
  std::vector<SeenLine> kept;
  for (SeenLine& line : lines) {
    if (line.length_px < shortest_px) break;
    const bool beside = std::any_of(kept.begin(), kept.end(), [&](const SeenLine& longer) {
      const Eigen::Vector4d d = difference(line.image, longer.image).cwiseAbs();
      return focal_px * d[0] < beside_px && line.length_px / 2 * d[1] < beside_px;
    });
    if (!beside) kept.push_back(std::move(line));
  }
  return kept;
}

/// The door's edges from the goal, as the rig that is told would image them.
std::vector<SeenLine> by_model(const Robot& robot, const ServoPlace& place) {
  constexpr double least_cosine = 0.17;  // of the left line's normal to the baseline
  const Rig& told = robot.told_rig();
  const Pose& T = told.T_camera_first[1];
  const Eigen::Vector2d baseline = (T.R.transpose() * T.t).head<2>().normalized();
  const NoiseFreeViewOptions looking = look_from({robot.options().mount, 0});
  std::vector<SeenLine> lines;
  for (const VisibleEdge& edge : look(place.visibility, place.rig.rig, place.goal, looking).edges) {
    if (edge.object != place.door) continue;
    const SpaceLine space{0.5 * (edge.a_m + edge.b_m), (edge.b_m - edge.a_m).normalized()};
    const StereoLine image = image_of(space, told.T_camera_first[1]);
    const double length_px =
        (project(told.cameras[0], edge.b_m) - project(told.cameras[0], edge.a_m)).norm();
    if (std::abs(image.left.head<2>().dot(baseline)) > least_cosine)
      lines.push_back({image, space, length_px});
  }
  return lines;
}

std::vector<SeenLine> marked(const Robot& robot,
                             const ServoPlace& place,
                             const StereoObservation& view) {
  std::vector<SeenLine> lines;
  for (std::size_t i = 0; i < view.segments.size(); ++i) {
    const VisibleEdge& edge = view.true_edges[i];
    if (edge.is_false() || edge.object != place.door) continue;
    if (auto line = see(robot.told_rig(), view.segments[i])) lines.push_back(std::move(*line));
  }
  return lines;
}

}  // namespace

DesiredView desired_view(const Robot& robot,
                         const ServoPlace& place,
                         ServoGoal kind,
                         const ServoDraw& draw,
                         std::string& failure) {
  DesiredView desired;
  desired.mount = robot.options().mount;
  desired.T_right_left = robot.told_rig().T_camera_first[1];
  desired.focal_px = robot.told_rig().cameras[0].f_px();
  std::vector<SeenLine> lines;
  if (kind == ServoGoal::model) {
    lines = by_model(robot, place);
  } else {
    StereoObservation view;
    if (kind == ServoGoal::taught) {
      view = robot.view_from(place.goal, last_frame);
    } else {
      Robot of_that_day = robot;
      view = of_that_day.reset(draw.seed, recorded_trial + draw.trial, place.goal).view;
    }
    failure = view.failure;
    lines = marked(robot, place, view);
  }
  desired.lines = chosen(std::move(lines), desired.focal_px);
  return desired;
}

}  // namespace vernier::sim::internal
