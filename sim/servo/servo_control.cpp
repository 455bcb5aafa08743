// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/servo/servo_control.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "localise/place.h"
#include "sim/differential_drive.h"
#include "sim/servo/door_search.h"
#include "sim/servo/goal_alignment.h"
#include "sim/servo/stereo_line.h"
#include "sim/visual_servo.h"

namespace vernier::sim::internal {

using namespace localise;

namespace {

DriveCommand slowed(double v, double w, const ServoLaw& law) {
  const double too_fast =
      std::max({1.0, std::abs(v) / law.fastest_mps, std::abs(w) / law.fastest_radps});
  return {v / too_fast, w / too_fast, law.frame_s};
}

}  // namespace

DriveCommand approach(const Pose2D& goal, const ServoLaw& law) {
  const double e = std::hypot(goal.x_m, goal.y_m);
  const double alpha = std::atan2(goal.y_m, goal.x_m);
  const double theta = std::remainder(alpha - goal.heading_rad, 2 * std::numbers::pi);
  const double sinc = std::abs(alpha) < 1e-6 ? 1 : std::sin(alpha) / alpha;
  const double v = law.approach_per_s * e * std::cos(alpha);
  const double w = law.bearing_per_s * alpha +
                   law.approach_per_s * std::cos(alpha) * sinc * (alpha + law.curve * theta);
  return slowed(v, w, law);
}

DriveCommand kept_in_view(DriveCommand command,
                          const DesiredView& desired,
                          const Pose2D& goal,
                          double half_width) {
  constexpr double no_further = 0.8, back = 0.9, back_radps = 0.2;
  constexpr double least_cosine = 0.17;  // of the normal: level lines cross the horizon anywhere
  double leftmost = half_width, rightmost = -half_width;
  for (const StereoLine& line : images_of(lines_at(desired, goal), desired.T_right_left)) {
    if (!(std::abs(line.left.x()) > least_cosine)) continue;
    const double at = -line.left.z() / line.left.x();  // where it crosses the horizon
    leftmost = std::min(leftmost, at);
    rightmost = std::max(rightmost, at);
  }
  // Turning to the left moves the image to the right.
  const double over_left = -leftmost / half_width, over_right = rightmost / half_width;
  if (std::min(over_left, over_right) > no_further) return command;
  if (over_right > no_further) command.turn_radps = std::min(command.turn_radps, 0.0);
  if (over_right > back) command.turn_radps = std::min(command.turn_radps, -back_radps);
  if (over_left > no_further) command.turn_radps = std::max(command.turn_radps, 0.0);
  if (over_left > back) command.turn_radps = std::max(command.turn_radps, back_radps);
  return command;
}

DriveCommand settle(const Pose2D& goal, const ServoLaw& law) {
  return slowed(law.settle_per_s * goal.x_m, law.settle_per_s * goal.heading_rad, law);
}

LineTracker::LineTracker(const DesiredView& desired, const Pose2D& goal) : desired_(desired) {
  for (const SpaceLine& line : lines_at(desired, goal)) last_.emplace_back(line);
}

std::optional<GoalFix> LineTracker::track(std::span<const SeenLine> seen,
                                          const Pose2D& step,
                                          const Pose2D& goal) {
  constexpr double gate_px = 8;
  const Pose T_now_last = T_left_left(step, {}, desired_.mount);
  const std::vector<SpaceLine> by_goal = lines_at(desired_, goal);
  std::vector<SpaceLine> expected;
  for (std::size_t i = 0; i < last_.size(); ++i) {
    expected.push_back(last_[i] ? moved(*last_[i], T_now_last) : by_goal[i]);
  }
  const auto matches =
      nearest_lines(desired_, images_of(expected, desired_.T_right_left), seen, gate_px);
  auto fix = goal_by_image_error(desired_, matches);
  last_.assign(last_.size(), std::nullopt);
  for (const LineMatch& match : matches) {
    last_[static_cast<std::size_t>(match.line)] = match.seen.space;
  }
  return fix;
}

void ServoControl::move(const Pose2D& step) { goal_ = relative(goal_, step); }

void ServoControl::correct(const Pose2D& seen) {
  const auto between = [&](double old, double now) { return old + law_.fix_share * (now - old); };
  goal_ = {between(goal_.x_m, seen.x_m), between(goal_.y_m, seen.y_m),
           between(goal_.heading_rad, seen.heading_rad)};
}

void ServoControl::retreat() {
  stage_ = Stage::retreat;
  ++retreats_;
}

std::optional<DriveCommand> ServoControl::next(bool seen, bool touched) {
  constexpr double arrived_m = 0.05, along_m = 0.003, heading_rad = 0.004;
  constexpr int settled_frames = 4;
  if (stage_ == Stage::retreat) {
    if (touched || goal_.x_m > law_.retreat_m) stage_ = Stage::approach;
  } else if (touched) {
    retreat();
  }
  if (stage_ == Stage::approach && goal_.x_m < arrived_m) {
    stage_ = Stage::settle;
    settled_ = 0;
  }
  if (stage_ == Stage::settle) {
    const bool still = std::abs(goal_.x_m) < along_m && std::abs(goal_.heading_rad) < heading_rad;
    settled_ = still && seen ? settled_ + 1 : 0;
    if (settled_ == settled_frames) {
      if (std::abs(goal_.y_m) <= law_.across_tolerance_m) return std::nullopt;
      retreat();
    }
  }
  if (stage_ == Stage::retreat) return DriveCommand{-law_.fastest_mps / 2, 0, law_.frame_s};
  return stage_ == Stage::settle ? settle(goal_, law_) : approach(goal_, law_);
}

}  // namespace vernier::sim::internal
