// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/images/image_scene.h"
#include "sim/images/render.h"
#include "sim/images/sensor_response.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification.h"
#include "stereo/rectified_images.h"

namespace vernier::sim::internal {

struct PairOptions {
  RenderOptions render;
  SensorOptions sensor;
};

/// A pair as the cameras of a rig take it, and rectified.
struct RenderedPair {
  stereo::GreyLevels left, right;       ///< with lens distortion, whole grey levels
  stereo::RectifiedImages rectified;    ///< of these
  stereo::RectifiedPair without_noise;  ///< rectified, neither noise nor rounding
  double exposure = 0;                  ///< of both
};

/// Renders both eyes of `rig` with one exposure, from the left image if it is automatic, and
/// rectifies them with `told` and its geometry. Throws Error for options out of range.
RenderedPair rendered_pair(const ImageScene& scene,
                           const Rig& rig,
                           const Rig& told,
                           const stereo::RectifiedGeometry& geometry,
                           const Pose& T_left_world,
                           const PairOptions& options,
                           const SensorDraws& draws);

}  // namespace vernier::sim::internal
