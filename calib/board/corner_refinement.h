// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "calib/board_detection.h"

namespace vernier::internal {

/// Where a corner should be, and the half-size of the window that holds it and no other.
struct CornerGuess {
  int id = 0;
  Eigen::Vector2d pixel_px;
  int half_window_px = 2;
};

/// Whether squares cross at every corner, dark opposite dark. At the corners of tags they do where
/// the sheet has squares between the tags, which most of the corners tell.
enum class CornerKind { crossing, as_most };

/// Refines the guesses into `result`, corner by corner, in the order of their ids. Windows shrink
/// towards the image's border. A corner is refused for the reasons of CornerRejection; the last of
/// them compares it with the homography of its nearest refined neighbours.
void refine_corners(const cv::Mat& grey,
                    std::vector<CornerGuess> guesses,
                    const std::vector<Eigen::Vector3d>& target_m,
                    CornerKind kind,
                    BoardDetection& result);

}  // namespace vernier::internal
