// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iterator>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::test {

/// A pair like the shipped rig, with distortion: 640 x 480, f 525 px, baseline 0.2 m.
inline Rig stereo_rig(const CameraModel& model = Radial1{}) {
  Rig rig;
  for (int i = 0; i < 2; ++i) {
    Camera camera;
    camera.name = i == 0 ? "left" : "right";
    camera.model = model;
    camera.parameters = Eigen::VectorXd::Zero(parameter_count(model));
    camera.parameters.head<4>() << 525 + 3 * i, 1.002 - 0.003 * i, 318 + 4 * i, 242 - 5 * i;
    for (Eigen::Index k = 4; k < camera.parameters.size(); ++k) {
      constexpr double radial[] = {-0.12, 0.04, 4e-4, -3e-4, -0.01, 0.02, 0.01, 0.005};
      static_assert(std::size(radial) >= max_distortion_count);
      camera.parameters[k] = radial[k - 4] * (1 + 0.1 * i);
    }
    rig.cameras.push_back(camera);
  }
  rig.T_camera_first = {Pose{}, Pose{rotation_from_vector({0.01, -0.02, 0.005}),
                                     Eigen::Vector3d(-0.2, 0.002, -0.003)}};
  return rig;
}

}  // namespace vernier::test
