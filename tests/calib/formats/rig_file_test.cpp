// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"
#include "tests/support/scenes.h"
#include "tests/support/texts.h"

namespace vernier {
namespace {

const RigEstimate& estimate() {
  static const RigEstimate estimate =
      calibrate(simulate_board(test::stereo_rig(), {}, {.seed = 3}).observations);
  return estimate;
}

std::string complaint_of(const std::string& text) {
  return test::error_message([&] { parse_rig(text, "rig.json"); });
}

TEST(RigFile, RoundTrip) {
  const RigFile file = parse_rig(format_rig(estimate()), "rig.json");
  const RigEstimate &before = estimate(), &after = file.estimate;
  EXPECT_TRUE(file.warnings.empty());
  EXPECT_EQ(after.covariance->matrix, before.covariance->matrix);
  EXPECT_EQ(*after.covariance_mvb, *before.covariance_mvb);
  EXPECT_EQ(after.calibration->warnings, before.calibration->warnings);
  for (int c = 0; c < 2; ++c) {
    EXPECT_EQ(after.rig.cameras[c].parameters, before.rig.cameras[c].parameters);
  }
  // A rotation passes through its rotation vector: equal to rounding.
  EXPECT_LT(difference(after.rig, before.rig).cwiseAbs().maxCoeff(), 1e-15);
  ASSERT_EQ(after.evidence->observations.views.size(), 40u);
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_TRUE(after.evidence->observations.views[i].pixels_px ==
                before.evidence->observations.views[i].pixels_px);
  }
  EXPECT_LT((after.evidence->T_first_board[7].R - before.evidence->T_first_board[7].R).norm(),
            1e-14);
}

TEST(RigFile, KeepsRandomEffects) {
  RigEstimate e = estimate();
  e.calibration->effects = CalibrationEffects{
      0.1, 0.05, 0.06, 1e-3, 3e-4, 7e-4, 5e-5, 2e-4, {{0, 1e-4, -2e-4}, {1e-5, 0, 3e-4}}};
  const std::string text = format_rig(e, KeepEvidence::no);
  const RigFile file = parse_rig(text, "rig.json");
  EXPECT_TRUE(file.warnings.empty());
  const CalibrationEffects& after = *file.estimate.calibration->effects;
  EXPECT_EQ(after.white_px, 0.1);
  EXPECT_EQ(after.field_px, 0.05);
  EXPECT_EQ(after.field_length_m, 0.06);
  EXPECT_EQ(after.motion_rad, 1e-3);
  EXPECT_EQ(after.motion_m, 3e-4);
  EXPECT_EQ(after.motion_baseline_m, 7e-4);
  const RigFile older =
      parse_rig(test::replaced(text, "\"motion_baseline_m\":0.0007,", ""), "rig.json");
  EXPECT_EQ(older.estimate.calibration->effects->motion_baseline_m, 0);  // isotropic
  EXPECT_EQ(after.shape_plane_m, 5e-5);
  EXPECT_EQ(after.shape_height_m, 2e-4);
  EXPECT_TRUE(after.shape_m == e.calibration->effects->shape_m);
  EXPECT_EQ(complaint_of(test::replaced(text, "\"motion_m\":", "\"motion\":")),
            "rig.json: calibration.effects: has no \"motion_m\"; add it");
  e.calibration->effects->field_px = -1;
  EXPECT_EQ(complaint_of(format_rig(e, KeepEvidence::no)),
            "rig.json: calibration.effects.field_px: is negative; calibrate again");
  EXPECT_EQ(complaint_of(test::replaced(text, "\"shape_m\":[", "\"shape_m\":[1,")),
            "rig.json: calibration.effects.shape_m: is not x, y, z of each point; calibrate again");
}

TEST(RigFile, UnknownKeysAreKeptWithAWarning) {
  const std::string text = test::replaced(format_rig(estimate(), KeepEvidence::no), "\"version\":1",
                                          "\"version\":1,\"serial\":\"A-17\"");
  const RigFile file = parse_rig(text, "rig.json");
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_NE(format_rig(file.estimate).find("\"serial\":\"A-17\""), std::string::npos);
}

TEST(RigFile, ComplaintsNameFileAndKey) {
  const std::string text = format_rig(estimate(), KeepEvidence::no);
  EXPECT_NE(complaint_of("{\n\"format\": \"vernier/rig\",\n oops}").find("rig.json:3: is not JSON"),
            std::string::npos);
  EXPECT_NE(complaint_of("{}").find("is not a rig file"), std::string::npos);
  EXPECT_NE(complaint_of(" \n").find("rig.json: is empty"), std::string::npos);
  EXPECT_NE(complaint_of("cam0: 1").find("rig.json: is not a rig file; vernier convert reads"),
            std::string::npos);
  EXPECT_NE(complaint_of(test::replaced(text, "\"k1\"", "\"k7\""))
                .find("rig.json: cameras[0].parameters"),
            std::string::npos);
  EXPECT_NE(complaint_of(test::replaced(text, "radial1", "radial9")).find("unknown model"),
            std::string::npos);
  EXPECT_NE(
      complaint_of(test::replaced(text, "\"model\"", "\"lens\"")).find("rig.json: cameras[0]: "),
      std::string::npos);
  EXPECT_NE(complaint_of(test::replaced(text, "\"ay\":1", "\"ay\":2")).find("null direction"),
            std::string::npos);
  EXPECT_NE(complaint_of(test::replaced(text, "\"parameters\":[", "\"parameters\":[7,"))
                .find("rig.json: parameters: 17 values for 16 names"),
            std::string::npos);
  EXPECT_NE(complaint_of(test::replaced(text, "\"kind\":\"jackknife\"", "\"kind\":\"best\""))
                .find("covariance kind \"best\""),
            std::string::npos);
}

TEST(RigFile, WhatNoRigHasIsRefusedWithItsKey) {
  const std::string text = format_rig(estimate(), KeepEvidence::no);
  for (const auto& [from, to, said] :
       {std::array<std::string, 3>{"\"version\":1", "\"version\":1,\"version\":1",
                                   "rig.json:1: the object that ends here has the key \"version\""},
        {"\"version\":1", "\"version\":4294967297", "rig.json: version: 4294967297 is too large"},
        {"\"size_px\":[640", "\"size_px\":[4294967936", "rig.json: cameras[0].size_px: is not"},
        {"\"f_px\":", "\"f_px\":1e300,\"f\":", "has no such parameter"},
        {"\"f_px\":", "\"f_px\":1", "rig.json: parameters: left.f_px is"},
        {"\"name\":\"left\"", "\"name\":\"le\\u001bft\"",
         "rig.json: cameras[0].name: \"le\\x1bft\" is not a camera's name"}}) {
    const std::string complaint = complaint_of(test::replaced(text, from, to));
    EXPECT_NE(complaint.find(said), std::string::npos) << complaint;
    EXPECT_EQ(complaint.rfind("rig.json", 0), 0U) << complaint;
  }
}

TEST(RigFile, ACovarianceThatIsNoneIsRefusedWithTheFile) {
  RigEstimate e = estimate();
  e.covariance->matrix.setIdentity();
  e.covariance_mvb.reset();
  const std::string row = "\"matrix\":[[1.0,0.0,";
  const std::string text = format_rig(e, KeepEvidence::no);
  EXPECT_EQ(complaint_of(test::replaced(text, row, "\"matrix\":[[1.0,0.5,")),
            "rig.json: covariance.matrix: it is not symmetric; check the rig file");
  EXPECT_EQ(complaint_of(test::replaced(text, row, "\"matrix\":[[1e31,0.0,")),
            "rig.json: covariance.matrix: holds a number beyond 1e+30; correct it");
  e.covariance.reset();
  e.covariance_mvb = Eigen::MatrixXd::Identity(16, 16);
  const std::string bound =
      test::replaced(format_rig(e, KeepEvidence::no), row, "\"matrix\":[[1.0,2.0,");
  EXPECT_NE(complaint_of(test::replaced(bound, "],[0.0,1.0,0.0,", "],[2.0,1.0,0.0,"))
                .find("rig.json: covariance_mvb.matrix: it is not positive semi-definite"),
            std::string::npos);
}

TEST(RigFile, ValuesThatDisagreeAreAnError) {
  RigEstimate e = estimate();
  const std::string before = format_rig(e, KeepEvidence::no);
  const std::size_t at = before.find("\"parameters\":[") + 14;
  const std::string text = before.substr(0, at) + "9" + before.substr(at);
  EXPECT_NE(complaint_of(text).find("left.f_px is"), std::string::npos);
}

TEST(RigFile, ParametersAreCheckedWithoutACovariance) {
  RigEstimate e = estimate();
  e.covariance.reset();
  e.covariance_mvb.reset();
  const std::string text = format_rig(e, KeepEvidence::no);
  EXPECT_EQ(complaint_of(text), "");
  EXPECT_NE(complaint_of(test::replaced(text, "\"parameters\":[", "\"parameters\":[9"))
                .find("rig.json: parameters: left.f_px is"),
            std::string::npos);
  EXPECT_NE(complaint_of(test::replaced(text, "[\"left.f_px\"", "[\"left.f\""))
                .find("rig.json: parameter_names: are not the rig's parameters"),
            std::string::npos);
}

TEST(RigFile, MinimumVarianceBoundHasTheParametersSize) {
  std::string text = format_rig(estimate(), KeepEvidence::no);
  const std::string key = "\"covariance_mvb\":{\"matrix\":";
  const std::size_t start = text.find(key) + key.size();
  text.replace(start, text.find("]]", start) + 2 - start, "[[1,0,0],[0,1,0],[0,0,1]]");
  EXPECT_NE(complaint_of(text).find("rig.json: covariance_mvb.matrix: is 3x3 for 16 parameters"),
            std::string::npos);
}

TEST(RigFile, EvidenceHasOneCornerAPixel) {
  RigEstimate e = estimate();
  BoardView& view = e.evidence->observations.views[0];
  view.ids.pop_back();
  EXPECT_NE(complaint_of(format_rig(e))
                .find("rig.json: evidence.observations[0].ids: holds 53 corners for 54 pixels"),
            std::string::npos);
  view.ids.insert(view.ids.end(), {53, 53});
  EXPECT_NE(complaint_of(format_rig(e)).find("ids: holds 55 corners for 54 pixels"),
            std::string::npos);
}

TEST(RigFile, AnImageNameNeedNotBeUtf8) {
  RigEstimate e = estimate();
  e.evidence->observations.views[0].image = "caf\xe9/left01.png";
  const RigFile file = parse_rig(format_rig(e), "rig.json");
  EXPECT_EQ(file.estimate.evidence->observations.views[0].image, "caf\xef\xbf\xbd/left01.png");
}

TEST(RigFile, WhatIsHeldIsOneOfTheRigsParameters) {
  RigEstimate e = estimate();
  e.calibration->held = {"left.ax", "port.ax"};
  EXPECT_EQ(complaint_of(format_rig(e)),
            "rig.json: calibration.held[1]: the rig has no parameter \"port.ax\"; use a name from "
            "parameter_names");
}

TEST(RigFile, AParameterWithAVarianceIsNotHeld) {
  const std::string text =
      test::replaced(format_rig(estimate(), KeepEvidence::no), "\"calibration\":{",
                     R"("calibration":{"held":["left.ax"],)");
  EXPECT_EQ(
      complaint_of(text),
      "rig.json: calibration.held[0]: \"left.ax\" has a variance in the covariance; take it out "
      "of one of them");
}

// The corners of estimate(): 40 views of 54 in 20 frames.
TEST(RigFile, ASummaryThatNoCalibrationHasIsRefused) {
  using Change = void (*)(CalibrationSummary&);
  const auto complaint = [](Change change, KeepEvidence evidence = KeepEvidence::no) {
    RigEstimate e = estimate();
    change(*e.calibration);
    return complaint_of(format_rig(e, evidence));
  };
  EXPECT_EQ(complaint([](auto& s) { s.source = "guess"; }),
            "rig.json: calibration.source: \"guess\" is unknown; use board, pairs or combined");
  EXPECT_EQ(complaint([](auto& s) { s.rms_px = 1e300; }),
            "rig.json: calibration.rms_px: is above 1e+06; calibrate again");
  EXPECT_EQ(complaint([](auto& s) { s.chi2 = 1e300; }),
            "rig.json: calibration.chi2: is above 1e+30; calibrate again");
  EXPECT_EQ(complaint([](auto& s) {
              s.held = {"left.ax", "left.f_px", "left.ax"};
            }),
            "rig.json: calibration.held[2]: repeats \"left.ax\"; name it once");
  EXPECT_EQ(complaint([](auto& s) {
              s.outliers = {{0, 0, -1, "", {3, 4}, 1}};
            }),
            "rig.json: calibration.outliers[0].corner: is negative; calibrate again");
  EXPECT_EQ(complaint([](auto& s) {
              s.outliers = {{0, 0, 1, "", {3, 4}, -1}};
            }),
            "rig.json: calibration.outliers[0].residual_px: is negative; calibrate again");
  EXPECT_EQ(complaint([](auto& s) {
              s.outliers = {{0, 0, 1, "", {3, 1e300}, 1}};
            }),
            "rig.json: calibration.outliers[0].pixel_px: holds a number beyond 1e+06; correct it");
  const std::string text = format_rig(estimate(), KeepEvidence::no);
  EXPECT_EQ(complaint_of(test::replaced(text, "\"views\":", "\"prior_chi2\":1,\"views\":")),
            "rig.json: calibration: has no \"prior_dof\"; add it");
  EXPECT_EQ(complaint_of(
                test::replaced(text, "\"views\":", "\"prior_chi2\":1,\"prior_dof\":0,\"views\":")),
            "rig.json: calibration.prior_chi2: is above 0 for no parameter; calibrate again");
}

TEST(RigFile, ASummaryOfOtherEvidenceIsRefused) {
  using Change = void (*)(CalibrationSummary&);
  const auto complaint = [](Change change) {
    RigEstimate e = estimate();
    change(*e.calibration);
    return complaint_of(format_rig(e));
  };
  EXPECT_EQ(complaint([](auto&) {}), "");
  EXPECT_EQ(complaint([](auto& s) { s.views = 1'000'000; }),
            "rig.json: calibration.views: is 1000000, and the evidence has 20; calibrate again");
  EXPECT_EQ(complaint([](auto& s) { s.dof = 4321; }),
            "rig.json: calibration.dof: is 4321, and the evidence has 4320 residuals; calibrate "
            "again");
  EXPECT_EQ(complaint([](auto& s) {
              s.outliers = {{7, 1, 54, "", {3, 4}, 9}};
            }),
            "rig.json: calibration.outliers[0]: is corner 54 of a board of 54; calibrate again");
  EXPECT_EQ(complaint([](auto& s) {
              s.pair_outliers = {{0, 0, {1, 2, 3, 4}, 1}};
            }),
            "rig.json: calibration.pair_outliers[0]: is row 0 of 0; calibrate again");
  EXPECT_EQ(complaint([](auto& s) { s.chi2 *= 1.005; }), "");  // rounded by hand
  for (const Change change :
       {Change([](auto& s) { s.chi2 *= 1.1; }), Change([](auto& s) { s.rms_px = 0; }),
        Change([](auto& s) { s.pixel_sigma_px *= 10; })}) {
    EXPECT_NE(complaint(change).find("rig.json: calibration: its chi2, pixel_sigma_px and rms_px "
                                     "disagree: "),
              std::string::npos)
        << complaint(change);
  }
}

TEST(RigFile, NewNamesOfCamerasStandEverywhere) {
  RigEstimate e = estimate();
  e.calibration->held = {"right.ax"};
  rename_cameras(e, {"right", "star.board"});  // one of them is a former name
  EXPECT_EQ(e.calibration->held, std::vector<std::string>{"star.board.ax"});
  EXPECT_EQ(e.covariance->names, parameter_names(e.rig));
  EXPECT_EQ(e.covariance->names[0], "right.f_px");
  EXPECT_EQ(complaint_of(format_rig(e)), "");
  EXPECT_NE(test::error_message([&] { rename_cameras(e, {"a"}); }).find("1 names for 2 cameras"),
            std::string::npos);
  for (const std::vector<std::string>& names : {std::vector<std::string>{"a", "a"}, {"a", ""}}) {
    EXPECT_NE(
        test::error_message([&] { rename_cameras(e, names); }).find("two cameras have the same"),
        std::string::npos);
  }
}

TEST(RigFile, NumbersThatAreNotFiniteAreNotWritten) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto error_output = [](const RigEstimate& e) {
    return test::error_message([&] { format_rig(e); });
  };
  RigEstimate e = estimate();
  e.rig.T_camera_first[1].t.y() = nan;
  EXPECT_EQ(error_output(e),
            "rig.cameras[1].from_first.translation_m[1]: is not a finite number; a "
            "rig file cannot hold it");
  e = estimate();
  e.covariance_mvb->coeffRef(2, 3) = std::numeric_limits<double>::infinity();
  EXPECT_NE(error_output(e).find("rig.covariance_mvb.matrix[2][3]"), std::string::npos);
  e = estimate();
  e.calibration->chi2 = nan;
  EXPECT_NE(error_output(e).find("rig.calibration.chi2"), std::string::npos);
  e = estimate();
  e.calibration->outliers.push_back({0, 0, 1, "", {3, 4}, nan});  // its frame went with it
  EXPECT_EQ(error_output(e), "");
}

TEST(RigFile, AnErrorOfWhatItNamesKeepsItsParts) {
  const test::Folder folder;
  const auto file = folder.write(
      "rig.json", test::replaced(format_rig(estimate(), KeepEvidence::no), "radial1", "radial9"));
  const auto [place, fault, remedy] = test::error_parts([&] { read_rig(file); });
  EXPECT_EQ(place, file.string() + ": cameras[0].model");
  EXPECT_EQ(fault, "camera model \"radial9\": unknown model");
  EXPECT_EQ(remedy, "supported: radial1, pinhole, opencv4, opencv5, opencv8, fisheye4");
}

TEST(RigFile, CovariancesThatReadingRefusesAreNotWritten) {
  const auto complaint = [](const RigEstimate& e) {
    return test::error_message([&] { format_rig(e); });
  };
  RigEstimate e = estimate();
  e.covariance->matrix(3, 3) *= -1;
  EXPECT_NE(complaint(e).find("rig.covariance.matrix: the variance of left.oy_px"),
            std::string::npos)
      << complaint(e);
  e = estimate();
  e.covariance->matrix(0, 1) += 0.1 * e.covariance->matrix(0, 0);
  EXPECT_NE(complaint(e).find("rig.covariance.matrix: it is not symmetric"), std::string::npos)
      << complaint(e);
  e = estimate();
  Eigen::MatrixXd& bound = *e.covariance_mvb;
  bound(0, 2) = bound(2, 0) = 3 * std::sqrt(bound(0, 0) * bound(2, 2));
  EXPECT_NE(complaint(e).find("rig.covariance_mvb.matrix: it is not positive semi-definite"),
            std::string::npos)
      << complaint(e);
  e = estimate();
  e.covariance->names[0] = "left.g_px";
  EXPECT_NE(complaint(e).find("rig.covariance: the covariance's names"), std::string::npos)
      << complaint(e);
  e = estimate();
  e.covariance->matrix = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_NE(complaint(e).find("does not match the rig's parameters"), std::string::npos);
}

}  // namespace
}  // namespace vernier
