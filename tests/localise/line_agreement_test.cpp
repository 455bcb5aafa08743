// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/error.h"
#include "calib/statistics/random.h"
#include "datasets/shipped.h"
#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/place/view_camera.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/view_agreement.h"
#include "tests/support/camera_views.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::localise::internal;

namespace {

using test::camera_view;
using test::view_of;

TEST(ViewCamera, ProjectsAsTheMountedCameraDoes) {
  for (const double pitch : {0.0, 0.3, -0.2}) {
    const PlaceView view = view_of({}, pitch);
    const ViewCamera camera = view_camera(view);
    const Eigen::Vector3d point(3.1, -0.7, 0.4);
    const Eigen::Vector3d seen = T_robot_camera(view.mount).inverse() * point;
    const Eigen::Vector3f uvw = project(camera, point.cast<float>());
    EXPECT_NEAR(uvw[0], camera.f_px * seen.x() / seen.z(), 1e-3);
    EXPECT_NEAR(uvw[1], camera.f_px * seen.y() / seen.z(), 1e-3);
    EXPECT_NEAR(uvw[2], 1 / seen.z(), 1e-6);
  }
}

TEST(ViewCamera, StepJacobianIsThatOfSmallSteps) {
  const ViewCamera camera = view_camera(view_of({}, 0.2));
  const Eigen::Vector3f point(3.1f, -0.7f, 0.4f);
  const Eigen::Matrix3f J = step_jacobian(camera, project(camera, point));
  constexpr double h = 1e-3;
  for (int i = 0; i < 3; ++i) {
    const auto seen = [&](double step) {
      const Pose2D pose{i == 0 ? step : 0, i == 1 ? step : 0, i == 2 ? step : 0};
      const Pose2D at = relative({point.x(), point.y(), 0}, pose);
      return project(camera, {static_cast<float>(at.x_m), static_cast<float>(at.y_m), point.z()});
    };
    const Eigen::Vector3f numeric = (seen(h) - seen(-h)) / static_cast<float>(2 * h);
    EXPECT_LT((J.col(i) - numeric).norm(), 2e-3 * (1 + numeric.norm())) << i;
  }
}

TEST(ViewCamera, AViewWithoutRigIsRefused) { EXPECT_THROW(view_camera({}), Error); }

/// A line cut to what both eyes see, by steps along it.
struct Sampled {
  double length_px = 0, first_u = 0;
};
Sampled sampled(const PlaceLine& line, const Pose2D& pose, const ViewCamera& camera) {
  constexpr int steps = 20000;
  Sampled result;
  Eigen::Vector3f last = Eigen::Vector3f::Zero();
  bool seen_before = false;
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector3d world = line.a_m + (line.b_m - line.a_m) * i / steps;
    const Pose2D at = relative({world.x(), world.y(), 0}, pose);
    if (at.x_m < 0.25) {
      seen_before = false;
      continue;
    }
    const Eigen::Vector3f uvw = project(
        camera,
        {static_cast<float>(at.x_m), static_cast<float>(at.y_m), static_cast<float>(world.z())});
    const float right_u = uvw[0] - camera.disparity_px_m() * uvw[2];
    const bool seen = right_u >= camera.left_px && uvw[0] <= camera.right_px &&
                      uvw[1] >= camera.top_px && uvw[1] <= camera.bottom_px;
    if (seen && seen_before) result.length_px += (uvw - last).head<2>().norm();
    if (seen && result.length_px == 0 && !seen_before) result.first_u = uvw[0];
    seen_before = seen;
    last = uvw;
  }
  return result;
}

// Oracle: dense sampling of every line.
TEST(Predict, CutsLinesToWhatBothEyesSee) {
  const std::vector<PlaceLine> room = test::random_room(3, 120);
  const ViewCamera camera = view_camera(view_of({}));
  for (const Pose2D pose : {Pose2D{0, 0, 0}, Pose2D{0.7, -0.4, 0.5}, Pose2D{2, 1, -2.5}}) {
    PredictedLines predicted;
    predict(space_lines(room), pose, camera, predicted);
    double counted = 0, expected = 0;
    int expected_lines = 0;
    for (const ImageLines* set : {&predicted.steep, &predicted.flat}) {
      for (int i = 0; i < set->size; ++i) {
        EXPECT_NEAR(std::hypot(set->dx[i], set->dy[i]), 1, 1e-5);
        EXPECT_GE(set->length_px[i], 8);
        if (set->counted[i] == 1) counted += set->length_px[i];
      }
    }
    for (const PlaceLine& line : room) {
      const Sampled s = sampled(line, pose, camera);
      if (s.length_px < 8.5) continue;
      expected += s.length_px;
      ++expected_lines;
    }
    EXPECT_NEAR(counted, expected, 20 + 1e-3 * expected) << expected_lines << " lines";
  }
}

/// As best_match() is documented, line by line in double precision.
LineMatch plain_match(const QueryLine& q,
                      const ImageLines& lines,
                      const ViewCamera& c,
                      const LineTolerance& t) {
  LineMatch best{26, -1};
  for (int i = 0; i < lines.size; ++i) {
    const double ru = q.u - lines.u[i], rv = q.v - lines.v[i];
    const double offset = rv * lines.dx[i] - ru * lines.dy[i];
    const double along = ru * lines.dx[i] + rv * lines.dy[i];
    const double sine = std::abs(q.dx * lines.dy[i] - q.dy * lines.dx[i]);
    const double half = 0.5 * q.length_px;
    if (std::abs(offset) >= 60 || sine >= 0.25 || along <= -half - 8 ||
        along >= lines.length_px[i] + half + 8) {
      continue;
    }
    const double w =
        lines.w[i] + std::clamp<double>(along / lines.length_px[i], 0, 1) * lines.dw[i];
    const double position = c.f_px * t.offset_m * w;
    const double squared = offset * offset / (t.offset_px * t.offset_px + position * position);
    if (squared * squared >= 20) continue;
    const double angle =
        sine / (t.angle_rad + t.angle_px / std::min(q.length_px, lines.length_px[i]));
    const double fB = c.disparity_px_m(), bw = fB * w, disparity = fB * (w - q.w);
    const double variance = t.disparity_px * t.disparity_px + std::pow(t.disparity_share * bw, 2) +
                            0.5 * std::pow(bw * w, 2) * (q.variance_m2 + lines.variance_m2[i]);
    const double energy =
        squared * squared + angle * angle +
        std::min<double>(disparity * disparity / variance, t.most_disparity_energy);
    if (energy < best.energy) best = {static_cast<float>(energy), i};
  }
  return best;
}

TEST(BestMatch, IsThatOfAPlainLoop) {
  const std::vector<PlaceLine> room = test::random_room(5, 150);
  const PlaceView view = view_of(test::seen_from(test::random_room(5, 150), {0.05, 0.03, 0.02}));
  const ComparedView compared = compared_view(view);
  PredictedLines predicted;
  predict(space_lines(room), {0, 0, 0}, compared.camera, predicted);
  int matched = 0;
  for (const LineTolerance& tolerance :
       {rough_agreement().tolerance, fine_agreement().tolerance, wide_agreement().tolerance}) {
    for (const QueryLine& line : compared.lines) {
      ImageLines& partners = line.steep ? predicted.steep : predicted.flat;
      const LineMatch found = best_match(line, partners, compared.camera, tolerance);
      const LineMatch expected = plain_match(line, partners, compared.camera, tolerance);
      EXPECT_NEAR(found.energy, expected.energy, 1e-3 * (1 + expected.energy));
      if (expected.energy < 20) {
        EXPECT_EQ(found.line, expected.line);
      }
      matched += found.line >= 0;
      if (found.line < 0) continue;
      const LineDeviation d = deviation(line, partners, found.line, compared.camera, tolerance);
      EXPECT_LE(std::pow(d.offset, 4) + std::min<double>(d.disparity * d.disparity, 8),
                found.energy * 1.001 + 1e-3);
    }
  }
  EXPECT_GT(matched, 100);
}

TEST(ViewAgreement, IsBestAtTheTruePoseAndStepsLeadThere) {
  const std::vector<PlaceLine> room = test::random_room(8, 300);
  const Pose2D truth{0.4, -0.2, 0.3};
  const ComparedView view = compared_view(camera_view(room, truth));
  const SpaceLines lines = space_lines(room);
  PredictedLines space;
  const double best = agreement(view, lines, truth, fine_agreement(), space).score;
  for (const Pose2D step : {Pose2D{0.05, 0, 0}, Pose2D{0, -0.05, 0}, Pose2D{0, 0, 0.02}}) {
    EXPECT_LT(agreement(view, lines, compose(truth, step), fine_agreement(), space).score,
              best - 1);
  }
  const ImprovedPose found =
      improve(view, lines, compose(truth, {0.04, -0.05, 0.02}), 6, rough_agreement(), space);
  EXPECT_LT(distance_m(found.pose, truth), 2e-3);
  EXPECT_LT(std::abs(heading_difference_rad(found.pose, truth)), 1e-3);
}

TEST(ViewAgreement, ChargesForLinesThatShouldBeSeen) {
  const std::vector<PlaceLine> room = test::random_room(9, 300);
  const ComparedView view = compared_view(camera_view(room));
  PredictedLines space;
  const double all = agreement(view, space_lines(room), {}, fine_agreement(), space).score;
  SpaceLines more = space_lines(room), uncounted = more;
  more.add({3, -0.2f, 0.2f}, {3, -0.2f, 2}, 0.02f, true);
  uncounted.add({3, -0.2f, 0.2f}, {3, -0.2f, 2}, 0.02f, false);
  more.pad();
  uncounted.pad();
  const double charged = agreement(view, more, {}, fine_agreement(), space).score;
  const double free = agreement(view, uncounted, {}, fine_agreement(), space).score;
  EXPECT_LT(charged, free - 1);
  EXPECT_NEAR(free, all, 1.0);
}

// Lines between steep and flat were charged as missing.
TEST(ViewAgreement, APerfectViewCostsNothingAtAnyTilt) {
  PredictedLines space;
  for (int tilt = 0; tilt <= 80; ++tilt) {
    const double radian = 0.01745329 * tilt;
    const std::vector<PlaceLine> line{{{3, 0, 0.8},
                                       {3, 0.7 * std::sin(radian), 0.8 + 0.7 * std::cos(radian)},
                                       LineKind::oblique,
                                       0.02}};
    const ComparedView view = compared_view(view_of(line));
    ASSERT_EQ(view.lines.size(), 1u);
    EXPECT_NEAR(agreement(view, space_lines(line), {}, fine_agreement(), space).score, 0, 0.01)
        << tilt;
  }
}

}  // namespace
}  // namespace vernier
