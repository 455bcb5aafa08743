// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/differential_drive.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/error.h"
#include "localise/place.h"

namespace vernier::sim {

using namespace localise;

namespace {

constexpr double longest_step_s = 60;

/// Abscissae above 0 and weights of Gauss and Legendre's rule of 8 points on [-1, 1].
constexpr std::array<std::array<double, 2>, 4> gauss{{{0.1834346424956498, 0.3626837833783620},
                                                      {0.5255324099163290, 0.3137066458778873},
                                                      {0.7966664774136267, 0.2223810344533745},
                                                      {0.9602898564975363, 0.1012285362903763}}};

/// Way of a point along an arc: from (0, 0) with heading 0.
Pose2D arc(double way_m, double turn_rad) {
  // sin(a)/a and (1 - cos a)/a, of which the second is that of the half angle
  const double half = turn_rad / 2;
  const double sinc = std::abs(half) < 1e-4 ? 1 - half * half / 6 : std::sin(half) / half;
  return {way_m * sinc * std::cos(half), way_m * sinc * std::sin(half), turn_rad};
}

/// Integral of |a + (b - a) t / d| over d.
double absolute_integral(double a, double b, double d) {
  if (a * b >= 0) return 0.5 * std::abs(a + b) * d;
  return 0.5 * d * (a * a + b * b) / (std::abs(a) + std::abs(b));
}

void need(bool holds, const std::string& place, const std::string& fault, const char* remedy) {
  if (!holds) throw Error(place, fault, remedy);
}

}  // namespace

DriveCommand wheel_command(const DifferentialDrive& drive,
                           double left_mps,
                           double right_mps,
                           double duration_s) {
  return {0.5 * (left_mps + right_mps), (right_mps - left_mps) / drive.wheel_base_m, duration_s};
}

void check(const DifferentialDrive& drive, const std::string& place) {
  constexpr double most = 100, least = 1e-3;
  for (const DriveParameter& p : drive_parameters()) {
    if (!p.drive) continue;
    const double value = drive.*p.drive;
    need(value >= least && value <= most, place,
         fmt::format("{} is {:g}, not between 0.001 and 100", p.name, value), "correct it");
  }
}

void check(const DriveCommand& command, const DifferentialDrive& drive, const std::string& place) {
  need(std::isfinite(command.speed_mps) && std::isfinite(command.turn_radps), place,
       "a speed is not a finite number", "give metres and radians per second");
  constexpr double fastest_turn_radps = 50;  // whose way is integrated in pieces of 0.25 rad
  need(std::abs(command.turn_radps) <= fastest_turn_radps, place,
       fmt::format("it turns at {:.3g} rad/s, more than {:g}", command.turn_radps,
                   fastest_turn_radps),
       "command less turning");
  need(command.duration_s > 0 && command.duration_s <= longest_step_s, place,
       fmt::format("the duration of {:g} s is not above 0 and at most {:g} s", command.duration_s,
                   longest_step_s),
       "correct it, or give several commands");
  const double fastest =
      std::abs(command.speed_mps) + 0.5 * drive.wheel_base_m * std::abs(command.turn_radps);
  constexpr double rounding = 1e-9;
  need(fastest <= drive.max_speed_mps * (1 + rounding), place,
       fmt::format("a wheel would run at {:.3g} m/s, more than max_speed_mps = {:g}", fastest,
                   drive.max_speed_mps),
       "command less speed or turning");
}

Pose2D DrivePhase::after(double time_s) const {
  const double v = speed0_mps, w = turn0_radps, t = time_s;
  if (speed0_mps == speed1_mps && turn0_radps == turn1_radps) return arc(v * t, w * t);
  const double dv = (speed1_mps - v) / duration_s, dw = (turn1_radps - w) / duration_s;
  const auto heading = [&](double s) { return w * s + 0.5 * dw * s * s; };
  constexpr double widest_rad = 0.25;
  const double turned = absolute_integral(w, w + dw * t, t);
  const int pieces = 1 + static_cast<int>(turned / widest_rad);
  Pose2D end{0, 0, heading(t)};
  for (int piece = 0; piece < pieces; ++piece) {
    const double half = 0.5 * t / pieces, middle = (2 * piece + 1) * half;
    for (const auto& [node, weight] : gauss) {
      for (const double s : {middle - node * half, middle + node * half}) {
        end.x_m += weight * half * (v + dv * s) * std::cos(heading(s));
        end.y_m += weight * half * (v + dv * s) * std::sin(heading(s));
      }
    }
  }
  return end;
}

double DrivePhase::way_m() const { return absolute_integral(speed0_mps, speed1_mps, duration_s); }

double DrivePhase::turned_rad() const {
  return absolute_integral(turn0_radps, turn1_radps, duration_s);
}

std::vector<DrivePhase> wheel_phases(const DifferentialDrive& drive,
                                     const DriveCommand& command,
                                     WheelSpeeds& now) {
  const double base = drive.wheel_base_m;
  const auto speed = [](const WheelSpeeds& w) { return 0.5 * (w.left_mps + w.right_mps); };
  const auto turn = [&](const WheelSpeeds& w) { return (w.right_mps - w.left_mps) / base; };
  const WheelSpeeds wanted{command.speed_mps - 0.5 * base * command.turn_radps,
                           command.speed_mps + 0.5 * base * command.turn_radps};
  const double change = std::max(std::abs(wanted.left_mps - now.left_mps),
                                 std::abs(wanted.right_mps - now.right_mps));
  const double needed_s = change / drive.max_acceleration_mps2;
  const double ramp_s = std::min(needed_s, command.duration_s);
  const double share = ramp_s < needed_s ? ramp_s / needed_s : 1;
  const WheelSpeeds reached{now.left_mps + share * (wanted.left_mps - now.left_mps),
                            now.right_mps + share * (wanted.right_mps - now.right_mps)};
  std::vector<DrivePhase> phases;
  if (ramp_s > 0) {
    phases.push_back({ramp_s, speed(now), speed(reached), turn(now), turn(reached)});
  }
  if (command.duration_s > ramp_s) {
    const double v = speed(reached), w = turn(reached);
    phases.push_back({command.duration_s - ramp_s, v, v, w, w});
  }
  now = reached;
  return phases;
}

Pose2D after(std::span<const DrivePhase> phases) {
  Pose2D pose;
  for (const DrivePhase& phase : phases) pose = compose(pose, phase.after(phase.duration_s));
  return pose;
}

std::span<const DriveParameter> drive_parameters() {
  using D = DifferentialDrive;
  using E = OdometryError;
  static constexpr std::array<DriveParameter, 11> parameters{{
      {"wheel_base_m", &D::wheel_base_m, nullptr, "distance of the wheels"},
      {"wheel_radius_m", &D::wheel_radius_m, nullptr, "radius of the wheels"},
      {"max_speed_mps", &D::max_speed_mps, nullptr, "largest speed of a wheel's rim"},
      {"max_acceleration_mps2", &D::max_acceleration_mps2, nullptr, "largest change of it"},
      {"body_radius_m", &D::body_radius_m, nullptr, "radius of the body"},
      {"wheel_sd", nullptr, &E::wheel_sd, "error of each wheel's radius, as a fraction"},
      {"wheel_base_sd", nullptr, &E::wheel_base_sd, "error of the wheel base, as a fraction"},
      {"turn_per_turn", nullptr, &E::turn_per_turn, "variance of heading, rad2 per rad"},
      {"turn_per_way", nullptr, &E::turn_per_way, "variance of heading, rad2 per m"},
      {"way_per_way", nullptr, &E::way_per_way, "variance of the way, m2 per m"},
      {"way_per_turn", nullptr, &E::way_per_turn, "variance of the way, m2 per rad"},
  }};
  return parameters;
}

}  // namespace vernier::sim
