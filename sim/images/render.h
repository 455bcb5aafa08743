// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/camera.h"
#include "calib/pose.h"
#include "sim/images/image_scene.h"
#include "stereo/grey_levels.h"

namespace vernier::sim::internal {

struct RenderOptions {
  int samples = 4;       ///< per side of a pixel: samples² rays
  bool shadows = false;  ///< of lamps, hard
  int threads = 1;       ///< 0: all cores
};

/// Radiance at the pixels of a camera at T_camera_world, lens distortion included: reflectance
/// times irradiance, 0 to about 1; 0 where nothing is hit or the lens model has no ray.
///
/// A pixel is the mean of samples² rays in a fixed pattern, that of correlated multi-jittered
/// sampling without the jitter (Kensler, "Correlated multi-jittered sampling", 2013): one in every
/// cell of the pixel, and all in different columns and rows, so that an upright edge is placed to
/// 1/samples² px. Rays are exact at the corners of pixels and bilinear between them (below 1e-4 px
/// for the usual lens). A face that a pixel sees is shaded once, in the middle of its samples;
/// textures are band limited (texture.h). Rows are independent: the same bits for any number of
/// threads. Throws Error for options out of range, and for more than 1e8 pixels.
stereo::GreyLevels render(const ImageScene& scene,
                          const Camera& camera,
                          const Pose& T_camera_world,
                          const RenderOptions& options = {});

/// Throws Error for a camera of more than 1e8 pixels, or of none.
void check_image_size(const Camera& camera);

}  // namespace vernier::sim::internal
