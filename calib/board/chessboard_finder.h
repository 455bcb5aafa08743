// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "calib/board_detection.h"
#include "calib/board_target.h"

namespace vernier::internal {

/// Finds a chessboard in an image; see detect_board.
void detect_chessboard(const cv::Mat& grey, const Chessboard& board, BoardDetection& result);

}  // namespace vernier::internal
