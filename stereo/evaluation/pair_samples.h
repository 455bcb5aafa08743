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
  int corners = 400;  ///< strongest ones of the left image; the right one has half as many again
  WarpOptions warp;
  EdgeLossOptions loss;
  SegmentShiftOptions shift;
  EndDifferenceOptions ends;
  CornerRepeatOptions repeat;
  LineMatchOptions lines;
};

/// What a rectified pair with ground truth tells of each source of error, one sample a segment or
/// corner.
struct PairSamples {
  std::string name;
  int width_px = 0, height_px = 0;
  std::vector<SegmentLoss> losses;          ///< of left segments in the right image
  std::vector<SegmentLoss> losses_to_left;  ///< and of right ones in the left image, in places of
                                            ///< the right image seen in a mirror
  std::vector<SegmentShift> shifts;
  std::vector<SegmentEnds> ends;
  std::vector<CornerRepeatability> corners;
  std::vector<CornerError> corner_matches;
  std::vector<LineMatch> lines;
};

/// Finds edges, segments and corners in both images, matches them, and holds them against the truth
/// (docs/characterise.md). Corners are matched as match_corners does, within the rows and the range
/// of disparities. Throws Error on images of unequal size, a range that does not fit them, and
/// whatever the matcher throws.
PairSamples pair_samples(const RectifiedPair& pair,
                         const StereoTruth& truth,
                         const DisparityRange& range,
                         const Matcher& matcher,
                         const PairSamplesOptions& options = {});

/// The right image's disparities by the left one's truth, interpolated along the row between left
/// pixels of one surface that the right image shows; not known where no left pixel falls.
DisparityMap truth_of_right(const StereoTruth& truth);

}  // namespace vernier::stereo::internal
