// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/outlier_lines.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/rig_estimate.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// Of the pair: frame 3 lost all of its right view, frame 5 two corners of its left one.
RigEstimate with_outliers() {
  RigEstimate estimate;
  estimate.rig = test::stereo_rig();
  CalibrationSummary& summary = estimate.calibration.emplace();
  for (int id = 0; id < 54; ++id) {
    summary.outliers.push_back({3, 1, id, "right03.png", {0, 0}, 9.8 - 0.1 * id});
  }
  summary.outliers.push_back({5, 0, 7, "left05.png", {0, 0}, 4.2});
  summary.outliers.push_back({5, 0, 8, "left05.png", {0, 0}, 12});
  CalibrationEvidence& evidence = estimate.evidence.emplace();
  for (const auto& [frame, camera] : std::vector<std::pair<int, int>>{{3, 0}, {5, 0}, {5, 1}}) {
    evidence.observations.views.push_back({frame, camera, "", {0}, {{1, 1}}});
  }
  return estimate;
}

TEST(OutlierLines, AViewLeftOutWholeIsOneLine) {
  EXPECT_EQ(outlier_lines(with_outliers()),
            (std::vector<std::string>{
                "all 54 corners of frame 3, right, 4.5 to 9.8 px from their predictions",
                "corner 7 of frame 5, left, 4.2 px from its prediction",
                "corner 8 of frame 5, left, 12.0 px from its prediction"}));
}

TEST(OutlierLines, WithoutEvidenceEachCornerIsOne) {
  RigEstimate estimate = with_outliers();
  estimate.evidence.reset();
  const std::vector<std::string> lines = outlier_lines(estimate);
  ASSERT_EQ(lines.size(), 56u);
  EXPECT_EQ(lines[0], "corner 0 of frame 3, right, 9.8 px from its prediction");
}

TEST(OutlierLines, UnknownDistancesAreNotGiven) {
  RigEstimate estimate = with_outliers();
  for (CornerOutlier& outlier : estimate.calibration->outliers) {
    outlier.residual_px = std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_EQ(outlier_lines(estimate),
            (std::vector<std::string>{"all 54 corners of frame 3, right",
                                      "corner 7 of frame 5, left", "corner 8 of frame 5, left"}));
}

TEST(OutlierLines, ARigWithoutACalibrationHasNone) {
  RigEstimate estimate = with_outliers();
  estimate.calibration.reset();
  EXPECT_TRUE(outlier_lines(estimate).empty());
}

}  // namespace
}  // namespace vernier
