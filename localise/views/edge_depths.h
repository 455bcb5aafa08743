// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/image/depth_image.h"
#include "stereo/matcher.h"

namespace vernier::localise::internal {

/// The standard deviation of a depth z is √(floor² + (per_m2 z²)²). The first part is noise, new at
/// each pixel; the second is common to the pixels of an edge. Its default is that of structured
/// light (Khoshelham and Oude Elberink, "Accuracy and resolution of Kinect depth data", Sensors 12,
/// 2012: 1.4e-3).
struct DepthNoise {
  double floor_m = 0.01;
  double per_m2 = 1.5e-3;  ///< of z², 1/m
};

/// d = f / z at the edge points of an image, by an aligned depth map; not a number where it is not
/// known. The depth of either side is that of a plane through the pixels at 1 to 5 px across, whose
/// inverse depth is linear in the image, at the edge; their median where they lie on none. The
/// pixels end at the next edge if three are left before it, and the nearest, which may hold both
/// sides, is left out where the others lie on a plane without it. Where both sides differ by more
/// than 3 standard deviations and 2 %, the edge is that of the nearer surface, which hides the
/// other one; else it is their mean. Where one side is not known, the other counts only if what is
/// known beyond it, up to 40 px, is not nearer; if nothing is, the edge has no depth. Noise is not
/// taken for less than a pixel's: that of neighbours is alike in real maps.
std::vector<stereo::EdgeDisparity> inverse_depths(const std::vector<stereo::EdgePoint>& edges,
                                                  const stereo::internal::DepthImage& depth,
                                                  double f_px,
                                                  const DepthNoise& noise);

}  // namespace vernier::localise::internal
