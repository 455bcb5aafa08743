// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/differential_drive.h"

namespace vernier::sim {

using namespace vernier::internal;

OdometryError no_odometry_error() { return {0, 0, 0, 0, 0, 0}; }

void check(const OdometryError& error, const std::string& place) {
  constexpr double largest_fraction = 0.1, largest_alpha = 1;
  for (const DriveParameter& p : drive_parameters()) {
    if (!p.error) continue;
    const double value = error.*p.error;
    const double most = p.name.ends_with("_sd") ? largest_fraction : largest_alpha;
    if (value >= 0 && value <= most) continue;
    throw Error(place, fmt::format("{} is {:g}, not between 0 and {:g}", p.name, value, most),
                "correct it");
  }
}

OdometryDraw::OdometryDraw(const DifferentialDrive& drive,
                           const OdometryError& error,
                           std::uint64_t seed,
                           std::uint32_t trial)
    : drive_(drive), error_(error), seed_(seed), trial_(trial) {
  check(drive, "robot");
  check(error, "robot");
  RandomStream draws(
      {.seed = seed, .trial = trial, .source = static_cast<std::uint32_t>(DrawSource::odometry)});
  const double left = draws.normal(), right = draws.normal(), base = draws.normal();
  left_ = 1 + error.wheel_sd * left;
  right_ = 1 + error.wheel_sd * right;
  base_ = 1 + error.wheel_base_sd * base;
}

std::vector<DrivePhase> OdometryDraw::true_phases(std::span<const DrivePhase> phases,
                                                  std::uint32_t frame) const {
  const double base = drive_.wheel_base_m;
  std::vector<DrivePhase> moved(phases.begin(), phases.end());
  double way = 0, turned = 0, duration = 0;
  for (DrivePhase& phase : moved) {
    const auto move = [&](double& speed, double& turn) {
      if (left_ == 1 && right_ == 1 && base_ == 1) return;  // to the bit
      const double left = left_ * (speed - 0.5 * base * turn);
      const double right = right_ * (speed + 0.5 * base * turn);
      speed = 0.5 * (left + right);
      turn = (right - left) / (base_ * base);
    };
    move(phase.speed0_mps, phase.turn0_radps);
    move(phase.speed1_mps, phase.turn1_radps);
    way += phase.way_m();
    turned += phase.turned_rad();
    duration += phase.duration_s;
  }
  RandomStream draws({.seed = seed_,
                      .trial = trial_,
                      .feature = 1,
                      .source = static_cast<std::uint32_t>(DrawSource::odometry),
                      .frame = frame});
  const double turn_noise = draws.normal(), way_noise = draws.normal();
  if (!(duration > 0)) return moved;
  const double turn_sd = std::sqrt(error_.turn_per_turn * turned + error_.turn_per_way * way);
  const double way_sd = std::sqrt(error_.way_per_way * way + error_.way_per_turn * turned);
  for (DrivePhase& phase : moved) {
    for (double* turn : {&phase.turn0_radps, &phase.turn1_radps}) {
      *turn += turn_sd * turn_noise / duration;
    }
    for (double* speed : {&phase.speed0_mps, &phase.speed1_mps}) {
      *speed += way_sd * way_noise / duration;
    }
  }
  return moved;
}

}  // namespace vernier::sim
