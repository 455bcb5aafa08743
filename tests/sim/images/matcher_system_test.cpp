// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Matchers as systems under test.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/experiment.h"
#include "sim/image_systems/matcher_system.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_reader.h"
#include "sim/study/system_under_test.h"
#include "sim/told_rigs.h"
#include "tests/support/error_message.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

StudyFile matcher_study(const std::string& options) {
  register_system(matcher_kind());
  return parse_study(
      "[study]\ntrials = 6\nseed = 9\nprotocol = \"path\"\n[system]\nname = \"matcher\"\n"
      "samples = 1\n" +
          options,
      "s.toml");
}

SystemSetup setup_of(const StudyCell& cell) {
  return {.cell = cell,
          .visibility = test::small_office_visibility(),
          .rig = test::nominal_rig(),
          .places = std::make_shared<const QueryPlaces>(test::small_office_visibility(),
                                                        cell.experiment.protocol,
                                                        cell.experiment.mount.height_m)};
}

std::unique_ptr<SystemUnderTest> matcher_of_cell(const StudyCell& cell) {
  return system_kind("matcher").make(setup_of(cell));
}

TEST(MatcherSystem, ScoresWhatIsNotRightOfTheEdgesOfAPair) {
  const StudyFile study =
      matcher_study("[sweep]\n\"system.matcher\" = [\"edge\", \"stretch\", \"bm\", \"sgbm\"]\n");
  for (const StudyCell& cell : study.cells) {
    const auto system = matcher_of_cell(cell);
    const TrialResult result = system->run(1), again = system->run(1);
    ASSERT_TRUE(result.answered()) << cell.label << ": " << result.failure;
    const auto& measured = *result.measured;
    EXPECT_GT(measured[0], 100);  // edges
    EXPECT_NEAR(result.error, 1 - measured[1] * (1 - measured[2]), 1e-12);
    EXPECT_GE(result.error, 0);
    EXPECT_LT(result.error, 0.8) << cell.label;
    EXPECT_EQ(result.success(), result.error <= 0.2);
    EXPECT_EQ(result.error, again.error);
    const localise::Pose2D pose = draw_query(test::small_office_visibility(), QueryProtocol::path,
                                             cell.experiment.mount.height_m, 9, 1);
    EXPECT_EQ(result.truth.x_m, pose.x_m);
  }
}

TEST(MatcherSystem, SeesTheSameEdgesThroughMoreNoise) {
  const StudyFile study =
      matcher_study("matcher = \"bm\"\n[sweep]\n\"system.read_noise_e\" = [1, 400]\n");
  double quiet = 0, noisy = 0;
  for (std::uint32_t trial = 0; trial < 3; ++trial) {
    const TrialResult a = matcher_of_cell(study.cells[0])->run(trial);
    const TrialResult b = matcher_of_cell(study.cells[1])->run(trial);
    ASSERT_TRUE(a.answered() && b.answered());
    EXPECT_EQ(a.truth.heading_rad, b.truth.heading_rad);
    quiet += a.error;
    noisy += b.error;
  }
  EXPECT_LT(quiet, noisy);
}

TEST(MatcherSystem, IsToldAnotherRigThanTookTheImages) {
  const StudyFile study = matcher_study("matcher = \"sgbm\"\n");
  const StudyCell& cell = study.cells[0];
  const Rig& truth = test::nominal_rig().rig;
  const std::vector<std::string>& names = cell.system.measured_names;
  const auto index_of = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const auto tried = [&](const Rig& told) {
    SystemSetup setup = setup_of(cell);
    setup.told = given_rig(truth, told, 1, "told");
    TrialResult result = system_kind("matcher").make(setup)->run(1);
    EXPECT_TRUE(result.answered()) << result.failure;
    return result;
  };
  const auto measured = [&](const TrialResult& result, const std::string& name) {
    return result.measured->at(index_of(name));
  };
  Rig longer = truth, rolled = truth, turned = truth;
  longer.T_camera_first[1].t *= 1.02;
  rolled.T_camera_first[1].R = rotation_from_vector({0.02, 0, 0.01}) * truth.T_camera_first[1].R;
  turned.T_camera_first[1].R = rotation_from_vector({0, 0.05, 0}) * truth.T_camera_first[1].R;
  const TrialResult exact = tried(truth), scaled = tried(longer), off = tried(rolled),
                    apart = tried(turned);
  // A longer baseline matches as well and makes every depth longer by its 2 %.
  const double right = measured(exact, "depth_error");
  EXPECT_LT(right, 0.02);
  EXPECT_NEAR(measured(scaled, "depth_error"), 0.02, right);
  EXPECT_NEAR(scaled.error, exact.error, 0.02);
  EXPECT_LT(measured(exact, "row_error_px"), 1e-3);
  EXPECT_LT(measured(scaled, "row_error_px"), 1e-3);
  // Of images that are not in the same rows, edges that stand upright match all the same.
  EXPECT_GT(measured(off, "row_error_px"), 3);
  EXPECT_GT(off.error, exact.error + 0.1);
  // A turn about the vertical shifts all disparities, by more than the largest or below 0: they are
  // searched where they are, and found, but tell no depth.
  EXPECT_LT(apart.error, exact.error + 0.1);
  EXPECT_GT(measured(apart, "depth_error"), 0.2);
}

TEST(MatcherSystem, CalibrationErrorIsDrawnForEveryTrial) {
  const StudyFile study =
      matcher_study("matcher = \"bm\"\n[sweep]\n\"sources.calibration\" = [0, 1, 40]\n");
  std::vector<double> row_px, found;
  for (const StudyCell& cell : study.cells) {
    const TrialResult result = matcher_of_cell(cell)->run(2);
    ASSERT_TRUE(result.answered()) << result.failure;
    EXPECT_EQ(result.error, matcher_of_cell(cell)->run(2).error);
    row_px.push_back(result.measured->at(8));
    found.push_back(result.error);
  }
  EXPECT_LT(row_px[0], 1e-3);
  EXPECT_GT(row_px[1], row_px[0]);
  EXPECT_NEAR(row_px[2] / row_px[1], 40, 10);  // the same draw, scaled: to first order
  EXPECT_GT(found[2], found[0]);
}

TEST(MatcherSystem, ATrialOfAProgramThatFailsSaysWhy) {
  const StudyFile study =
      matcher_study("matcher = \"program\"\ncommand = \"false {left} {right} {output}\"\n");
  const TrialResult result = matcher_of_cell(study.cells[0])->run(0);
  EXPECT_EQ(result.status, localise::LocalisationStatus::failed);
  EXPECT_NE(result.failure.find("false"), std::string::npos) << result.failure;
  EXPECT_FALSE(result.success());
}

TEST(MatcherSystem, ACommandIsOfAProgram) {
  const auto complaint = [](const std::string& options) {
    return test::error_message([&] { check_options_are_used(matcher_study(options)); });
  };
  EXPECT_NE(complaint("matcher = \"program\"\n").find("'command'"), std::string::npos);
  EXPECT_NE(complaint("command = \"m {left} {right} {output}\"\n")
                .find("s.toml:8: system.command is set, but no system.matcher is \"program\""),
            std::string::npos);
  // Beside a built-in matcher it counts for the program's cell only.
  const StudyFile both = matcher_study(
      "command = \"m {left} {right} {output}\"\n[sweep]\n"
      "\"system.matcher\" = [\"edge\", \"program\"]\n");
  EXPECT_EQ(both.cells[0].settings.count("system.command"), 0U);
  EXPECT_EQ(both.cells[1].settings.count("system.command"), 1U);
}

}  // namespace
}  // namespace vernier
