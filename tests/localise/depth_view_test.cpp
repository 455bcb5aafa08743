// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/depth_view.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "stereo/grey_levels.h"
#include "stereo/image/depth_image.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "tests/support/edge_images.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier::localise::internal {
namespace {

using stereo::GreyLevels;
using stereo::internal::DepthImage;
using stereo::internal::MeasuredSegment;
using stereo::internal::read_depth_image;
using stereo::internal::SegmentStatus;
using test::error_message;

constexpr int width = 200, height = 160;
constexpr double f_px = 220, cx = 99.5, cy = 79.5;

Camera pinhole() {
  Camera camera;
  camera.name = "camera";
  camera.model = Pinhole{};
  camera.size_px = {width, height};
  camera.parameters = Eigen::Vector4d(f_px, 1.01, cx, cy);
  return camera;
}

GreyLevels edge_image(double angle) {
  const test::Step step{{cx, cy}, angle};
  return test::sampled(width, height, [&](const Eigen::Vector2d& p) { return step.level(p); });
}

/// Depths by a function of the pixel; 0: unknown.
template <typename Depth>
DepthImage depth_of(const Depth& depth) {
  DepthImage map{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) map.depth_m.push_back(static_cast<float>(depth(x, y)));
  }
  return map;
}

/// The longest placed segment.
MeasuredSegment longest(const DepthSegments& segments) {
  const MeasuredSegment* best = nullptr;
  double most = 0;
  for (std::size_t i = 0; i < segments.image.size(); ++i) {
    if (segments.in_space[i].status != SegmentStatus::placed) continue;
    if (segments.image[i].length_px() <= most) continue;
    most = segments.image[i].length_px();
    best = &segments.in_space[i];
  }
  if (best == nullptr) throw std::runtime_error("no segment is placed");
  return *best;
}

TEST(DepthView, AStepsEdgeIsThatOfTheNearerSurface) {
  for (const double angle : {0.0, 0.4, 1.2, std::numbers::pi / 2, 3.0}) {
    for (const bool bright_is_near : {true, false}) {
      const test::Step step{{cx, cy}, angle};
      const DepthImage depth = depth_of([&](int x, int y) {
        return (step.distance({x, y}) > 0) == bright_is_near ? 2.0 : 4.0;
      });
      const MeasuredSegment s = longest(depth_segments(pinhole(), edge_image(angle), depth));
      EXPECT_NEAR(s.segment.a_m.z(), 2, 1e-3) << angle;
      EXPECT_NEAR(s.segment.b_m.z(), 2, 1e-3) << angle;
      // on the ray of the edge's pixel
      const Eigen::Vector2d px(cx + f_px * 1.01 * s.segment.a_m.x() / 2,
                               cy + f_px * s.segment.a_m.y() / 2);
      EXPECT_NEAR(step.distance(px), 0, 0.1) << angle;
    }
  }
}

/// Where the camera sees a point.
Eigen::Vector2d pixel_of(const Eigen::Vector3d& p) {
  return {cx + 1.01 * f_px * p.x() / p.z(), cy + f_px * p.y() / p.z()};
}

/// Depth of the plane n^T X = 1 at a pixel.
double plane_depth(const Eigen::Vector3d& n, const Eigen::Vector2d& px) {
  return 1 / n.dot(Eigen::Vector3d((px.x() - cx) / (1.01 * f_px), (px.y() - cy) / f_px, 1));
}

/// Two planes through one edge in space, seen at `angle` in the image; how far each leans from the
/// plane that faces the camera: both on the far side (a corner of a room), both on the near one (of
/// a cupboard), or a wall and a floor.
struct Fold {
  test::Step step;
  Eigen::Vector3d dark, bright;

  Fold(double angle, double dark_slope, double bright_slope) : step{{cx, cy}, angle} {
    // zero on the plane of the edge and the camera
    const Eigen::Vector2d across(std::cos(angle), std::sin(angle));
    const Eigen::Vector3d edge(1.01 * f_px * across.x(), f_px * across.y(), 0);
    const Eigen::Vector3d facing(0.02, -0.03, 0.25);
    dark = facing + dark_slope * edge / f_px;
    bright = facing + bright_slope * edge / f_px;
  }

  double depth(const Eigen::Vector2d& px) const {
    return plane_depth(step.distance(px) > 0 ? bright : dark, px);
  }
};

const std::vector<std::pair<double, double>> leans{
    {0.3, -0.3}, {-0.3, 0.3}, {0, -0.35}, {0.35, 0}, {0.2, 0.2}};

TEST(DepthView, AFoldLiesWhereItsSurfacesMeet) {
  for (const double angle : {0.0, 0.4, 1.2, std::numbers::pi / 2, 3.0}) {
    for (const auto& [dark, bright] : leans) {
      const Fold fold(angle, dark, bright);
      const DepthImage depth = depth_of([&](int x, int y) { return fold.depth({x, y}); });
      const MeasuredSegment s = longest(depth_segments(pinhole(), edge_image(angle), depth));
      for (const Eigen::Vector3d& end : {s.segment.a_m, s.segment.b_m}) {
        const Eigen::Vector2d px = pixel_of(end);
        EXPECT_NEAR(end.z(), plane_depth(fold.dark, px), 5e-3) << angle << " " << dark;
        EXPECT_NEAR(end.z(), plane_depth(fold.bright, px), 5e-3) << angle << " " << dark;
      }
    }
  }
}

TEST(DepthView, ASlantedSurfaceEndsAtItsEdge) {
  // a table's edge before a floor two metres behind; the pixel at the edge holds both
  for (const double lean : {-0.3, 0.0, 0.3}) {
    const Fold near(1.2, lean, lean);
    const auto table = [&](const Eigen::Vector2d& px) { return plane_depth(near.bright, px); };
    for (const double mixed_px : {0.0, 1.0}) {
      const DepthImage depth = depth_of([&](int x, int y) {
        const double off = near.step.distance({x, y});
        if (std::abs(off) < mixed_px) return table({x, y}) + 1;
        return off > 0 ? table({x, y}) : table({x, y}) + 2;
      });
      const MeasuredSegment s = longest(depth_segments(pinhole(), edge_image(1.2), depth));
      for (const Eigen::Vector3d& end : {s.segment.a_m, s.segment.b_m}) {
        const Eigen::Vector2d px = pixel_of(end);
        EXPECT_NEAR(end.z(), table(px), 5e-3) << lean << " " << mixed_px;
      }
    }
  }
}

TEST(DepthView, ADepthMapShiftedByTwoPixelsKeepsTheNearerSurface) {
  const test::Step step{{cx, cy}, 0.4};
  for (const double shift_px : {-2.0, 2.0}) {
    const DepthImage depth = depth_of([&](int x, int y) {
      return step.distance({x, y}) > shift_px ? 2.0 : 4.0;
    });
    const MeasuredSegment s = longest(depth_segments(pinhole(), edge_image(0.4), depth));
    EXPECT_NEAR(s.segment.a_m.z(), 2, 1e-3) << shift_px;
    EXPECT_NEAR(s.segment.b_m.z(), 2, 1e-3) << shift_px;
  }
}

/// Depths of 3 m to the right of an edge at cx, none up to `hole_px` to its left, then `beyond_m`.
DepthImage beside_hole(int hole_px, double beyond_m) {
  return depth_of([=](int x, int) { return x > cx ? 3.0 : x > cx - hole_px ? 0.0 : beyond_m; });
}

TEST(DepthView, AnEdgeBesideAHoleIsTheKnownSidesUnlessWhatIsBeyondIsNearer) {
  for (const int hole_px : {6, 20}) {
    for (const double beyond_m : {3.0, 5.0}) {
      const DepthImage depth = beside_hole(hole_px, beyond_m);
      EXPECT_NEAR(longest(depth_segments(pinhole(), edge_image(0), depth)).segment.a_m.z(), 3,
                  1e-3);
    }
  }
  // a dark board before the wall gives depths in its middle, or none
  for (const DepthImage& depth : {beside_hole(6, 1.5), beside_hole(20, 1.5), beside_hole(200, 0),
                                  depth_of([](int x, int) { return x < 9 ? 1 : 0; })}) {
    const DepthSegments none = depth_segments(pinhole(), edge_image(0), depth);
    ASSERT_FALSE(none.image.empty());
    for (const MeasuredSegment& s : none.in_space) EXPECT_NE(s.status, SegmentStatus::placed);
  }
}

TEST(DepthView, AStripOfFourPixelsHasItsOwnEdges) {
  // a door's jamb: a wall at 2 m, then a strip that leads to 2.1 m, then a room of 6 m
  for (const int strip_px : {4, 5, 6, 8}) {
    const test::Step first{.centre = {cx, cy}, .offset_px = 0, .dark = 90, .bright = 140};
    const test::Step second{
        .centre = {cx, cy}, .offset_px = double(strip_px), .dark = 0, .bright = 60};
    const GreyLevels image = test::sampled(
        width, height, [&](const Eigen::Vector2d& p) { return first.level(p) + second.level(p); });
    const DepthImage depth = depth_of([&](int x, int) {
      const double along = (x - cx) / strip_px;
      return along < 0 ? 2.0 : along < 1 ? 1 / (1 / 2.0 + along * (1 / 2.1 - 1 / 2.0)) : 6.0;
    });
    const DepthSegments segments = depth_segments(pinhole(), image, depth);
    int ends = 0;
    for (std::size_t i = 0; i < segments.image.size(); ++i) {
      if (segments.in_space[i].status != SegmentStatus::placed) continue;
      const bool is_far = segments.image[i].a_px.x() > cx + 0.5 * strip_px;
      EXPECT_NEAR(segments.in_space[i].segment.a_m.z(), is_far ? 2.1 : 2.0, 0.02) << strip_px;
      ++ends;
    }
    EXPECT_GE(ends, 1) << strip_px;  // the wall's
  }
}

/// What pixels share, in standard deviations, by the distance along an edge through the centre:
/// correlated as exp(−distance / 30 px), as stated (stereo/reconstruction/segment_disparity.h).
std::vector<double> shared_errors(vernier::internal::RandomStream& draws) {
  const double kept = std::exp(-1 / 30.0), added = std::sqrt(1 - kept * kept);
  std::vector<double> errors{draws.normal()};
  while (errors.size() < 2 * (width + height)) {
    errors.push_back(kept * errors.back() + added * draws.normal());
  }
  return errors;
}

/// Mean squared Mahalanobis distance of both depths over 200 depth maps with the stated noise.
double nees_of_depths(const Fold& fold, double angle, bool is_step) {
  const DepthNoise noise{0.02, 1.5e-3};
  const GreyLevels image = edge_image(angle);
  double nees = 0;
  constexpr int trials = 200;
  for (std::uint64_t seed = 1; seed <= trials; ++seed) {
    vernier::internal::RandomStream draws({.seed = seed});
    const Eigen::VectorXd n = draws.normals(width * height);
    const std::vector<double> shared = shared_errors(draws);
    const DepthImage depth = depth_of([&](int x, int y) {
      const double along = std::cos(angle) * (y - cy) - std::sin(angle) * (x - cx);
      const auto at = static_cast<std::size_t>(std::lround(along) + width + height);
      const bool behind = is_step && fold.step.distance({x, y}) < 0;
      const double z = fold.depth({x, y}) + (behind ? 2 : 0);
      return z + noise.floor_m * n[y * width + x] + noise.per_m2 * z * z * shared[at];
    });
    const MeasuredSegment s = longest(depth_segments(pinhole(), image, depth, noise));
    Eigen::Vector2d off;
    Eigen::Matrix2d C;
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector3d& p = i == 0 ? s.segment.a_m : s.segment.b_m;
      const Eigen::Vector2d px = pixel_of(p);
      off[i] = p.z() - plane_depth(fold.bright, px);
      for (int j = 0; j < 2; ++j) C(i, j) = s.independent_m2(2 + 3 * i, 2 + 3 * j);
    }
    nees += off.dot(C.llt().solve(off)) / trials;
  }
  return nees;
}

// Edges on a slanted plane, folds and steps: the squared errors of both depths in units of their
// covariance are two on average if it is true, less by the noise of neighbours that is taken to be
// alike. Two tails of 1e-3 are 2 ± 0.44 for one of these.
TEST(DepthView, CovarianceOfBothEndsCoversTheErrors) {
  for (const auto& [dark, bright] : leans) {
    for (const bool is_step : {false, true}) {
      const double nees = nees_of_depths(Fold(0.3, dark, bright), 0.3, is_step);
      EXPECT_LT(nees, 2.5) << dark << " " << bright << " " << is_step;
      EXPECT_GT(nees, 1) << dark << " " << bright << " " << is_step;
    }
  }
}

TEST(DepthView, LevelPosesKnowUpInEveryWorld) {
  vernier::internal::RandomStream draws({.seed = 7});
  for (int trial = 0; trial < 60; ++trial) {
    const Eigen::VectorXd n = draws.normals(6);
    const Pose T{rotation_from_vector(n.head<3>()), n.tail<3>()};
    const int axis = trial % 3, sign = trial % 2 == 0 ? 1 : -1;
    const LevelPose level = level_pose(T, axis, sign, "image");
    const Eigen::Vector3d up = sign * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector3d up_in_level = level.R_level_camera * T.R.transpose() * up;
    EXPECT_LT((up_in_level - Eigen::Vector3d(0, -1, 0)).norm(), 1e-9);
    const Eigen::Vector3d forward = level.R_level_camera.col(2);
    EXPECT_NEAR(forward.x(), 0, 1e-9);
    EXPECT_GT(forward.z(), 0);
    EXPECT_NEAR(level.height_m, T.t.dot(up), 1e-12);
    EXPECT_NEAR(level.R_level_camera.determinant(), 1, 1e-9);
    // Two cameras keep their distance on the floor.
    Pose other = T;
    other.t += Eigen::Vector3d(0.3, -0.2, 0.5);
    const LevelPose next = level_pose(other, axis, sign, "image");
    const Eigen::Vector3d step = other.t - T.t;
    EXPECT_NEAR(distance_m(level.pose, next.pose), (step - step.dot(up) * up).norm(), 1e-12);
  }
  Pose down;
  down.R = rotation_from_vector({std::numbers::pi / 2, 0, 0});
  EXPECT_NE(error_message([&] { level_pose(down, 1, 1, "a.png"); }).find("a.png"),
            std::string::npos);
}

TEST(DepthView, AnUprightEdgeIsVerticalHoweverTheCameraIsHeld) {
  // An upright edge 3 m ahead of the level camera, seen with pitch and roll.
  for (const auto& [pitch, roll] : {std::pair{0.0, 0.0}, {0.5, 0.1}, {-0.3, -0.14}}) {
    const Eigen::Matrix3d R_level_camera =
        rotation_from_vector({-pitch, 0, 0}) * rotation_from_vector({0, 0, roll});
    const Eigen::Vector3d low(0.2, 1.0, 3), high(0.2, -1.0, 3);
    const auto pixel = [&](const Eigen::Vector3d& p) {
      const Eigen::Vector3d c = R_level_camera.transpose() * p;
      return Eigen::Vector2d(cx + 1.01 * f_px * c.x() / c.z(), cy + f_px * c.y() / c.z());
    };
    const Eigen::Vector2d a = pixel(low), b = pixel(high), along = (b - a).normalized();
    test::Step step{a, std::atan2(along.x(), -along.y())};
    const GreyLevels image =
        test::sampled(width, height, [&](const Eigen::Vector2d& p) { return step.level(p); });
    // the plane through the edge that faces the level camera
    const Eigen::Vector3d normal = R_level_camera.transpose() * Eigen::Vector3d(0, 0, 1.0 / 3);
    const DepthImage depth = depth_of([&](int x, int y) {
      return 1 / normal.dot(Eigen::Vector3d((x - cx) / (1.01 * f_px), (y - cy) / f_px, 1));
    });
    const PlaceView view =
        level_view(pinhole(), depth_segments(pinhole(), image, depth), R_level_camera, 1.5);
    ASSERT_FALSE(view.lines.empty()) << pitch;
    const PlaceLine& line = view.lines[0];
    EXPECT_EQ(line.kind, LineKind::vertical) << pitch;
    EXPECT_NEAR(line.a_m.x(), 3, 0.02) << pitch;
    EXPECT_NEAR(line.a_m.y(), -0.2, 0.02) << pitch;
    EXPECT_EQ(view.mount.pitch_rad, 0);
    EXPECT_FALSE(view.rig);
  }
}

TEST(DepthView, SaysWhatIsWrong) {
  const GreyLevels image = edge_image(0);
  const DepthImage depth = depth_of([](int, int) { return 2; });
  Camera lens = pinhole();
  lens.model = Radial1{};
  lens.parameters.conservativeResize(5);
  lens.parameters[4] = -0.1;
  const auto said = [&](const Camera& camera, const DepthImage& map, const DepthNoise& noise = {}) {
    return error_message([&] { depth_segments(camera, image, map, noise); });
  };
  EXPECT_NE(said(lens, depth).find("has a lens with distortion"), std::string::npos);
  EXPECT_NE(said(pinhole(), DepthImage{2, 2, {1, 1, 1, 1}}).find("the depth map of 2x2"),
            std::string::npos);
  EXPECT_NE(said(pinhole(), depth, {0, 0}).find("depth noise"), std::string::npos);
}

TEST(DepthImage, ReadsMillimetresAndRefusesOthers) {
  const test::Folder folder;
  const cv::Mat depths = (cv::Mat_<std::uint16_t>(2, 3) << 0, 1000, 65535, 1, 2, 3);
  const std::string file = folder.path() / "d.png";
  cv::imwrite(file, depths);
  const DepthImage read = read_depth_image(file);
  EXPECT_EQ(read.width_px, 3);
  EXPECT_FLOAT_EQ(read(1, 0), 1);
  EXPECT_FLOAT_EQ(read(2, 0), 65.535F);
  EXPECT_FLOAT_EQ(read_depth_image(file, 0.0002)(1, 0), 0.2F);
  cv::imwrite(file, cv::Mat::zeros(2, 3, CV_16UC1));
  EXPECT_NE(error_message([&] { read_depth_image(file); }).find("no depth is known"),
            std::string::npos);
  cv::imwrite(file, cv::Mat::zeros(2, 3, CV_8UC1));
  EXPECT_NE(error_message([&] { read_depth_image(file); }).find("is no depth map"),
            std::string::npos);
  EXPECT_NE(error_message([&] { read_depth_image(folder.write("x.png", "x")); }).find("x.png"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::localise::internal
