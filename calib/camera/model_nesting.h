// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/camera.h"
#include "calib/rig.h"

namespace vernier::internal {

/// The models that contain `model` as the case where further coefficients are zero, nearest first:
/// pinhole ⊂ radial1 ⊂ opencv4 ⊂ opencv5 ⊂ opencv8. Empty for opencv8 and fisheye4.
std::vector<CameraModel> richer_models(const CameraModel& model);

/// The rig with cameras of these models, one per camera: coefficients of the same name keep their
/// value, new ones are zero. Throws Error if a non-zero coefficient would be lost.
Rig in_models(const Rig& rig, const std::vector<CameraModel>& models);

/// The models of a rig's cameras.
std::vector<CameraModel> models_of(const Rig& rig);

}  // namespace vernier::internal
