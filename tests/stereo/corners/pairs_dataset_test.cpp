// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// The memo's own calibration on real images: unlabelled corners of the 13 pairs and a wide prior,
// judged by the boards' corners, which it never saw as such.
#include <gtest/gtest.h>

#include <cmath>

#include "calib/board_detection.h"
#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/covariance.h"
#include "calib/joint_calibration.h"
#include "calib/lens_models.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/solver/packed_pairs.h"
#include "stereo/corners/match_images.h"
#include "tests/support/data_folder.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo::internal;

namespace {

/// Left and right pixels of the same board corner, as pairs.
PairObservations board_pairs(const BoardObservations& observations) {
  PairObservations pairs;
  for (std::size_t v = 0; v + 1 < observations.views.size(); ++v) {
    const BoardView &l = observations.views[v], &r = observations.views[v + 1];
    if (l.frame != r.frame || l.ids != r.ids) continue;
    for (std::size_t i = 0; i < l.ids.size(); ++i) {
      Eigen::Vector4d y;
      y << l.pixels_px[i], r.pixels_px[i];
      add_pair(pairs, l.frame, y, 1);
    }
  }
  return pairs;
}

/// Root mean square distance of the boards' corners from their epipolar lines, px of both images.
double epipolar_rms(const PairObservations& pairs, const Rig& rig) {
  double squares = 0;
  for (const double r : PackedPairs(pairs).residuals(rig)) squares += r * r;
  return std::sqrt(squares / static_cast<double>(pairs.size()));
}

/// The board calibration's values, known as badly as a datasheet would say.
GaussianRigPrior wide_prior(const Rig& board, const Eigen::VectorXd& offset) {
  const std::vector<std::string> names = parameter_names(board);
  Eigen::VectorXd sd(static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = names[i].substr(names[i].find('.') + 1);
    double s = 0.05;                                          // k2
    if (name == "f_px" || name.substr(0, 1) == "o") s = 5;    // px
    if (name == "ax" || name.substr(0, 1) == "t") s = 0.002;  // and metres
    if (name.substr(0, 1) == "p") s = 0.001;
    if (name == "k1") s = 0.02;
    if (name.substr(0, 1) == "w") s = 0.01;
    sd[static_cast<Eigen::Index>(i)] = s;
  }
  GaussianRigPrior known{retract(board, sd.cwiseProduct(offset)),
                         {CovarianceKind::prior, names, {}}};
  known.covariance.matrix = sd.cwiseAbs2().asDiagonal();
  return known;
}

TEST(PairsOfRealImages, VerticalDisparityFallsToTheBoardsLevelAndDepthStaysThePriors) {
  const auto folder = test::data_folder();
  if (!folder) GTEST_SKIP() << "VERNIER_DATA is not set";
  const std::string left = *folder / "calib_opencv_case1" / "left*.png";
  const std::string right = *folder / "calib_opencv_case1" / "right*.png";
  const BoardObservations corners =
      detect_images({left, right}, Chessboard{9, 6, 0.025}).observations;
  const RigEstimate board = calibrate(corners, {.model = OpenCv4{}});
  const PairObservations judges = board_pairs(board.evidence->observations);
  // Most of a standard deviation away in every parameter but the baseline's length.
  Eigen::VectorXd offset(22);
  for (Eigen::Index i = 0; i < 22; ++i) offset[i] = (i < 8 ? 0.7 : -0.7) * (i == 19 ? 0 : 1);
  const GaussianRigPrior prior = wide_prior(board.rig, offset);
  RigEstimate wide;
  wide.rig = prior.rig;
  wide.covariance = prior.covariance;
  PairObservations pairs;
  for (const ImageFiles& files : paired_images(left, right)) {
    add_matches(pairs, match_images(files, wide, "prior"));
  }
  const JointCalibration found = calibrate_from_pairs(pairs, prior);
  const double before = epipolar_rms(judges, prior.rig);
  const double after = epipolar_rms(judges, found.estimate.rig);
  const double boards = epipolar_rms(judges, board.rig);
  RecordProperty("pairs", std::to_string(pairs.size()));
  RecordProperty("pairs_left_out",
                 std::to_string(found.estimate.calibration->pair_outliers.size()));
  RecordProperty("epipolar_rms_px", std::to_string(before) + " prior, " + std::to_string(after) +
                                        " pairs, " + std::to_string(boards) + " board");
  RecordProperty("baseline_sd_mm",
                 std::to_string(1e3 * found.observability->baseline_sd_before_m) + " before, " +
                     std::to_string(1e3 * found.observability->baseline_sd_after_m));
  EXPECT_GT(before, 3);
  EXPECT_LT(after, 1.2 * boards);  // corners that the board calibration was fitted to
  EXPECT_NEAR(found.observability->scale_information_ratio, 1, 1e-3);
  EXPECT_NEAR(found.observability->baseline_sd_after_m / found.observability->baseline_sd_before_m,
              1, 1e-3);
  EXPECT_GT(found.observability->from_data, 10);
}

}  // namespace
}  // namespace vernier
