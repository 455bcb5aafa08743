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
  std::vector<std::uint8_t> occluded;  ///< one per pixel: 1 if not visible in the right image
  /// Most known pixels have an unknown one around them: separate points, as of a laser scanner. An
  /// unknown pixel then says nothing of the surfaces.
  bool sparse = false;
};

/// Computes the left pixels that are not visible in the right image. Left pixel x maps to x − d in
/// the right image. It is occluded if
///
///  - that is outside the image;
///  - another left pixel of the row, more than 1 px nearer, maps to the same right pixel, and the
///    row folds between the two: x − d decreases from one known pixel to the next. A slanted
///    surface that is fully visible has a disparity gradient below 1 and no fold;
///  - or the right image's truth, if given, has no disparity within 1 px of d there, nor on both
///    sides of it.
///
/// Throws Error if the two maps have different sizes or nothing is known.
StereoTruth stereo_truth(DisparityMap left, const DisparityMap* right = nullptr);

/// Ground truth at an edge point of the left image.
struct TruthAtEdge {
  /// If the 3 x 3 pixels around the edge point contain a discontinuity, the foreground's disparity,
  /// which is the largest of them; else that of the sub-pixel edge, interpolated along the row.
  float disparity_px = std::numeric_limits<float>::quiet_NaN();
  bool known = false;     ///< at the edge's nearest pixel
  bool occluded = false;  ///< of the pixel that the disparity belongs to
  /// Along the row, regardless of discontinuities.
  float own_px = std::numeric_limits<float>::quiet_NaN();
  bool own_occluded = false;  ///< of the edge's own pixel
  /// A discontinuity in the 5 x 5 pixels, or an unknown value in the 3 x 3 of a truth that is not
  /// sparse.
  bool discontinuity = false;
  float min_px = std::numeric_limits<float>::quiet_NaN();  ///< of the 3 x 3 pixels
  float max_px = std::numeric_limits<float>::quiet_NaN();  ///< of the 3 x 3 pixels
  /// For pairs with row errors (stereo/evaluation/warped_pair.h): additional disparity of the edge
  /// where it crosses the row. Every disparity between the point's and the crossing's is correct.
  float crossing_px = 0;
};

/// Ground truth where each edge crosses its row (EdgePoint::row_x_px). A discontinuity is between
/// two known pixels adjacent along a row or column, or separated only by unknown ones, whose
/// disparities differ by more than their distance: no surface visible to both cameras does that.
/// Throws Error for edges outside the map.
std::vector<TruthAtEdge> truth_at(const StereoTruth& truth, const std::vector<EdgePoint>& edges);

}  // namespace vernier::stereo
