// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "calib/calibrate.h"
#include "calib/simulated_board.h"
#include "calib/validation/view_influence.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

// Under white noise Σ_f |L⁻¹δ_f|² has the mean Σ_f tr(H_f − H_f²), 9.05 a trial here, and a
// variance of at most twice that (a quadratic form of normal variables whose covariance has no
// eigenvalue above 1). Over 12 trials the ratio of the sums therefore has a standard deviation of
// at most 0.136; 0.45 off is beyond 3.3 of them: a false alarm once in 1000 seeds at most.
TEST(ViewInfluenceStatistical, NoiseAloneGivesWhatIsExpectedOfIt) {
  double seen = 0, expected = 0;
  for (std::uint32_t trial = 0; trial < 12; ++trial) {
    const auto board =
        simulate_board(test::stereo_rig(), {}, {.seed = 51, .trial = trial, .frames = 12});
    for (const ViewInfluence& one :
         view_influence(calibrate(board.observations, {.pixel_sigma_px = 0.2}))) {
      seen += one.influence * one.influence;
      expected += one.expected_influence * one.expected_influence;
    }
  }
  EXPECT_NEAR(expected / 12, 9.05, 0.05);
  EXPECT_NEAR(seen / expected, 1, 0.45);
}

}  // namespace
}  // namespace vernier
