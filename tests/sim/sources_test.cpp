// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "calib/error.h"
#include "sim/route.h"
#include "sim/sense.h"
#include "tests/support/small_office.h"

namespace vernier {
namespace {

/// A look at the office with corners, and sightings of it under given settings.
class Sources : public testing::Test {
 protected:
  static const Look& seen() {
    static const Look look_at = [] {
      LookOptions options;
      options.with_corners = true;
      return look(test::small_office_visibility(), test::nominal_rig().rig,
                  map_places(test::small_office().route, 2)[2], options);
    }();
    return look_at;
  }
  static StereoSighting sense(const SourceSettings& settings, std::uint32_t trial = 0) {
    return Sensor(test::nominal_rig().rig, settings, 1e-6).sense(seen(), 7, trial, 0);
  }
  static const StereoSighting& exact() {
    static const StereoSighting sighting = sense(no_sources());
    return sighting;
  }
  static Eigen::Vector2d normal(const ImageSegment& s) {
    const Eigen::Vector2d d = (s.b_px - s.a_px).normalized();
    return {-d.y(), d.x()};
  }
};

TEST_F(Sources, LateralShiftMovesBothEyesAlikeAlongTheNormal) {
  SourceSettings settings = no_sources();
  settings.lateral_shift_px = 3;
  const StereoSighting shifted = sense(settings);
  ASSERT_EQ(shifted.segments.size(), exact().segments.size());
  for (std::size_t i = 0; i < shifted.segments.size(); ++i) {
    const StereoSegment &s = shifted.segments[i], &e = exact().segments[i];
    const Eigen::Vector2d left = s.left.a_px - e.left.a_px, right = s.right.a_px - e.right.a_px;
    EXPECT_LT((left - (s.left.b_px - e.left.b_px)).norm(), 1e-9);  // the whole edge
    const double size = left.dot(normal(e.left));
    EXPECT_NEAR(std::abs(size), left.norm(), 1e-9);
    EXPECT_GE(left.norm(), 1.5 - 1e-9);
    EXPECT_LE(left.norm(), 4.5 + 1e-9);
    EXPECT_NEAR(right.dot(normal(e.right)), size, 1e-9);
  }
}

TEST_F(Sources, IndependentShiftsDifferBetweenEyes) {
  SourceSettings settings = no_sources();
  settings.lateral_shift_px = 3;
  settings.lateral_shift_mode = ShiftMode::independent;
  const StereoSighting shifted = sense(settings);
  int differ = 0;
  for (std::size_t i = 0; i < shifted.segments.size(); ++i) {
    const double left = (shifted.segments[i].left.a_px - exact().segments[i].left.a_px).norm();
    const double right = (shifted.segments[i].right.a_px - exact().segments[i].right.a_px).norm();
    differ += std::abs(left - right) > 0.01;
  }
  EXPECT_GT(differ, static_cast<int>(0.9 * static_cast<double>(shifted.segments.size())));
}

TEST_F(Sources, EdgeLossTakesExactlyItsShareAndKeepsTheRestOnTheEdge) {
  SourceSettings settings = no_sources();
  settings.edge_loss = 0.2;
  const StereoSighting left_over = sense(settings);
  std::map<std::uint32_t, double> kept;
  for (const StereoSegment& s : left_over.segments) {
    // pieces stay on the edge: every end projects from a point between the true ends
    kept[s.feature / 2] += s.left.length_px();
  }
  // With little distortion lengths along chord and curve agree to a few parts in 1e4.
  for (const StereoSegment& e : exact().segments) {
    ASSERT_TRUE(kept.contains(e.feature / 2));
    EXPECT_NEAR(kept[e.feature / 2] / e.left.length_px(), 0.8, 5e-3);
  }
}

TEST_F(Sources, EndpointErrorMovesEndsOnly) {
  SourceSettings settings = no_sources();
  settings.endpoint_sigma_px = 0.15;
  const StereoSighting noisy = sense(settings);
  ASSERT_EQ(noisy.segments.size(), exact().segments.size());
  double sum = 0;
  for (std::size_t i = 0; i < noisy.segments.size(); ++i) {
    const Eigen::Vector2d e = noisy.segments[i].left.a_px - exact().segments[i].left.a_px;
    EXPECT_LT(e.norm(), 1.0);
    sum += e.squaredNorm();
    EXPECT_NE(e, noisy.segments[i].right.a_px - exact().segments[i].right.a_px);
  }
  EXPECT_GT(sum, 0);
}

TEST_F(Sources, EpipolarRejectionDropsFlatLinesOnly) {
  SourceSettings settings = no_sources();
  settings.epipolar_reject_deg = 5;
  const StereoSighting steep = sense(settings);
  std::set<std::uint32_t> kept;
  for (const StereoSegment& s : steep.segments) kept.insert(s.feature);
  const Rig& rig = test::nominal_rig().rig;
  const Rectification r = rectification(rig);
  for (const StereoSegment& e : exact().segments) {
    EXPECT_EQ(kept.contains(e.feature),
              epipolar_angle_rad(rig, r, e.left) >= 5 * 0.017453292519943295);
  }
  EXPECT_LT(steep.segments.size(), exact().segments.size());
}

TEST_F(Sources, StereoMismatchMovesTheRightLineAlongItsEpipolarLine) {
  SourceSettings settings = no_sources();
  settings.stereo_mismatch = 1;
  settings.stereo_mismatch_px = 20;
  const StereoSighting wrong = sense(settings);
  const Rig& rig = test::nominal_rig().rig;
  const Rectification r = rectification(rig);
  for (std::size_t i = 0; i < wrong.segments.size(); ++i) {
    EXPECT_EQ(wrong.segments[i].left.a_px, exact().segments[i].left.a_px);
    const auto row = [&](const Eigen::Vector2d& pixel) {
      const Eigen::Vector3d ray = r.R_rectified_right * unproject(rig.cameras[1], pixel);
      return ray.y() / ray.z();
    };
    EXPECT_NEAR(row(wrong.segments[i].right.a_px), row(exact().segments[i].right.a_px), 1e-9);
    EXPECT_LT((wrong.segments[i].right.a_px - exact().segments[i].right.a_px).norm(), 22);
  }
}

TEST_F(Sources, CornerSourcesTouchCornersOnly) {
  SourceSettings settings = no_sources();
  settings.corner_loss = 0.5;
  settings.corner_mismatch = 0.5;
  settings.corner_mismatch_px = 10;
  const StereoSighting sighting = sense(settings);
  for (std::size_t i = 0; i < sighting.segments.size(); ++i) {
    EXPECT_EQ(sighting.segments[i].right.b_px, exact().segments[i].right.b_px);
  }
  EXPECT_LT(sighting.corners.size(), exact().corners.size());
  std::map<std::uint32_t, const SensedCorner*> truth;
  for (const SensedCorner& c : exact().corners) truth[c.truth.feature] = &c;
  for (const SensedCorner& c : sighting.corners) {
    const SensedCorner& e = *truth.at(c.truth.feature);
    EXPECT_EQ(c.pixel_px[0], e.pixel_px[0]);
    const double moved = (c.pixel_px[1] - e.pixel_px[1]).norm();
    EXPECT_LE(moved, 10);
    EXPECT_EQ(c.mismatched, moved > 0);
  }
}

TEST_F(Sources, SwitchingOneOnLeavesTheDrawsOfOthers) {
  SourceSettings with = no_sources(), without = no_sources();
  with.endpoint_sigma_px = without.endpoint_sigma_px = 0.15;
  with.corner_loss = 0.3;
  with.stereo_mismatch = 0.5;
  const StereoSighting a = sense(with), b = sense(without);
  ASSERT_EQ(a.segments.size(), b.segments.size());
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    EXPECT_EQ(a.segments[i].left.a_px, b.segments[i].left.a_px);
    EXPECT_EQ(a.segments[i].left.b_px, b.segments[i].left.b_px);
  }
}

TEST_F(Sources, LargerSharesTakeASuperset) {
  SourceSettings little = no_sources(), much = no_sources();
  little.corner_loss = 0.1;
  much.corner_loss = 0.4;
  std::set<std::uint32_t> kept_of_little;
  for (const SensedCorner& c : sense(little).corners) kept_of_little.insert(c.truth.feature);
  const auto kept_of_much = sense(much).corners;
  EXPECT_LT(kept_of_much.size(), kept_of_little.size());
  for (const SensedCorner& c : kept_of_much) {
    EXPECT_TRUE(kept_of_little.contains(c.truth.feature));
  }
}

TEST_F(Sources, TheSamePlaceGivesTheSameBitsAndAnotherTrialOthers) {
  const StereoSighting a = sense({}, 4), b = sense({}, 4), c = sense({}, 5);
  ASSERT_EQ(a.segments.size(), b.segments.size());
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    EXPECT_EQ(a.segments[i].left.a_px, b.segments[i].left.a_px);
    EXPECT_EQ(a.segments[i].right.b_px, b.segments[i].right.b_px);
  }
  EXPECT_NE(a.segments[0].left.a_px, c.segments[0].left.a_px);
}

TEST_F(Sources, OutOfRangeIsNamed) {
  SourceSettings settings;
  settings.edge_loss = 1.5;
  try {
    Sensor(test::nominal_rig().rig, settings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "sources: sources.edge_loss = 1.5 is out of range; give 0 to 0.95");
  }
}

}  // namespace
}  // namespace vernier
