// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "fuzz/example_rigs.h"

#include <cstddef>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"

namespace vernier::fuzz {

Rig example_rig(const std::string& model, int cameras) {
  Rig rig;
  for (int i = 0; i < cameras; ++i) {
    Camera camera;
    camera.name = default_camera_name(static_cast<std::size_t>(i));
    camera.model = camera_model(model);
    camera.parameters = Eigen::VectorXd::Zero(parameter_count(camera.model));
    camera.parameters.head<4>() << 525 + 3 * i, 1.002 - 0.003 * i, 318 + 4 * i, 242 - 5 * i;
    for (Eigen::Index k = 4; k < camera.parameters.size(); ++k) {
      camera.parameters[k] = (k % 2 == 0 ? -0.1 : 0.02) / static_cast<double>(k * k);
    }
    rig.cameras.push_back(camera);
    rig.T_camera_first.emplace_back();
    if (i == 0) continue;
    rig.T_camera_first.back() = {rotation_from_vector({0.01 * i, -0.02, 0.005}),
                                 Eigen::Vector3d(-0.2 * i, 0.002, -0.003)};
  }
  return rig;
}

std::vector<std::string> example_files(
    std::vector<vernier::internal::ExportedFile> (*write)(const Rig&)) {
  std::vector<std::string> texts;
  for (const char* model : {"pinhole", "radial1", "opencv4", "opencv5", "opencv8", "fisheye4"}) {
    for (int cameras = 1; cameras <= 3; ++cameras) {
      try {
        for (const auto& file : write(example_rig(model, cameras))) texts.push_back(file.text);
      } catch (const Error&) {  // it has no such model, or not so many cameras
      }
    }
  }
  return texts;
}

}  // namespace vernier::fuzz
