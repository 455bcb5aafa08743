// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "calib/rig_estimate.h"
#include "cli/program/session.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification.h"
#include "stereo/rectification/vertical_field.h"
#include "stereo/rectified_images.h"

namespace vernier::cli {

/// What the command line says of a pair of images.
struct StereoInputOptions {
  std::string left, right, rig, centre_px;
  bool rectified = false, repair = false;
  double f_px = 0, baseline_m = 0, offset_px = 0;
  std::optional<int> max_disparity_px;
  int min_disparity_px = 0, threads = 0;
};

/// A rectified pair with what is known of its cameras.
struct StereoInput {
  RectifiedPair pair;
  std::optional<ValidPixels> left_valid;      ///< of raw images: those that have a source
  std::optional<RectifiedGeometry> geometry;  ///< nothing: disparities are all there is
  std::optional<RigEstimate> estimate;        ///< whose geometry it is
  double offset_px = 0;                       ///< from the images' disparities to the geometry's
  DisparityRange range;
  VerticalField field;
  bool repaired = false;
  std::function<RectifiedPair()> exchanged;  ///< the pair with left and right exchanged
};

/// Reads images and rig, rectifies where they are raw, finds and repairs the vertical field. Says
/// what it did. Throws Error naming file or option.
StereoInput read_stereo_input(const StereoInputOptions& options, Session& session);

}  // namespace vernier::cli
