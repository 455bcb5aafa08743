// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/rig_estimate.h"
#include "cli/program/session.h"
#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/rectification.h"
#include "stereo/rectification/vertical_field.h"
#include "stereo/rectified_images.h"

namespace vernier::cli {

/// Options of a stereo pair from the command line.
struct StereoInputOptions {
  std::string left, right, rig, centre_px;
  bool rectified = false, repair = false;
  double f_px = 0, baseline_m = 0, offset_px = 0;
  std::optional<int> min_disparity_px, max_disparity_px;
  int threads = 0;
};

/// A rectified pair with information on its cameras.
struct StereoInput {
  RectifiedPair pair;
  /// Of raw images: pixels with a source.
  std::optional<ValidPixels> left_valid, right_valid;
  std::optional<RectifiedGeometry> geometry;  ///< empty: disparities only
  std::optional<RigEstimate> estimate;        ///< the rig of this geometry
  double offset_px = 0;                       ///< added to image disparities to get the geometry's
  DisparityRange range;
  VerticalField field;
  bool repaired = false;
  std::function<RectifiedPair()> exchanged;  ///< the pair with left and right swapped
};

/// Reads images and rig, rectifies raw images, estimates and corrects the vertical field, and
/// reports what was done. Throws Error naming file or option.
StereoInput read_stereo_input(const StereoInputOptions& options, Session& session);

/// Takes out matches with pixels of the right image that have no source.
void drop_blank_matches(const StereoInput& input,
                        const std::vector<EdgePoint>& edges,
                        std::vector<EdgeDisparity>& found);

}  // namespace vernier::cli
