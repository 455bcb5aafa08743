// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "sim/buildings/office.h"
#include "sim/world.h"

/// Generators of the shipped world and rig.
namespace vernier::datasets {

using namespace vernier::sim;
using namespace vernier::sim::internal;

/// A generated office floor of the size used in Tina Memo 2017-001, seed 1.
inline WorldDescription workshop() {
  WorldDescription world = make_office(1);
  world.name = "workshop";
  return world;
}

/// Two cameras of 640 x 480 px, f 525 px, baseline 0.2 m, slight barrel distortion.
inline Rig nominal_truth() {
  Rig rig;
  for (const char* name : {"left", "right"}) {
    Camera camera;
    camera.name = name;
    camera.parameters.resize(5);
    camera.parameters << 525, 1, 319.5, 239.5, -0.05;
    rig.cameras.push_back(camera);
  }
  rig.T_camera_first = {Pose{}, Pose{Eigen::Matrix3d::Identity(), {-0.2, 0, 0}}};
  return rig;
}

/// The calibration of that pair from 20 simulated views of a 9 x 6 board of 40 mm squares at about
/// 0.8 m, with corner noise of 0.2 px.
inline RigEstimate nominal() {
  const SimulatedBoard board =
      simulate_board(nominal_truth(), {9, 6, 0.04},
                     {.seed = 1, .frames = 20, .pixel_sigma_px = 0.2, .distance_m = 0.8});
  return calibrate(board.observations, {.pixel_sigma_px = 0.2, .white_noise = true});
}

}  // namespace vernier::datasets
