// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectified_images.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/triangulation.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification.h"
#include "stereo/rectification/rectified_camera_info.h"
#include "tests/support/error_message.h"
#include "tests/support/grey_levels.h"
#include "tests/support/scenes.h"
#include "tests/support/textured_plane.h"

namespace vernier {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

class RectifiedByModel : public testing::TestWithParam<const char*> {
 protected:
  Rig rig = test::stereo_rig(camera_model(GetParam()));
};
INSTANTIATE_TEST_SUITE_P(
    Models,
    RectifiedByModel,
    testing::Values("pinhole", "radial1", "opencv4", "opencv5", "opencv8", "fisheye4"));

TEST_P(RectifiedByModel, DepthIsFocalLengthTimesBaselineByDisparity) {
  const RectifiedGeometry g = rectified_geometry(rig);
  for (const Eigen::Vector3d& X :
       {Eigen::Vector3d(0.1, -0.2, 1.5), Eigen::Vector3d(-0.6, 0.5, 2), Eigen::Vector3d(2, 3, 9)}) {
    const PixelPair raw = pixel_pair(rig, X).value();
    const Eigen::Vector2d left = rectified_pixel(rig, g, 0, raw.first_px).value();
    const Eigen::Vector2d right = rectified_pixel(rig, g, 1, raw.other_px).value();
    EXPECT_NEAR(left.y(), right.y(), 1e-9);
    EXPECT_NEAR(g.depth_m(left.x() - right.x()), (g.turn.R_rectified_left * X).z(), 1e-9);
    EXPECT_LT((raw_pixel(rig, g, 0, left).value() - raw.first_px).norm(), 1e-9);
    EXPECT_LT((raw_pixel(rig, g, 1, right).value() - raw.other_px).norm(), 1e-9);
    // The rectified rig sees the point there, too.
    const Rig pinholes = rectified_rig(rig, g);
    const PixelPair seen = pixel_pair(pinholes, g.turn.R_rectified_left * X).value();
    EXPECT_LT((seen.first_px - left).norm() + (seen.other_px - right).norm(), 1e-9);
  }
}

TEST_P(RectifiedByModel, HardlyAnyPixelIsBlankAndTheViewIsAsWideAsThatAllows) {
  const RectifiedGeometry g = rectified_geometry(rig);
  const double mean = 0.5 * (rig.cameras[0].f_px() + rig.cameras[1].f_px());
  EXPECT_GE(g.f_px, 0.7 * mean);
  EXPECT_LE(g.f_px, 1.3 * mean);
  const auto blank = [&](const RectifiedGeometry& geometry) {
    const GreyLevels grey{640, 480, std::vector<float>(640 * 480, 9)};
    const RectifiedImages images = rectified_images(rig, geometry, grey, grey);
    return std::max(images.left_valid.blank_share(), images.right_valid.blank_share());
  };
  EXPECT_LT(blank(g), 0.02);  // chosen on 1200 of the pixels
  if (g.f_px > 0.701 * mean) {
    EXPECT_GT(blank(rectified_geometry(rig, {.f_px = 0.94 * g.f_px})), 0.01);
  }
}

class RectifiedImagesByModel : public RectifiedByModel {};
INSTANTIATE_TEST_SUITE_P(Models, RectifiedImagesByModel, testing::Values("opencv8", "fisheye4"));

/// The rectified images are what pinhole cameras in that orientation would photograph, up to the
/// interpolation: a standard deviation of 3 grey levels on a texture of 47, at half a pixel from
/// the outline of its squares.
TEST_P(RectifiedImagesByModel, AreThoseOfPinholeCameras) {
  const test::TexturedPlane plane{.square_m = 0.2};
  const RectifiedGeometry g = rectified_geometry(rig);
  Rig turned = rectified_rig(rig, g);
  turned.T_camera_first[0] = Pose{g.turn.R_rectified_left, {0, 0, 0}};
  const Pose& T = rig.T_camera_first[1];
  turned.T_camera_first[1] = Pose{g.turn.R_rectified_right * T.R, g.turn.R_rectified_right * T.t};
  const RectifiedImages images =
      rectified_images(rig, g, test::grey_levels(photograph(plane, rig, 0)),
                       test::grey_levels(photograph(plane, rig, 1)));
  for (const int camera : {0, 1}) {
    const GreyLevels& ours = camera == 0 ? images.pair.left : images.pair.right;
    const ValidPixels& valid = camera == 0 ? images.left_valid : images.right_valid;
    const GreyLevels theirs = test::grey_levels(photograph(plane, turned, camera));
    double squares = 0, all = 0, n = 0;
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        if (!valid(x, y)) continue;
        squares += std::pow(ours(x, y) - theirs(x, y), 2);
        all += std::pow(theirs(x, y) - 125, 2);
        ++n;
      }
    }
    EXPECT_GT(n, 0.97 * 640 * 480);
    EXPECT_LT(std::sqrt(squares / n), 3);
    EXPECT_GT(std::sqrt(all / n), 40);
  }
}

/// Which pixels have a source, against the images' outlines taken the other way.
TEST(RectifiedImages, ValidPixelsAreThoseThatTheRawImageCovers) {
  for (const char* model : {"radial1", "fisheye4"}) {
    const Rig rig = test::stereo_rig(camera_model(model));
    const RectifiedGeometry g = rectified_geometry(rig, {.size_px = {400, 300}, .f_px = 200});
    const GreyLevels grey{640, 480, std::vector<float>(640 * 480, 9)};
    const RectifiedImages images = rectified_images(rig, g, grey, grey);
    std::vector<cv::Point2f> outline;
    for (const auto& [from, to] :
         {std::pair(Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(639.5, -0.5)),
          {{639.5, -0.5}, {639.5, 479.5}},
          {{639.5, 479.5}, {-0.5, 479.5}},
          {{-0.5, 479.5}, {-0.5, -0.5}}}) {
      for (int i = 0; i < 100; ++i) {
        const auto p = rectified_pixel(rig, g, 0, from + i / 100.0 * (to - from)).value();
        outline.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
      }
    }
    int valid = 0;
    for (int y = 0; y < 300; ++y) {
      for (int x = 0; x < 400; ++x) {
        const cv::Point2f at(static_cast<float>(x), static_cast<float>(y));
        const double inside = cv::pointPolygonTest(outline, at, true);
        valid += images.left_valid(x, y);
        if (std::abs(inside) > 0.1) {
          ASSERT_EQ(images.left_valid(x, y), inside > 0) << x << ' ' << y;
        }
        // Blank pixels repeat the border, which is 9 here as all is.
        ASSERT_NEAR(images.pair.left(x, y), 9, 1e-4);
      }
    }
    EXPECT_GT(valid, 10000);
    EXPECT_LT(valid, 110000);
    EXPECT_NEAR(images.left_valid.blank_share(), 1 - valid / 120000.0, 1e-12);
  }
}

TEST(RectifiedImages, CamerasSideBySideStayAsTheyAre) {
  Rig rig = test::stereo_rig(Pinhole{});
  for (Camera& camera : rig.cameras) camera.parameters << 500, 1, 319.5, 239.5;
  rig.T_camera_first[1] = Pose{Eigen::Matrix3d::Identity(), {-0.2, 0, 0}};
  const RectifiedGeometry g = rectified_geometry(rig);
  EXPECT_EQ(g.f_px, 500);
  EXPECT_LT((g.centre_px - Eigen::Vector2d(319.5, 239.5)).norm(), 1e-9);
  EXPECT_DOUBLE_EQ(g.baseline_m, 0.2);
  const GreyLevels left = test::grey_levels(photograph(test::TexturedPlane{}, rig, 0));
  const GreyLevels right = test::grey_levels(photograph(test::TexturedPlane{}, rig, 1));
  const RectifiedImages images = rectified_images(rig, g, left, right);
  EXPECT_EQ(images.left_valid.blank_share(), 0);
  for (std::size_t i = 0; i < left.values.size(); ++i) {
    ASSERT_NEAR(images.pair.left.values[i], left.values[i], 1e-3);
    ASSERT_NEAR(images.pair.right.values[i], right.values[i], 1e-3);
  }
}

/// Beyond the fold of its distortion (x_d falls as x grows) a ray lands where another one belongs.
TEST(RectifiedImages, CamerasOneAboveTheOtherGetUprightImages) {
  Rig rig = test::stereo_rig();
  const double baseline_m = rig.T_camera_first[1].t.norm();
  for (const double sign : {1., -1.}) {
    rig.T_camera_first[1].t = {0, sign * baseline_m, 0};
    const RectifiedGeometry g = rectified_geometry(rig);
    EXPECT_EQ(g.size_px, Eigen::Vector2i(rig.cameras[0].size_px.reverse()));
    const auto corner = raw_pixel(rig, g, 0, {5, 5});
    ASSERT_TRUE(corner);  // full to its corners
    EXPECT_GT(corner->minCoeff(), -0.5);
    const Eigen::Vector2i size_px(400, 300);
    EXPECT_EQ(rectified_geometry(rig, {.size_px = size_px}).size_px, size_px);
  }
}

TEST(RectifiedImages, PixelsBeyondTheFoldHaveNoSource) {
  Rig rig = test::stereo_rig(Radial1{});
  for (Camera& camera : rig.cameras) camera.parameters[4] = -0.6;  // folds at r = 0.745
  rig.T_camera_first[1].R.setIdentity();
  const RectifiedGeometry g = rectified_geometry(rig, {.f_px = 300});
  const double beyond = g.centre_px.x() + 300 * 1.05;  // r = 1.05 lands at 0.36
  EXPECT_FALSE(raw_pixel(rig, g, 0, {beyond, g.centre_px.y()}).has_value());
  EXPECT_TRUE(raw_pixel(rig, g, 0, {g.centre_px.x() + 300 * 0.7, g.centre_px.y()}).has_value());
}

TEST(RectifiedImages, AnyNumberOfThreadsGivesTheSameBits) {
  const Rig rig = test::stereo_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  const GreyLevels left = test::grey_levels(photograph(test::TexturedPlane{}, rig, 0));
  const RectifiedImages one = rectified_images(rig, g, left, left, 1);
  const RectifiedImages three = rectified_images(rig, g, left, left, 3);
  EXPECT_EQ(one.pair.left.values, three.pair.left.values);
  EXPECT_EQ(one.pair.right.values, three.pair.right.values);
  EXPECT_EQ(one.right_valid.values, three.right_valid.values);
}

TEST(RectifiedImages, GeometryIsThatOfRosWhereItsFocalLengthIs) {
  const Rig rig = test::stereo_rig();
  const auto infos = rectified_camera_info(rig);
  const RectifiedGeometry g = rectified_geometry(rig, {.f_px = infos[0].P(0, 0)});
  EXPECT_EQ(infos[0].P(0, 2), g.centre_px[0]);
  EXPECT_EQ(infos[1].P(1, 2), g.centre_px[1]);
  EXPECT_EQ(infos[1].P(0, 3), -g.f_px * g.baseline_m);
}

TEST(RectifiedImages, BadInputIsNamed) {
  const Rig rig = test::stereo_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  const GreyLevels good{640, 480, std::vector<float>(640 * 480)};
  const GreyLevels small{320, 240, std::vector<float>(320 * 240)};
  const GreyLevels empty{640, 480, {}};
  EXPECT_NE(test::error_message([&] {
              rectified_images(rig, g, good, small);
            }).find("the image of camera \"right\" is 320x240"),
            std::string::npos);
  EXPECT_NE(test::error_message([&] { rectified_images(rig, g, empty, good); }).find("0 values"),
            std::string::npos);
  Rig one = rig;
  one.cameras.pop_back();
  EXPECT_THROW(rectified_geometry(one), Error);
  EXPECT_THROW(rectified_images(one, g, good, good), Error);
  for (const RectifiedGeometryOptions& o :
       {RectifiedGeometryOptions{.size_px = {0, 5}}, RectifiedGeometryOptions{.size_px = {-1, -1}},
        RectifiedGeometryOptions{.f_px = -1}, RectifiedGeometryOptions{.f_px = NAN},
        RectifiedGeometryOptions{.min_zoom = 0}, RectifiedGeometryOptions{.max_zoom = 0.1},
        RectifiedGeometryOptions{.max_blank = -1}}) {
    EXPECT_THROW(rectified_geometry(rig, o), Error);
  }
}

}  // namespace
}  // namespace vernier
