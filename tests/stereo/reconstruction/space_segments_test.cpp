// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/reconstruction/space_segments.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "calib/base/decompositions.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/triangulate.h"
#include "stereo/rectification.h"
#include "stereo/rectification/rectification_covariance.h"
#include "stereo/segment.h"
#include "tests/support/calibrations_covariance.h"
#include "tests/support/dense_oracles.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Eigen::MatrixXd random_root(int n, std::uint64_t seed) {
  RandomStream draws({.seed = seed, .source = static_cast<std::uint32_t>(DrawSource::noisy_copy)});
  Eigen::MatrixXd root(n, n);
  for (int i = 0; i < n; ++i) root.col(i) = draws.normals(n);
  return root;
}

SegmentDisparity segment(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double da, double db) {
  SegmentDisparity s;
  s.left_px = {a, b};
  s.a_disparity_px = da;
  s.b_disparity_px = db;
  const Matrix6d root = random_root(6, 510);
  s.covariance_px2 = 0.0016 * root * root.transpose();
  return s;
}

std::vector<SegmentDisparity> some() {
  return {segment({200, 100}, {230, 180}, 40, 44), segment({500, 300}, {520, 250}, 31, 30),
          segment({100, 400}, {104, 300}, 25, 25), segment({330, 200}, {420, 230}, 60, 61)};
}

RigEstimate estimate_of(const Rig& rig) {
  RigEstimate estimate;
  estimate.rig = rig;
  estimate.covariance = test::calibrations_covariance(rig);
  const Eigen::VectorXd sd = estimate.covariance->matrix.diagonal().cwiseSqrt();
  const Eigen::MatrixXd root = sd.asDiagonal() * random_root(static_cast<int>(sd.size()), 509);
  estimate.covariance->matrix = 0.1 * root * root.transpose();  // of full rank
  return estimate;
}

Vector6d ends_of(const SpaceSegment& s) {
  Vector6d ends;
  ends << s.a_m, s.b_m;
  return ends;
}

StereoSegment raw_of(const Rig& rig, const RectifiedGeometry& g, const SegmentDisparity& s) {
  const ImageSegment other = s.right_px();
  return {
      {raw_pixel(rig, g, 0, s.left_px.a_px).value(), raw_pixel(rig, g, 0, s.left_px.b_px).value()},
      {raw_pixel(rig, g, 1, other.a_px).value(), raw_pixel(rig, g, 1, other.b_px).value()},
      0};
}

TEST(SpaceSegments, AreWhereTheRawLinesMeet) {
  for (const char* model : {"pinhole", "radial1", "opencv5", "fisheye4"}) {
    const Rig rig = test::stereo_rig(camera_model(model));
    const RectifiedGeometry g = rectified_geometry(rig);
    const auto found = some();
    const auto placed = space_segments(found, g, estimate_of(rig));
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(placed[i].status, SegmentStatus::placed);
      const SpaceSegment meets = triangulate(rig, raw_of(rig, g, found[i]));
      EXPECT_LT((ends_of(placed[i].segment) - ends_of(meets)).norm(), 1e-8) << model;
    }
  }
}

TEST(SpaceSegments, DerivativesByTheRigAreThoseOfDifferences) {
  for (const char* model : {"pinhole", "radial1", "opencv4", "opencv5", "opencv8", "fisheye4"}) {
    const Rig rig = test::stereo_rig(camera_model(model));
    const RectifiedGeometry g = rectified_geometry(rig);
    const auto found = some();
    const auto placed = space_segments(found, g, estimate_of(rig));
    for (std::size_t i = 0; i < found.size(); ++i) {
      const StereoSegment raw = raw_of(rig, g, found[i]);
      const Eigen::MatrixXd numeric = test::numeric_jacobian(
          [&](const Eigen::VectorXd& delta) -> Eigen::VectorXd {
            return ends_of(triangulate(retract(rig, delta), raw));
          },
          Eigen::VectorXd::Zero(parameter_count(rig)), 1e-5);
      EXPECT_LT((placed[i].by_rig - numeric).cwiseAbs().maxCoeff(),
                1e-6 * numeric.cwiseAbs().maxCoeff())
          << model << ' ' << i;
    }
  }
}

/// The other way round: what the rig does to (d, dy) of an end in the rectified images, and the
/// right edge's slope, which turns dy into a disparity
/// (stereo/rectification/rectification_covariance.h).
TEST(SpaceSegments, DepthChangesAsTheRectifiedDisparityDoes) {
  Rig rig = test::stereo_rig(Pinhole{});
  const RectifiedGeometry g = rectified_geometry(rig);
  const auto found = some();
  const auto estimate = estimate_of(rig);
  const auto placed = space_segments(found, g, estimate);
  const RectificationUncertainty rectified(rig, estimate.covariance->matrix, g);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const ImageSegment right = found[i].right_px();
    const Eigen::Vector2d along = right.b_px - right.a_px;
    const auto by_rig = rectified.by_rig(found[i].left_px.a_px, found[i].a_disparity_px).value();
    const Eigen::RowVectorXd by_edge = by_rig.row(0) - along.x() / along.y() * by_rig.row(1);
    // z = f B / d, and the left camera's intrinsics, B and the rectified axes stay.
    const double z = g.depth_m(found[i].a_disparity_px);
    const Eigen::RowVector3d axis = g.turn.R_rectified_left.row(2);
    for (const Eigen::Index k : {4, 5, 6, 7}) {  // of the right camera
      const double ours = axis * placed[i].by_rig.block<3, 1>(0, k);
      EXPECT_NEAR(ours, -z / found[i].a_disparity_px * by_edge[k], 1e-9 * (1 + std::abs(ours)))
          << k;
    }
  }
}

TEST(SpaceSegments, ALongerBaselineIsALargerScene) {
  const Rig rig = test::stereo_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  const auto found = some();
  const auto placed = space_segments(found, g, estimate_of(rig));
  Rig longer = rig;
  longer.T_camera_first[1].t *= 1.01;
  const auto larger = space_segments(found, rectified_geometry(longer), estimate_of(longer));
  Eigen::VectorXd baseline = Eigen::VectorXd::Zero(parameter_count(rig));
  baseline.tail<3>() = rig.T_camera_first[1].t;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Vector6d ends = ends_of(placed[i].segment);
    EXPECT_LT((ends_of(larger[i].segment) - 1.01 * ends).norm(), 1e-9);
    EXPECT_LT((placed[i].by_rig * baseline - ends).norm(), 1e-9);  // linear, so exact
  }
}

TEST(SpaceSegments, PartsAddUp) {
  const Rig rig = test::stereo_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  const auto found = some();
  const RigEstimate estimate = estimate_of(rig);
  RigEstimate nothing = estimate;
  nothing.covariance.reset();
  const auto both = space_segments(found, g, estimate), one = space_segments(found, g, nothing),
             bare = space_segments(found, g);
  const Eigen::MatrixXd joint = calibration_covariance_m2(both, estimate.covariance->matrix);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_TRUE(one[i].calibration_m2.isZero(0));
    EXPECT_EQ(bare[i].by_rig.cols(), 0);
    EXPECT_EQ(bare[i].independent_m2, both[i].independent_m2);
    EXPECT_EQ(one[i].covariance_m2() + both[i].calibration_m2, both[i].covariance_m2());
    const auto k = 6 * static_cast<Eigen::Index>(i);
    EXPECT_LT((joint.block<6, 6>(k, k) - both[i].calibration_m2).norm(), 1e-12);
  }
  EXPECT_LT((joint - joint.transpose()).norm(), 1e-12 * joint.norm());
  // Near ones err together: their distance is far better known than they are.
  const auto near = space_segments(
      std::vector{segment({300, 200}, {310, 260}, 40, 40), segment({304, 200}, {314, 260}, 40, 40)},
      g, estimate);
  const Eigen::MatrixXd C = calibration_covariance_m2(near, estimate.covariance->matrix);
  const Eigen::Matrix3d apart =
      C.block<3, 3>(0, 0) + C.block<3, 3>(6, 6) - C.block<3, 3>(0, 6) - C.block<3, 3>(6, 0);
  const Eigen::Matrix3d first = C.topLeftCorner(3, 3);
  EXPECT_LT(apart.trace(), 1e-3 * first.trace());
}

/// Errors of both lines drawn: image places and disparities by their covariance at a tenth of
/// their size, so that the depth is linear. NEES over 3000 draws, both tails, false-alarm rate 1e-3
/// (seed 511).
TEST(SpaceSegments, TheIndependentPartIsThatOfDraws) {
  const Rig rig = test::stereo_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  RandomStream draws({.seed = 511, .source = static_cast<std::uint32_t>(DrawSource::noisy_copy)});
  for (const SegmentDisparity& truth : some()) {
    const MeasuredSegment stated = space_segments(std::vector{truth}, g)[0];
    const Matrix6d root = Cholesky(truth.covariance_px2).lower();
    const Matrix6d inverse = test::inverse(stated.independent_m2);
    const int trials = 3000;
    double nees = 0;
    for (int k = 0; k < trials; ++k) {
      const Vector6d e = 0.1 * root * draws.normals(6);
      SegmentDisparity drawn = truth;
      drawn.left_px.a_px += e.head<2>();
      drawn.left_px.b_px += e.segment<2>(2);
      drawn.a_disparity_px += e[4];
      drawn.b_disparity_px += e[5];
      const MeasuredSegment at = space_segments(std::vector{drawn}, g)[0];
      const Vector6d off = 10 * (ends_of(at.segment) - ends_of(stated.segment));
      nees += off.dot(inverse * off);
    }
    EXPECT_GT(nees, chi_squared_quantile(5e-4, 6 * trials));
    EXPECT_LT(nees, chi_squared_quantile(1 - 5e-4, 6 * trials));
  }
}

/// Rigs drawn at ψ = 0.02 read the same raw lines, all segments at once: 24 coordinates on a
/// covariance of the rig's 16 parameters. NEES over its range but for directions a hundredth as
/// wide as the widest, whose curvature is larger than they are; both tails, false-alarm rate 1e-3
/// (seed 42).
TEST(SpaceSegments, TheCalibrationPartIsThatOfDrawnRigs) {
  const RigEstimate estimate = estimate_of(test::stereo_rig());
  const Rig& rig = estimate.rig;
  const RectifiedGeometry g = rectified_geometry(rig);
  const auto found = some();
  const auto placed = space_segments(found, g, estimate);
  const Eigen::MatrixXd C = calibration_covariance_m2(placed, estimate.covariance->matrix);
  const SymmetricEigen spectrum(C);
  const double largest = spectrum.eigenvalues().tail<1>()[0];
  int rank = 0;
  while (rank < 24 && spectrum.eigenvalues()[23 - rank] > 1e-4 * largest) ++rank;
  ASSERT_GE(rank, 4);
  const RigSampler sampler(estimate);
  const double psi = 0.02;
  const int trials = 2000;
  double nees = 0;
  for (int k = 0; k < trials; ++k) {
    const Rig drawn = sampler.sample(psi, 42, static_cast<std::uint32_t>(k));
    Eigen::VectorXd off(24);
    for (int i = 0; i < 4; ++i) {
      const auto at = static_cast<std::size_t>(i);
      off.segment<6>(6 * i) =
          ends_of(triangulate(drawn, raw_of(rig, g, found[at]))) - ends_of(placed[at].segment);
    }
    const Eigen::VectorXd in = spectrum.eigenvectors().rightCols(rank).transpose() * off / psi;
    nees += (in.array().square() / spectrum.eigenvalues().tail(rank).array()).sum();
  }
  EXPECT_GT(nees, chi_squared_quantile(5e-4, rank * trials));
  EXPECT_LT(nees, chi_squared_quantile(1 - 5e-4, rank * trials));
}

TEST(SpaceSegments, WhatCannotBePlacedSaysSo) {
  const Rig rig = test::stereo_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  SegmentDisparity refused;
  refused.status = SegmentStatus::disagree;
  const std::vector<SegmentDisparity> given{segment({200, 100}, {230, 180}, 40, -1), refused,
                                            segment({200, 100}, {230, 180}, 1.5, 1.5)};
  const auto placed = space_segments(given, g, estimate_of(rig));
  EXPECT_EQ(placed[0].status, SegmentStatus::behind);
  EXPECT_EQ(placed[1].status, SegmentStatus::disagree);
  EXPECT_EQ(placed[2].status, SegmentStatus::placed);
  EXPECT_FALSE(placed[2].segment.reliable);  // 70 m
  EXPECT_FALSE(placed[2].linear);
  EXPECT_GT(placed[2].relative_sigma, 0.1);
  const auto good = space_segments(some(), g);
  EXPECT_TRUE(good[0].linear && good[0].segment.reliable);
  EXPECT_THROW(space_segments(some(), g, {.max_depth_m = 0}), Error);
  EXPECT_THROW(calibration_covariance_m2(good, Eigen::MatrixXd::Identity(16, 16)), Error);
  RigEstimate other = estimate_of(rig);
  other.covariance->matrix = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_THROW(space_segments(some(), g, other), Error);
}

TEST(SpaceSegments, AlreadyRectifiedRigsAreKnown) {
  Rig raw = test::stereo_rig();
  const RectifiedGeometry g = rectified_geometry(raw);
  Rig rig = rectified_rig(raw, g);
  const auto same = geometry_of_rectified_rig(rig);
  ASSERT_TRUE(same.has_value());
  EXPECT_DOUBLE_EQ(same->f_px, g.f_px);
  EXPECT_DOUBLE_EQ(same->baseline_m, g.baseline_m);
  EXPECT_EQ(same->centre_px, g.centre_px);
  EXPECT_EQ(same->size_px, g.size_px);
  // The right camera's centre elsewhere: its images' disparities are less by that, the places not.
  const auto placed = space_segments(some(), *same, estimate_of(rig));
  rig.cameras[1].parameters[2] += 7;
  const auto moved =
      space_segments(some(), geometry_of_rectified_rig(rig).value(), estimate_of(rig));
  EXPECT_LT((ends_of(moved[0].segment) - ends_of(placed[0].segment)).norm(), 1e-12);
  EXPECT_LT((moved[0].by_rig - placed[0].by_rig).norm(), 1e-9 * placed[0].by_rig.norm());
  EXPECT_FALSE(geometry_of_rectified_rig(raw).has_value());
  raw.cameras[1].parameters.resize(0);
  EXPECT_THROW(geometry_of_rectified_rig(raw), Error);  // of a camera without parameters
  rig.T_camera_first[1].t.y() = 1e-3;
  EXPECT_FALSE(geometry_of_rectified_rig(rig).has_value());
}

/// How far the linear depth interval is from the true one where the flag changes: depth is 1 / d.
/// A segment whose depth is known just better, or just worse, than the limit: what disparities
/// drawn with its sigma say of its depth lies, at either end of the 68 % interval, within a seventh
/// of what the linear sigma says where the flag is set.
TEST(SpaceSegments, TheFlagIsWhereTheLinearIntervalStillHolds) {
  const RectifiedGeometry g = rectified_geometry(test::stereo_rig());
  for (const double relative : {0.09, 0.11}) {
    const double disparity_px = 20;
    SegmentDisparity s = segment({200, 100}, {230, 180}, disparity_px, disparity_px);
    s.covariance_px2.setZero();
    s.covariance_px2(4, 4) = s.covariance_px2(5, 5) = std::pow(relative * disparity_px, 2);
    const MeasuredSegment placed = space_segments(std::vector{s}, g)[0];
    EXPECT_EQ(placed.linear, relative < 0.1);
    RandomStream draws({.seed = 45});
    std::vector<double> depths;
    for (int k = 0; k < 20'000; ++k) {
      SegmentDisparity drawn = s;
      drawn.a_disparity_px += relative * disparity_px * draws.normal();
      depths.push_back(space_segments(std::vector{drawn}, g)[0].segment.a_m.z());
    }
    std::sort(depths.begin(), depths.end());
    const double z = placed.segment.a_m.z(), sigma = std::sqrt(placed.covariance_m2()(2, 2));
    const double low = depths[static_cast<std::size_t>(0.1587 * 20'000)];
    const double high = depths[static_cast<std::size_t>(0.8413 * 20'000)];
    EXPECT_NEAR((z - low) / sigma, 1, 0.14);
    EXPECT_NEAR((high - z) / sigma, 1, 0.14);
    if (!placed.linear) {
      EXPECT_GT((high - z) / sigma, 1.1);  // the linear interval is too short there
    }
  }
}

}  // namespace
}  // namespace vernier
