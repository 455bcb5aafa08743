// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/camera.h"
#include "calib/rig.h"
#include "sim/told_rigs.h"

namespace vernier::sim::internal {

/// How a rig is calibrated anew for each trial and each recorded map.
struct FreshCalibrationOptions {
  int views = 20;                    ///< of the board, in all cameras
  std::optional<CameraModel> model;  ///< that is estimated, of every camera; none: the true rig's
  Chessboard board;
  double pixel_sigma_px = 0.2;  ///< white noise on each coordinate of a simulated corner
  double distance_m = 1.0;      ///< of a simulated board, varied by a third either way
  double tilt_rad = 0.6;        ///< of a simulated board, largest about x and y
  /// The latest so many calibrations are kept, of 3 kB each; those dropped are computed again.
  std::size_t most_kept = 5000;
};

/// One calibration. With a failure there is nothing else; a doubtful one is used all the same.
struct FreshCalibration {
  Rig rig;
  Eigen::MatrixXd covariance;      ///< the honest one, as stated by the calibration
  std::string failure;             ///< what calibrate() threw
  std::string doubt;               ///< its first trust warning
  double cpu_ms = 0, wall_ms = 0;  ///< that it took, with the simulation of its views
};

/// Calibrations of one rig, each from other views of a board, by calibrate() with its checks and
/// its rejection of outliers; the noise is estimated from the residuals.
///
/// Simulated: poses and noise of the views are drawn by (seed, draw, frame), so those of n views
/// are the first n of more. Real: calibration `draw` takes the first `views` of all frames in an
/// order that is drawn by (seed, draw), so they are nested likewise. Each is computed once and
/// kept, the latest `most_kept`. Corners of simulated views that noise carries out of their image
/// are left out.
class FreshCalibrations {
 public:
  FreshCalibrations(Rig truth, const FreshCalibrationOptions& options, std::uint64_t seed);
  /// From real corners. Throws Error if there are fewer frames than `options.views`, or the images
  /// are not those of the true rig's cameras.
  FreshCalibrations(Rig truth,
                    const FreshCalibrationOptions& options,
                    std::uint64_t seed,
                    std::shared_ptr<const BoardObservations> corners);

  std::shared_ptr<const FreshCalibration> of(std::uint32_t draw) const;
  const Rig& truth() const { return truth_; }
  const FreshCalibrationOptions& options() const { return options_; }
  /// How many calibrations are kept.
  std::size_t kept() const;

  /// The views that a calibration takes.
  BoardObservations views_of(std::uint32_t draw) const;

 private:
  FreshCalibration compute(std::uint32_t draw) const;

  Rig truth_;
  FreshCalibrationOptions options_;
  std::uint64_t seed_;
  std::shared_ptr<const BoardObservations> corners_;  // null: simulated
  mutable std::mutex mutex_;
  mutable std::map<std::uint32_t, std::shared_ptr<const FreshCalibration>> known_;
  mutable std::deque<std::uint32_t> latest_;  // numbers of known_, oldest first
};

/// Each draw is told a calibration of its own. Throws Error if psi_c scales a difference of lens
/// models (check_scale).
std::shared_ptr<const ToldRigs> calibrated_rigs(
    std::shared_ptr<const FreshCalibrations> calibrations, double psi_c);

/// The depth that a calibration measures of a point, and its variance as the calibration states it.
struct MeasuredDepth {
  double m = 0, variance_m2 = 0;
};

/// Of a point on the true left axis at `range_m`, from its exact images in the two true cameras.
/// Nothing if its rays do not meet in front of the rig that was found, or a camera of either rig
/// does not see it.
std::optional<MeasuredDepth> measured_depth(const FreshCalibration& calibration,
                                            const Rig& truth,
                                            double range_m);

/// What becomes of calibrations.
struct CalibrationRecord {
  int calibrations = 0;
  int failed = 0, doubtful = 0;
  std::string why_failed, why_doubtful;  ///< the first one's reason
  /// Of the depth of a point on the left axis at `range_m`, over those that did not fail: root mean
  /// square of the error against the truth, and of the standard deviation that each stated; those
  /// by which it has no depth are doubtful and left out. Not a number if none has one.
  double range_m = 5;
  double depth_error_m = 0, depth_sd_m = 0;
};

/// Of these calibrations of one true rig; reasons are those of the first in order.
CalibrationRecord record_of(
    const Rig& truth, const std::vector<std::shared_ptr<const FreshCalibration>>& calibrations);
/// The same of draws 0 to count - 1.
CalibrationRecord record_of(const FreshCalibrations& calibrations, int count);

}  // namespace vernier::sim::internal
