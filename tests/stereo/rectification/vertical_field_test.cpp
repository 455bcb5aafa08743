// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification/vertical_field.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/random.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification/vertical_field_fit.h"
#include "tests/support/error_message.h"
#include "tests/support/grey_levels.h"
#include "tests/support/textured_plane.h"
#include "tests/support/wedge_image.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

constexpr int width = 400, height = 300;

/// A pair whose rows agree but for what `right` does to the right camera.
Rig pair_rig(double right_lower_px = 0, double roll_rad = 0) {
  Rig rig;
  for (int i = 0; i < 2; ++i) {
    Camera camera;
    camera.name = i == 0 ? "left" : "right";
    camera.model = Pinhole{};
    camera.size_px = {width, height};
    camera.parameters =
        Eigen::Vector4d(400, 1, 0.5 * (width - 1), 0.5 * (height - 1) + i * right_lower_px);
    rig.cameras.push_back(camera);
  }
  rig.T_camera_first = {Pose{}, Pose{Eigen::Matrix3d::Identity(), {-0.15, 0, 0}}};
  const Eigen::Matrix3d roll =
      Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  rig.T_camera_first[1] = Pose{roll, roll * rig.T_camera_first[1].t};
  return rig;
}

RectifiedPair photographed(const Rig& rig, std::uint64_t seed = 1) {
  const test::TexturedPlane plane{.normal = {0.05, -0.1, 0.5}, .square_m = 0.08, .seed = seed};
  RandomStream draws({.seed = seed, .source = 204});
  RectifiedPair pair;
  pair.left = test::grey_levels(test::with_noise(photograph(plane, rig, 0), 1.5, draws));
  pair.right = test::grey_levels(test::with_noise(photograph(plane, rig, 1), 1.5, draws));
  return pair;
}

TEST(VerticalField, OfARectifiedPairIsNone) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const VerticalField field = vertical_field(photographed(pair_rig(), seed), {0, 64});
    EXPECT_TRUE(field.known);
    EXPECT_FALSE(field.significant);
    EXPECT_LT(field.largest_px(), 0.06);
    EXPECT_GT(field.used, 60);
  }
}

/// The right camera's centre lower and a roll: dy of a point is its geometry's.
TEST(VerticalField, IsThatOfTheCamerasThatMadeThePair) {
  const struct {
    double lower_px, roll_rad;
  } cases[] = {{0.4, 0}, {2, 0}, {-3, 0}, {0, 0.01}, {1.3, -0.006}};
  for (const auto& c : cases) {
    const Rig rig = pair_rig(c.lower_px, c.roll_rad), level = pair_rig();
    const RectifiedPair pair = photographed(rig);
    const VerticalField field = vertical_field(pair, {0, 64});
    EXPECT_TRUE(field.significant);
    EXPECT_FALSE(field.unrectified);
    const test::TexturedPlane plane{.normal = {0.05, -0.1, 0.5}};
    for (const auto& left_px : {Eigen::Vector2d(200, 150), {380, 10}, {380, 290}, {100, 10}}) {
      const Eigen::Vector3d X = plane.point(level.cameras[0], Pose{}, left_px);
      const Eigen::Vector2d right_px = project(rig.cameras[1], rig.T_camera_first[1] * X);
      EXPECT_NEAR(field.dy_px(right_px.x(), left_px.y()), right_px.y() - left_px.y(), 0.06)
          << c.lower_px << " px, " << c.roll_rad << " rad at " << left_px.transpose();
    }
    RectifiedPair repaired = pair;
    repaired.right = corrected_right(pair.right, field);
    EXPECT_LT(vertical_field(repaired, {0, 64}).largest_px(), 0.08);
  }
}

VerticalField field_of(double a, double b, double c, int w, int h) {
  VerticalField field;
  field.coefficients_px = {a, b, c};
  field.width_px = w;
  field.height_px = h;
  field.known = field.significant = true;
  return field;
}

/// Cubic convolution reproduces parabolas, so that these come out to rounding.
TEST(VerticalField, RepairIsExactOnParabolas) {
  const int w = 37, h = 29;
  const VerticalField field = field_of(0.7, 1.9, -1.3, w, h);
  GreyLevels right{w, h, {}};
  const auto grey = [](double x, double y) { return 40 + 0.5 * x + 2 * y + 0.1 * y * y; };
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) right.values.push_back(static_cast<float>(grey(x, y)));
  }
  const GreyLevels repaired = corrected_right(right, field);
  for (int y = 5; y < h - 5; ++y) {
    for (int x = 0; x < w; ++x) {
      EXPECT_NEAR(repaired(x, y), grey(x, y + field.dy_px(x, y)), 1e-3);
    }
  }
}

TEST(VerticalField, RepairLeavesAlonePairsThatNeedNone) {
  const RectifiedPair pair = photographed(pair_rig());
  EXPECT_EQ(corrected_right(pair.right, vertical_field(pair, {0, 64})).values, pair.right.values);
  const VerticalField whole = field_of(2, 0, 0, width, height);
  const GreyLevels moved = corrected_right(pair.right, whole);
  for (int y = 0; y < height - 2; ++y) {
    for (int x = 0; x < width; ++x) ASSERT_EQ(moved(x, y), pair.right(x, y + 2));
  }
  EXPECT_EQ(moved(7, height - 1), pair.right(7, height - 1));  // beyond the border
}

/// Matches of a known field with normal errors of the sizes stated, a third of them wrong. The mean
/// over 1000 draws (seed 17) of the squared error by the stated covariance is 3 if that is right
/// (3.00 over 3000 draws); its standard deviation is 0.08, so 12 % is a false alarm of 1e-5.
TEST(VerticalField, FitStatesItsErrorAndIsNotLedAstray) {
  const VerticalField truth = field_of(1.2, -2.5, 0.6, 450, 375);
  double nees = 0;
  const int trials = 1000;
  for (int trial = 0; trial < trials; ++trial) {
    RandomStream draws({.seed = 17, .trial = static_cast<std::uint32_t>(trial), .source = 205});
    std::vector<VerticalOffset> offsets;
    for (int i = 0; i < 75; ++i) {
      VerticalOffset o{{draws.uniform(0, 449), draws.uniform(0, 374)}, 0, draws.uniform(0.01, 0.2)};
      const double error = std::hypot(o.sigma_px, 0.05) * draws.normal();
      const double wrong = draws.uniform(-5, 5);
      o.dy_px = i % 3 == 0 ? wrong : truth.dy_px(o.at_px.x(), o.at_px.y()) + error;
      offsets.push_back(o);
    }
    const VerticalField field = fit_vertical_field(offsets, 75, {450, 375});
    EXPECT_TRUE(field.known);
    EXPECT_TRUE(field.significant);
    const Eigen::Vector3d e = field.coefficients_px - truth.coefficients_px;
    EXPECT_LT(e.cwiseAbs().maxCoeff(), 0.35);
    nees += e.dot(field.covariance_px2.inverse() * e);
  }
  EXPECT_GT(nees / trials, 0.88 * 3);
  EXPECT_LT(nees / trials, 1.12 * 3);
}

TEST(VerticalField, SaysWhatItFound) {
  VerticalField field = vertical_field(photographed(pair_rig(2)), {0, 64});
  EXPECT_NE(describe(field).find("the right image is 2.0"), std::string::npos);
  EXPECT_NE(describe(field).find("px lower"), std::string::npos);
  field = vertical_field(photographed(pair_rig()), {0, 64});
  EXPECT_NE(describe(field).find("no significant vertical offset"), std::string::npos);
}

/// Beyond half a pixel rms over the image matches are wrong more often than stated.
TEST(VerticalField, OfMoreThanHalfAPixelIsNotTrusted) {
  for (const double lower_px : {0.0, 0.3, -0.4, 0.7, -2.0}) {
    const VerticalField field = vertical_field(photographed(pair_rig(lower_px)), {0, 64});
    EXPECT_EQ(field.misaligned, std::abs(lower_px) > 0.5) << lower_px;
    EXPECT_NEAR(field.rms_px(), std::abs(lower_px), 0.06);
  }
  EXPECT_NEAR(field_of(0.3, -1.2, 0.9, 100, 80).rms_px(), std::sqrt(0.09 + 2.25 / 12), 1e-12);
  EXPECT_TRUE(vertical_field(photographed(pair_rig(0, 0.01)), {0, 64}).misaligned);  // 1.2 px rms
}

/// Residuals where Tukey's ψ falls, at the sides of the image: with their size, 0.98 σ, the
/// curvature of the cost passes through 0, and a field that most matches agree on to the last digit
/// was taken for unknown.
TEST(VerticalField, IsKnownWhereManyResidualsAreAtTheKernelsEdge) {
  for (double size = 0.95; size < 1; size += 0.001) {
    std::vector<VerticalOffset> offsets;
    for (int i = 0; i < 400; ++i) {
      const int x = i / 10, y = i % 10;
      VerticalOffset o{{5.0 + 11 * x, 5.0 + 40 * y}, 1.2, 0.1};
      const double off_px = size * std::hypot(o.sigma_px, 0.05);
      if (std::min(x, 39 - x) < 5) o.dy_px += (x + y) % 2 == 0 ? off_px : -off_px;
      offsets.push_back(o);
    }
    const VerticalField field = fit_vertical_field(offsets, 400, {450, 375});
    EXPECT_TRUE(field.known && field.misaligned) << size;
    EXPECT_LT(field.covariance_px2.diagonal().maxCoeff(), 0.01) << size;
    EXPECT_NEAR(field.coefficients_px[0], 1.2, 0.05) << size;
  }
}

/// One that might be noise is not held against a pair.
TEST(VerticalField, OfFewMatchesIsNotCalledMisaligned) {
  RandomStream draws({.seed = 21, .source = 207});
  int known = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<VerticalOffset> offsets;
    for (int i = 0; i < 24; ++i) {
      offsets.push_back({{draws.uniform(0, 449), draws.uniform(0, 374)}, draws.normal(), 0.5});
    }
    const VerticalField field = fit_vertical_field(offsets, 40, {450, 375});
    known += field.known;
    EXPECT_FALSE(field.misaligned);
  }
  EXPECT_GT(known, 0);
}

TEST(VerticalField, ImagesThatAreNotRectifiedAreSaidToBe) {
  for (const Rig& rig : {pair_rig(30), pair_rig(0, 0.1), pair_rig(-5.4)}) {
    const VerticalField field = vertical_field(photographed(rig), {0, 64});
    EXPECT_TRUE(field.unrectified);
    EXPECT_NE(describe(field).find("rectified"), std::string::npos);
  }
  RectifiedPair strangers = photographed(pair_rig());
  strangers.right = photographed(pair_rig(), 99).right;
  const VerticalField field = vertical_field(strangers, {0, 64});
  EXPECT_TRUE(field.unrectified);
  EXPECT_FALSE(field.known);
  EXPECT_NE(describe(field).find("not of one scene"), std::string::npos);
}

/// A chessboard in front of a plain wall, turned a little in its plane.
struct ChessPlane : test::TexturedPlane {
  double turn_rad = 0;

  double grey(const Eigen::Vector3d& X) const {
    const double c = std::cos(turn_rad), s = std::sin(turn_rad);
    const double x = (c * X.x() + s * X.y()) / square_m, y = (-s * X.x() + c * X.y()) / square_m;
    if (std::abs(x) > 5 || std::abs(y) > 3.5) return 150;
    const bool is_dark = (std::lround(std::floor(x)) + std::lround(std::floor(y))) % 2 != 0;
    return is_dark ? 35 : 220;
  }
};

RectifiedPair of_board(const ChessPlane& left, const ChessPlane& right, const Rig& rig) {
  RandomStream draws({.seed = 7, .source = 208});
  RectifiedPair pair;
  pair.left = test::grey_levels(test::with_noise(photograph(left, rig, 0), 1.5, draws));
  pair.right = test::grey_levels(test::with_noise(photograph(right, rig, 1), 1.5, draws));
  return pair;
}

/// Of a chessboard's corners hardly one has a single partner, yet their rows tell the field.
TEST(VerticalField, IsThatOfAPatternThatRepeats) {
  for (const double turn_rad : {0.02, 0.2}) {
    const ChessPlane board{{.normal = {0.05, -0.1, 0.7}, .square_m = 0.1}, turn_rad};
    const VerticalField level = vertical_field(of_board(board, board, pair_rig()), {0, 64});
    EXPECT_TRUE(level.known) << describe(level);
    EXPECT_FALSE(level.unrectified || level.misaligned);
    EXPECT_LT(level.largest_px(), 0.2);
    const VerticalField lower = vertical_field(of_board(board, board, pair_rig(2)), {0, 64});
    EXPECT_TRUE(lower.known && lower.misaligned) << describe(lower);
    EXPECT_NEAR(lower.dy_px(200, 150), 2, 0.2);
  }
  // A fine mesh tells no rows: all rows a few pixels apart are as good.
  const ChessPlane mesh{{.normal = {0.02, 0.01, 0.7}, .square_m = 0.014}, 0.0};
  const VerticalField of_mesh = vertical_field(of_board(mesh, mesh, pair_rig()), {0, 64});
  EXPECT_FALSE(of_mesh.known && of_mesh.largest_px() > 0.5) << describe(of_mesh);
  // Another board is not taken for the same.
  const ChessPlane one{{.normal = {0.05, -0.1, 0.7}, .square_m = 0.1}, 0.1},
      other{{.normal = {-0.3, 0.2, 0.6}, .square_m = 0.1}, -0.3};
  EXPECT_FALSE(vertical_field(of_board(one, other, pair_rig()), {0, 64}).known);
}

TEST(VerticalField, TooLittleToTellIsSaid) {
  GreyLevels blank{200, 100, std::vector<float>(20000, 77)};
  GreyLevels tiny{9, 7, std::vector<float>(63, 1)};
  for (const GreyLevels& image : {blank, tiny, GreyLevels{}}) {
    const VerticalField field = vertical_field(RectifiedPair{image, image}, {0, 20});
    EXPECT_FALSE(field.known || field.unrectified || field.significant);
    EXPECT_NE(describe(field).find("too few corners"), std::string::npos);
    EXPECT_EQ(corrected_right(image, field).values, image.values);
  }
}

/// White walls about a poster: the noise there has corners that match nothing, which does not make
/// the pair another one.
TEST(VerticalField, WhiteWallsAreNotTakenForAnotherScene) {
  RectifiedPair pair = photographed(pair_rig());
  RandomStream draws({.seed = 5, .source = 206});
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y * width + x);
      if (y < 100 || y > 220 || x < 160 || x > 300) {
        pair.left.values[i] = static_cast<float>(200 + 2 * draws.normal());
      }
      if (y < 100 || y > 220 || x < 130 || x > 270) {
        pair.right.values[i] = static_cast<float>(200 + 2 * draws.normal());
      }
    }
  }
  const VerticalField field = vertical_field(pair, {0, 64});
  EXPECT_FALSE(field.unrectified);
  EXPECT_FALSE(field.significant);
}

TEST(VerticalField, BadInputIsNamed) {
  const GreyLevels image{64, 64, std::vector<float>(64 * 64, 1)};
  const GreyLevels other{64, 60, std::vector<float>(64 * 60, 1)};
  const GreyLevels broken{64, 64, std::vector<float>(5, 1)};
  const auto error_output = [](const RectifiedPair& pair, DisparityRange range = {0, 10},
                               VerticalFieldOptions options = {}) {
    return test::error_message([&] { vertical_field(pair, range, options); });
  };
  EXPECT_NE(error_output({image, other}).find("64x64 px, the right one 64x60"), std::string::npos);
  EXPECT_NE(error_output({image, broken}).find("5 values"), std::string::npos);
  EXPECT_NE(error_output({image, image}, {5, 4}).find("range 5 to 4"), std::string::npos);
  EXPECT_NE(error_output({image, image}, {0, 9}, {.band_px = 0}).find("0 rows"), std::string::npos);
  EXPECT_NE(error_output({image, image}, {0, 9}, {.corners = 0}).find("0 corners"),
            std::string::npos);
  EXPECT_THROW(corrected_right(image, field_of(1, 0, 0, 64, 60)), Error);
}

}  // namespace
}  // namespace vernier
