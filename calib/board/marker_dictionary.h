// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/aruco.hpp>
#include <string>

namespace vernier::internal {

/// OpenCV's dictionary by its name in lower case, such as 4x4_50, aruco_original or apriltag_36h11.
/// Throws Error with the known names.
cv::Ptr<cv::aruco::Dictionary> marker_dictionary(const std::string& name);

}  // namespace vernier::internal
