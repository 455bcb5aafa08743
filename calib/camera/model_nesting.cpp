// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/camera/model_nesting.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/rig.h"

namespace vernier::internal {

std::vector<CameraModel> richer_models(const CameraModel& model) {
  const std::array<CameraModel, 5> chain{Pinhole{}, Radial1{}, OpenCv4{}, OpenCv5{}, OpenCv8{}};
  const auto own = std::find_if(chain.begin(), chain.end(),
                                [&](const CameraModel& m) { return m.index() == model.index(); });
  if (own == chain.end()) return {};
  return {own + 1, chain.end()};
}

Rig in_models(const Rig& rig, const std::vector<CameraModel>& models) {
  Rig result = rig;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const std::vector<std::string> from = parameter_names(rig.cameras[c].model);
    const std::vector<std::string> to = parameter_names(models[c]);
    Camera& camera = result.cameras[c];
    camera.model = models[c];
    camera.parameters = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(to.size()));
    for (std::size_t i = 0; i < from.size(); ++i) {
      const double value = rig.cameras[c].parameters[static_cast<Eigen::Index>(i)];
      const auto place = std::find(to.begin(), to.end(), from[i]);
      if (place != to.end()) {
        camera.parameters[place - to.begin()] = value;
      } else if (value != 0) {
        throw Error(camera.name + "." + from[i],
                    fmt::format("the model {} has no such coefficient", model_name(models[c])),
                    "choose a model that has it");
      }
    }
  }
  return result;
}

std::vector<CameraModel> models_of(const Rig& rig) {
  std::vector<CameraModel> models;
  for (const Camera& camera : rig.cameras) models.push_back(camera.model);
  return models;
}

}  // namespace vernier::internal
