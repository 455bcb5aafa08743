// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/resized_rig.h"

#include <fmt/format.h>

#include <cstddef>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {
namespace {

double width_ratio(const Camera& camera, const Eigen::Vector2i& size_px) {
  return static_cast<double>(size_px[0]) / camera.size_px[0];
}

void resize(Camera& camera, const Eigen::Vector2i& size_px) {
  check_parameters(camera);
  const double s = width_ratio(camera, size_px);
  const double middle = 0.5 * (camera.size_px[1] - 1), new_middle = 0.5 * (size_px[1] - 1);
  double &ox = camera.parameters[2], &oy = camera.parameters[3];
  camera.parameters[0] *= s;
  ox = s * (ox + 0.5) - 0.5;
  oy = new_middle + s * (oy - middle);
  camera.size_px = size_px;
}

}  // namespace

RigEstimate resized(const RigEstimate& estimate, const Eigen::Vector2i& size_px) {
  if ((size_px.array() < 1).any()) {
    throw Error("rig", fmt::format("a size of {}x{} px", size_px[0], size_px[1]),
                "give a size of at least one pixel");
  }
  RigEstimate result;
  result.rig = estimate.rig;
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(parameter_count(estimate.rig));
  for (std::size_t c = 0; c < result.rig.cameras.size(); ++c) {
    Camera& camera = result.rig.cameras[c];
    const Eigen::Index first = intrinsics_index(estimate.rig, static_cast<int>(c));
    for (const int k : {0, 2, 3}) scale[first + k] = width_ratio(camera, size_px);  // f, ox, oy
    resize(camera, size_px);
  }
  const auto scaled = [&](const Eigen::MatrixXd& matrix) -> Eigen::MatrixXd {
    return scale.asDiagonal() * matrix * scale.asDiagonal();
  };
  result.covariance = estimate.covariance;
  if (result.covariance) result.covariance->matrix = scaled(result.covariance->matrix);
  if (estimate.covariance_mvb) result.covariance_mvb = scaled(*estimate.covariance_mvb);
  return result;
}

}  // namespace vernier::internal
