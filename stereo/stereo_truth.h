// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"

namespace vernier::stereo {

/// Ground truth at the pixels of the left image of a rectified pair.
struct StereoTruth {
  DisparityMap disparity;
  std::vector<std::uint8_t> occluded;  ///< one a pixel: 1 where the right image does not show it
};

/// Finds the left pixels that the right image does not show. The left pixel x is at x − d of the
/// right image. It is occluded where
///
///  - that is outside of the image;
///  - another left pixel of the row, more than 1 px nearer, falls on the same right pixel, and
///    between the two the row is folded: x − d falls from one known pixel to the next. A slanted
///    surface seen as a whole has a disparity gradient below 1 and no fold;
///  - or the right image's truth, if there is one, has no disparity within 1 px of d there, nor on
///    both sides of it.
///
/// Throws Error where the two maps have different sizes or nothing is known.
StereoTruth stereo_truth(DisparityMap left, const DisparityMap* right = nullptr);

/// Ground truth at an edge point of the left image.
struct TruthAtEdge {
  /// Where the 3 x 3 pixels about the edge point hold a step, the foreground's, which is the
  /// largest of them; else, interpolated along the row, that of the sub-pixel edge.
  float disparity_px = std::numeric_limits<float>::quiet_NaN();
  bool known = false;     ///< at the edge's nearest pixel
  bool occluded = false;  ///< of the pixel that the disparity is of
  float own_px = std::numeric_limits<float>::quiet_NaN();  ///< along the row, whatever is about it
  bool own_occluded = false;                               ///< of the edge's own pixel
  bool discontinuity = false;  ///< a step in the 5 x 5 pixels, or something unknown in the 3 x 3
  float min_px = std::numeric_limits<float>::quiet_NaN();  ///< of the 3 x 3 pixels
  float max_px = std::numeric_limits<float>::quiet_NaN();  ///< of the 3 x 3 pixels
  /// Where the right image's rows are wrong (stereo/evaluation/warped_pair.h): how much more
  /// disparity the edge has where it crosses the row there. All between the point's and the
  /// crossing's is right.
  float crossing_px = 0;
};

/// The truth where each edge crosses its row (EdgePoint::row_x_px). A step is between two known
/// pixels next to each other along a row or column, or with only unknown ones between, whose
/// disparities differ by more than their distance: no surface seen by both eyes does that. Throws
/// Error for edges outside the map.
std::vector<TruthAtEdge> truth_at(const StereoTruth& truth, const std::vector<EdgePoint>& edges);

}  // namespace vernier::stereo
