// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "cli/program/namespaces.h"
#include "cli/program/session.h"
#include "cli/simulation/source_options.h"
#include "localise/place.h"

namespace vernier::cli {

struct OdometryOptions {
  std::string left, right, world, rig, truth, output;
  double rate_hz = 1, segment_m = 10;
  int corners = 1200;
  // simulated robot
  int drives = 1, leg = 0;
  double step_m = 0.25, turn_deg = 5, height_m = 1.2, pitch_deg = 0;
  SourceOptions sources;
  std::uint64_t seed = 1;
};

/// Corners along a path, the rig that the estimator is told, and the true poses where known.
struct OdometryDrive {
  Rig rig;
  Eigen::MatrixXd calibration;  ///< covariance of the rig's parameters; empty if not known
  std::vector<std::vector<StereoCorner>> moments;
  std::vector<Pose> T_world_left;  ///< true; empty if not known
};

/// The drive of image pairs.
OdometryDrive drive_of_images(const OdometryOptions& options, Session& session);

/// Drives of a simulated robot one after the other, each with draws of its own: memory does not
/// depend on their number.
void for_each_simulated_drive(const OdometryOptions& options,
                              Session& session,
                              const std::function<void(const OdometryDrive&)>& use);

}  // namespace vernier::cli
