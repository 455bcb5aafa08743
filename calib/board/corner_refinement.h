// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/board_detection.h"

namespace vernier::internal {

/// Expected position of a corner, and the half-size of the window that contains it and no other.
struct CornerGuess {
  int id = 0;
  Eigen::Vector2d pixel_px;
  int half_window_px = 2;
  /// A corner that is refined further away than this on the board is another one.
  double reach_m = std::numeric_limits<double>::infinity();
  Eigen::Matrix2d px_per_m = Eigen::Matrix2d::Identity();  ///< of the board's image, for reach_m
};

/// Whether every corner is a crossing of squares. The corners of tags are, if the sheet has squares
/// between the tags, which is decided by the majority of the corners.
enum class CornerKind { crossing, as_most };

/// Refines the guesses into `result`, corner by corner, in the order of their ids. Windows shrink
/// towards the image's border. A corner is rejected for the reasons of CornerRejection; the last of
/// them compares it with the homography of its nearest refined neighbours.
void refine_corners(const cv::Mat& grey,
                    std::vector<CornerGuess> guesses,
                    const std::vector<Eigen::Vector3d>& target_m,
                    CornerKind kind,
                    BoardDetection& result);

}  // namespace vernier::internal
