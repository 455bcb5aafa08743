// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <vector>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
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

/// A pair without distortion, its right camera displaced, rolled or with another image.
Rig pinholes(const Eigen::Vector3d& right_centre_m, double roll_rad = 0, double right_f_px = 500) {
  Rig rig;
  for (int i = 0; i < 2; ++i) {
    Camera camera;
    camera.name = i == 0 ? "left" : "right";
    camera.model = Pinhole{};
    camera.size_px = {640, 480};
    camera.parameters = Eigen::Vector4d(i == 0 ? 500 : right_f_px, 1, 319.5, 239.5);
    rig.cameras.push_back(camera);
  }
  const Eigen::Matrix3d R = rotation_from_vector({0, 0, roll_rad});
  rig.T_camera_first = {Pose{}, {R, -(R * right_centre_m)}};
  return rig;
}

/// Whether a camera of a rig sees a point of the left camera's frame, away from its borders.
bool sees(const Rig& rig, int eye, const Eigen::Vector3d& point_m) {
  const Eigen::Vector3d p = eye == 0 ? point_m : rig.T_camera_first[1] * point_m;
  if (!(p.z() > 0)) return false;
  const Camera& camera = rig.cameras[static_cast<std::size_t>(eye)];
  const Eigen::Array2d px = vernier::project(camera, p).array();
  const Eigen::Array2d last = camera.size_px.cast<double>().array() - 11;
  return (px >= 10).all() && (px <= last).all();
}

/// A line cut to what both eyes see, by steps along it.
struct Sampled {
  double length_px = 0, first_u = 0;
};
Sampled sampled(const PlaceLine& line, const Pose2D& pose, const PlaceView& view) {
  const ViewCamera camera = view_camera(view);
  const Pose T_camera_robot = T_robot_camera(view.mount).inverse();
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
    const Eigen::Vector3d in_robot(at.x_m, at.y_m, world.z());
    const Eigen::Vector3f uvw = project(camera, Eigen::Vector3f(in_robot.cast<float>()));
    const Eigen::Vector3d in_left = T_camera_robot * in_robot;
    const bool seen = sees(*view.rig, 0, in_left) && sees(*view.rig, 1, in_left);
    if (seen && seen_before) result.length_px += (uvw - last).head<2>().norm();
    if (seen && result.length_px == 0 && !seen_before) result.first_u = uvw[0];
    seen_before = seen;
    last = uvw;
  }
  return result;
}

// Oracle: dense sampling of every line, seen by both cameras of the rig itself.
class Predict : public testing::TestWithParam<int> {};

TEST_P(Predict, CutsLinesToWhatBothEyesSee) {
  const Rig rigs[] = {pinholes({0.3, 0, 0}),
                      pinholes({-0.3, 0, 0}),
                      pinholes({0, 0.3, 0}),
                      pinholes({0.001, -0.3, 0}),
                      pinholes({0.3, 0, 0}, std::numbers::pi / 2),
                      pinholes({-0.2, 0.1, 0}, 0, 800),
                      pinholes({0.3, 0, 0}, 0, 350)};
  const std::vector<PlaceLine> room = test::random_room(3, 120);
  PlaceView view = view_of({});
  view.rig = std::make_shared<const Rig>(rigs[GetParam()]);
  const ViewCamera camera = view_camera(view);
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
      const Sampled s = sampled(line, pose, view);
      if (s.length_px < 8.5) continue;
      expected += s.length_px;
      ++expected_lines;
    }
    // Borders that differ by less than 5 px are taken as one.
    EXPECT_NEAR(counted, expected, 20 + 5e-3 * expected) << expected_lines << " lines";
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, Predict, testing::Range(0, 7));

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
