// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "stereo/disparity_file.h"
#include "stereo/evaluation/corner_repeatability.h"
#include "stereo/evaluation/edge_loss.h"
#include "stereo/evaluation/end_difference.h"
#include "stereo/evaluation/line_match.h"
#include "stereo/evaluation/segment_shift.h"
#include "stereo/evaluation/warped_segments.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

struct PairSamplesOptions {
  /// Maximum in the left image, strongest first; the right image may have half as many more.
  int corners = 400;
  WarpOptions warp;
  EdgeLossOptions loss;
  SegmentShiftOptions shift;
  EndDifferenceOptions ends;
  CornerRepeatOptions repeat;
  LineMatchOptions lines;
};

/// Samples of every source of error from a rectified pair with ground truth, one per segment or
/// corner.
struct PairSamples {
  std::string name;
  int width_px = 0, height_px = 0;
  std::vector<SegmentLoss> losses;  ///< left segments in the right image
  /// Right segments in the left image, in coordinates of the mirrored right image.
  std::vector<SegmentLoss> losses_to_left;
  std::vector<SegmentShift> shifts;
  std::vector<SegmentEnds> ends;
  std::vector<CornerRepeatability> corners;
  std::vector<CornerError> corner_matches;
  std::vector<LineMatch> lines;
};

/// Detects edges, segments and corners in both images, matches them and compares them with the
/// ground truth (docs/characterise.md). Corners are matched as in match_corners, within the rows
/// and the disparity range. Throws Error for images of different sizes, a range that does not fit
/// them, and errors of the matcher.
PairSamples pair_samples(const RectifiedPair& pair,
                         const StereoTruth& truth,
                         const DisparityRange& range,
                         const Matcher& matcher,
                         const PairSamplesOptions& options = {});

/// Disparities of the right image from the left ground truth, interpolated along the row between
/// left pixels of one surface that are visible in the right image; unknown where no left pixel
/// maps.
DisparityMap truth_of_right(const StereoTruth& truth);

}  // namespace vernier::stereo::internal
