// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "localise/place.h"

namespace vernier::sim {

/// A robot with two driven wheels on one axle, as its own software believes it to be. The robot's
/// frame has its origin on the floor below the middle of the axle, which is also below the left
/// camera; x forward, y left, z up.
struct DifferentialDrive {
  double wheel_base_m = 0.4;     ///< between the points where the wheels touch the floor
  double wheel_radius_m = 0.08;  ///< of both
  double max_speed_mps = 1;      ///< of a wheel's rim
  double max_acceleration_mps2 = 2;
  double body_radius_m = 0.2;  ///< the body is an upright cylinder about the origin
};

/// How the true robot differs. Systematic errors are those of Borenstein and Feng, "Measurement and
/// correction of systematic odometry errors in mobile robots", IEEE Trans. Robotics and Automation
/// 12(6), 1996: unequal wheels and a wrong wheel base, one draw a trial. Noise has the roles of the
/// four alphas of Thrun, Burgard and Fox, "Probabilistic Robotics" (2005), section 5.4, but its
/// variances grow linearly with the way, as in Chong and Kleeman, "Accurate odometry and error
/// modelling for a mobile robot", ICRA 1997, so that they do not depend on how a way is cut into
/// steps. The defaults are of the usual order, and ours.
struct OdometryError {
  double wheel_sd = 0.002;       ///< of each wheel's radius, as a fraction, independent
  double wheel_base_sd = 0.005;  ///< of the wheel base, as a fraction
  double turn_per_turn = 1e-4;   ///< alpha 1: variance of heading, rad² per rad turned
  double turn_per_way = 2.5e-5;  ///< alpha 2: variance of heading, rad² per m driven
  double way_per_way = 2.5e-5;   ///< alpha 3: variance of the way, m² per m driven
  double way_per_turn = 1e-6;    ///< alpha 4: variance of the way, m² per rad turned
};

/// All at 0.
OdometryError no_odometry_error();

/// Drive with these speeds for a while. The wheels change their speeds evenly, together, within the
/// limit of acceleration, from those at the end of the step before.
struct DriveCommand {
  double speed_mps = 0;   ///< forward, of the middle of the axle
  double turn_radps = 0;  ///< counter-clockwise
  double duration_s = 0.1;

  bool operator==(const DriveCommand& other) const = default;
};

/// The command for speeds of the rims of the left and the right wheel.
DriveCommand wheel_command(const DifferentialDrive& drive,
                           double left_mps,
                           double right_mps,
                           double duration_s);

/// Throws Error for dimensions and limits that are not finite and above 0.
void check(const DifferentialDrive& drive, const std::string& place);
/// Throws Error for errors that are negative or absurd: a fraction above 0.1, an alpha above 1.
void check(const OdometryError& error, const std::string& place);
/// Throws Error for a number that is not finite, a duration that is not above 0 or longer than
/// 60 s, and a wheel that would be too fast.
void check(const DriveCommand& command, const DifferentialDrive& drive, const std::string& place);

/// One number of the two structs above by name, for the command line.
struct DriveParameter {
  std::string_view name;
  double DifferentialDrive::*drive;  ///< or null
  double OdometryError::*error;      ///< or null
  std::string_view about;
};
std::span<const DriveParameter> drive_parameters();

/// Speeds of the rims, metres per second.
struct WheelSpeeds {
  double left_mps = 0, right_mps = 0;
};

/// A part of a step in which speed and turning change evenly with time.
struct DrivePhase {
  double duration_s = 0;
  double speed0_mps = 0, speed1_mps = 0;  ///< at its start and end
  double turn0_radps = 0, turn1_radps = 0;

  /// Where the robot is `time_s` after the start of the phase, if it begins at (0, 0) with heading
  /// 0. With constant speeds an exact arc of a circle,
  ///
  ///     x = v/w sin(w t),  y = v/w (1 - cos(w t)),  heading = w t,
  ///
  /// otherwise the integral of v(t) (cos, sin)(heading(t)) by Gauss and Legendre's rule to
  /// rounding.
  localise::Pose2D after(double time_s) const;
  double way_m() const;       ///< driven forward and backward, not negative
  double turned_rad() const;  ///< to the left and to the right, not negative
};

/// What the wheels do in a step: a phase in which they change their speeds, and one in which they
/// keep them; either may be missing. `now` is set to the speeds at the end.
std::vector<DrivePhase> wheel_phases(const DifferentialDrive& drive,
                                     const DriveCommand& command,
                                     WheelSpeeds& now);

/// The pose after all of the phases, from (0, 0) with heading 0.
localise::Pose2D after(std::span<const DrivePhase> phases);

/// The error of one robot in one trial: its wheels, drawn once, and the noise of each step.
class OdometryDraw {
 public:
  /// Draws: counter (trial), source 34. Throws Error as check() does.
  OdometryDraw(const DifferentialDrive& drive,
               const OdometryError& error,
               std::uint64_t seed,
               std::uint32_t trial);

  /// The true motion while the robot believes `phases`, in the step that ends with `frame`. The
  /// noise is spread evenly over the step. Draws: counter (trial, feature 1, frame).
  std::vector<DrivePhase> true_phases(std::span<const DrivePhase> phases,
                                      std::uint32_t frame) const;

 private:
  DifferentialDrive drive_;
  OdometryError error_;
  std::uint64_t seed_;
  std::uint32_t trial_;
  double left_ = 1, right_ = 1, base_ = 1;  ///< true over believed
};

}  // namespace vernier::sim
