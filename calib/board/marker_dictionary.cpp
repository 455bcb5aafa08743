// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/marker_dictionary.h"

#include <algorithm>
#include <array>

#include "calib/base/shown_text.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

// In the order of OpenCV's enumeration.
constexpr std::array names{"4x4_50",         "4x4_100",       "4x4_250",       "4x4_1000",
                           "5x5_50",         "5x5_100",       "5x5_250",       "5x5_1000",
                           "6x6_50",         "6x6_100",       "6x6_250",       "6x6_1000",
                           "7x7_50",         "7x7_100",       "7x7_250",       "7x7_1000",
                           "aruco_original", "apriltag_16h5", "apriltag_25h9", "apriltag_36h10",
                           "apriltag_36h11"};
static_assert(names.size() == cv::aruco::DICT_APRILTAG_36h11 + 1);

}  // namespace

cv::Ptr<cv::aruco::Dictionary> marker_dictionary(const std::string& name) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) {
    std::string known;
    for (const char* each : names) known += (known.empty() ? "" : ", ") + std::string(each);
    throw Error("dictionary", in_quotes(name) + " is unknown", "supported: " + known);
  }
  return cv::aruco::getPredefinedDictionary(static_cast<int>(at - names.begin()));
}

}  // namespace vernier::internal
