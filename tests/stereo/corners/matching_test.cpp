// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "stereo/corners/corner_image.h"
#include "stereo/corners/corner_match.h"
#include "stereo/corners/corner_matching.h"
#include "stereo/corners/epipolar_band.h"
#include "stereo/corners/match_support.h"
#include "stereo/image/patch_alignment.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"
#include "tests/support/textured_plane.h"
#include "tests/support/wedge_image.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo::internal;

namespace {

/// A camera with images reduced by a factor.
void reduce(Camera& camera, int factor) {
  camera.size_px /= factor;
  camera.parameters.head<4>() << camera.f_px() / factor, camera.ax(), camera.ox_px() / factor,
      camera.oy_px() / factor;
}

/// The test rig at half the size.
Rig small_rig() {
  Rig rig = test::stereo_rig();
  for (Camera& camera : rig.cameras) reduce(camera, 2);
  return rig;
}

/// A rig with a plane in front of it at about 2 m.
struct Pair {
  explicit Pair(const Rig& of = small_rig(), double noise = 2) : rig(of) {
    cv::Mat noisy[2];
    for (int c = 0; c < 2; ++c) {
      RandomStream draws({.seed = 3, .feature = std::uint32_t(c), .source = 204});
      clean[c] = test::photograph(plane, rig, c);
      noisy[c] = test::with_noise(clean[c], noise, draws);
    }
    image = corner_images(noisy[0], noisy[1], rig, {.count = 300});
  }

  Eigen::Vector2d true_right(const Eigen::Vector2d& left_px) const {
    return pixel_pair(rig, plane.point(rig.cameras[0], Pose{}, left_px))->other_px;
  }

  static Eigen::MatrixXd covariance(const Rig& rig) {
    Eigen::VectorXd sigma = Eigen::VectorXd::Constant(parameter_count(rig), 1e-3);
    sigma.segment<4>(0) << 1, 0.002, 1, 1;
    sigma.segment<4>(5) << 1, 0.002, 1, 1;
    return sigma.cwiseAbs2().asDiagonal();
  }

  Rig rig;
  test::TexturedPlane plane;
  cv::Mat clean[2];
  CornerImages image;
};

const Pair& pair() {
  static const Pair made;
  return made;
}

std::vector<CornerMatch> matched(const CornerMatchingOptions& options = {}) {
  const EpipolarBand band(pair().rig, Pair::covariance(pair().rig), {.nearest_m = 1});
  return match_corners(pair().image.left, pair().image.right, band, options);
}

/// Of the right pixel against the left one's true place, across the epipolar curve.
double error_across(const CornerMatch& match, const Pair& of = pair()) {
  const Eigen::Vector2d truth = of.true_right(match.left_px);
  const Eigen::Vector3d X = of.plane.point(of.rig.cameras[0], Pose{}, match.left_px);
  const Eigen::Vector2d along = (pixel_pair(of.rig, 0.99 * X)->other_px - truth).normalized();
  const Eigen::Vector2d error = match.right_px - truth;
  return along.x() * error.y() - along.y() * error.x();
}

TEST(CornerMatching, FindsMostAndHardlyAnyWrong) {
  const auto matches = matched();
  EXPECT_GT(matches.size(), 0.6 * pair().image.left.corners.size());
  int wrong = 0;
  std::vector<double> across;
  for (const CornerMatch& match : matches) {
    wrong += (match.right_px - pair().true_right(match.left_px)).norm() > 1;
    across.push_back(std::abs(error_across(match)));
  }
  std::sort(across.begin(), across.end());
  RecordProperty("median_error_across_px", std::to_string(across[across.size() / 2]));
  EXPECT_LT(across[across.size() / 2], 0.03);
  RecordProperty("matches", static_cast<int>(matches.size()));
  RecordProperty("wrong", wrong);
  EXPECT_LE(wrong, 1);
}

/// Error across the epipolar curve over the stated deviation of a difference of two coordinates, at
/// a noise that outweighs what interpolation does (0.02 px), so without the floor that is for it.
/// About 200 matches: the standard deviation of their mean square is 0.1, of their mean 0.07.
TEST(CornerMatching, StatesItsNoise) {
  constexpr double noise = 8;
  CornerImage images[2];
  for (int c = 0; c < 2; ++c) {
    RandomStream draws({.seed = 4, .feature = std::uint32_t(c), .source = 204});
    images[c] =
        corner_image(test::with_noise(pair().clean[c], noise, draws), {.count = 300 + 150 * c});
  }
  const EpipolarBand band(pair().rig, Pair::covariance(pair().rig), {.nearest_m = 1});
  const auto matches =
      match_corners(images[0], images[1], band, {.min_aligned_score = 0.8, .sigma_floor_px = 0});
  ASSERT_GT(matches.size(), 120u);
  double squares = 0, mean = 0, variance = 0;
  const auto n = static_cast<double>(matches.size());
  for (const CornerMatch& match : matches) {
    const double error = error_across(match);
    const double z = error / (std::sqrt(2.0) * match.sigma_px);
    squares += z * z / n;
    mean += z / n;
    variance += error * error / n;
  }
  RecordProperty("matches", static_cast<int>(matches.size()));
  RecordProperty("rms_px", std::to_string(std::sqrt(variance)));
  RecordProperty("z_mean", std::to_string(mean));
  RecordProperty("z_mean_square", std::to_string(squares));
  EXPECT_NEAR(mean, 0, 5 / std::sqrt(n));
  EXPECT_LT(squares, 1.5);
  EXPECT_GT(squares, 0.6);
}

struct UnlikeCameras {
  std::string name;
  std::function<void(Rig&)> change;
  double left_px_per_right_px = 1;  ///< sizes of things, right ÷ left
};

/// Turned about its optical axis, with the principal point in the middle: the same points are seen.
void roll(Rig& rig, double angle_rad) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  rig.T_camera_first[1] = {turn * rig.T_camera_first[1].R, turn * rig.T_camera_first[1].t};
}

const std::vector<UnlikeCameras>& unlike_cameras() {
  static const std::vector<UnlikeCameras> all = {
      {"rolled by 10 degrees", [](Rig& rig) { roll(rig, 10 * std::numbers::pi / 180); }},
      {"upside down", [](Rig& rig) { roll(rig, std::numbers::pi); }},
      {"a quarter turn",
       [](Rig& rig) {
         roll(rig, std::numbers::pi / 2);
         Camera& camera = rig.cameras[1];
         std::swap(camera.size_px[0], camera.size_px[1]);
         const double ox = camera.ox_px();
         camera.parameters[2] = camera.oy_px();
         camera.parameters[3] = ox;
       }},
      {"verged",
       [](Rig& rig) {
         const Eigen::Matrix3d turn =
             Eigen::AngleAxisd(0.25, Eigen::Vector3d::UnitY()).toRotationMatrix();
         rig.T_camera_first[1] = {turn * rig.T_camera_first[1].R, turn * rig.T_camera_first[1].t};
       }},
      {"half the pixels", [](Rig& rig) { reduce(rig.cameras[1], 2); }, 0.5},
      {"a longer lens", [](Rig& rig) { rig.cameras[1].parameters[0] *= 1.6; }, 1.6},
  };
  return all;
}

class CornersOfUnlikeCameras : public testing::TestWithParam<int> {};

/// Most of what both see is matched, hardly any of it wrongly, and with errors as stated: the mean
/// square of 90 to 250 errors over their standard deviations is itself known to 0.15 at most.
TEST_P(CornersOfUnlikeCameras, AreMatchedAsWell) {
  const UnlikeCameras& unlike = unlike_cameras()[static_cast<std::size_t>(GetParam())];
  Rig rig = small_rig();
  unlike.change(rig);
  const Pair made(rig, 8);  // noise that outweighs what interpolation does
  const double larger = unlike.left_px_per_right_px;
  EXPECT_NEAR(made.image.right.reduction, std::max(1.0, larger), 0.02) << unlike.name;
  EXPECT_NEAR(made.image.left.reduction, std::max(1.0, 1 / larger), 0.02) << unlike.name;
  const EpipolarBand band(rig, Pair::covariance(rig), {.nearest_m = 1});
  const auto matches = match_corners(made.image.left, made.image.right, band,
                                     {.min_aligned_score = 0.8, .sigma_floor_px = 0});
  int visible = 0;
  for (const ImageCorner& corner : made.image.left.corners) {
    visible += in_image(rig.cameras[1], made.true_right(corner.pixel_px));
  }
  int wrong = 0;
  double squares = 0;
  const double ratio = unlike.left_px_per_right_px;
  for (const CornerMatch& match : matches) {
    const double error = error_across(match, made);
    wrong += (match.right_px - made.true_right(match.left_px)).norm() > std::max(1.0, ratio);
    squares += std::min(25.0, std::pow(error / match.sigma_px, 2) / (1 + ratio * ratio));
  }
  squares /= static_cast<double>(matches.size());
  RecordProperty("camera", unlike.name);
  RecordProperty("visible", visible);
  RecordProperty("matches", static_cast<int>(matches.size()));
  RecordProperty("wrong", wrong);
  RecordProperty("z_mean_square", std::to_string(squares));
  EXPECT_GT(matches.size(), 0.5 * visible) << unlike.name;
  EXPECT_LE(wrong, 2) << unlike.name;
  EXPECT_LT(squares, 1.6) << unlike.name;
  EXPECT_GT(squares, 0.5) << unlike.name;
}

INSTANTIATE_TEST_SUITE_P(All,
                         CornersOfUnlikeCameras,
                         testing::Range(0, static_cast<int>(unlike_cameras().size())));

TEST(CornerMatching, IsTheSameFromTheOtherSide) {
  Rig exchanged;
  exchanged.cameras = {pair().rig.cameras[1], pair().rig.cameras[0]};
  exchanged.T_camera_first = {Pose{}, pair().rig.T_camera_first[1].inverse()};
  const EpipolarBand band(exchanged, Pair::covariance(exchanged), {.nearest_m = 1});
  std::map<int, int> back;
  for (const CornerMatch& match : match_corners(pair().image.right, pair().image.left, band)) {
    back[match.right] = match.left;
  }
  const auto matches = matched();
  const auto same = std::count_if(matches.begin(), matches.end(), [&](const CornerMatch& match) {
    const auto at = back.find(match.left);
    return at != back.end() && at->second == match.right;
  });
  EXPECT_GT(same, 0.9 * static_cast<double>(matches.size()));
  EXPECT_GT(same, 0.9 * static_cast<double>(back.size()));
}

TEST(CornerMatching, FindsHardlyAnythingWithTheImagesExchanged) {
  const EpipolarBand band(pair().rig, Pair::covariance(pair().rig), {.nearest_m = 1});
  EXPECT_LT(match_corners(pair().image.right, pair().image.left, band).size(),
            0.1 * matched().size());
}

TEST(CornerMatching, RefusesSenselessOptions) {
  EXPECT_EQ(test::error_message([] { matched({.gate_probability = 1}); }),
            "matching: gate_probability is not between 0 and 1; use e.g. 0.997");
  EXPECT_EQ(
      test::error_message([] { matched({.patch_half_px = 0}); }),
      "matching: the patch size or the number of neighbours is not positive; use integers above 1");
}

TEST(MatchSupport, TakesOutTheOneThatDisagrees) {
  std::vector<CornerMatch> matches;
  for (int i = 0; i < 30; ++i) {
    CornerMatch match;
    match.left = i;
    match.left_px = Eigen::Vector2d(20 * (i % 6), 20 * (i / 6));
    match.right_px = match.left_px - Eigen::Vector2d(15 + 0.1 * match.left_px.x(), 0);
    matches.push_back(match);
  }
  EXPECT_EQ(supported(matches, {}).size(), 30u);
  matches[14].right_px.x() -= 30;
  const auto kept = supported(matches, {});
  ASSERT_EQ(kept.size(), 29u);
  EXPECT_TRUE(std::none_of(kept.begin(), kept.end(), [](const auto& m) { return m.left == 14; }));
  matches.resize(10);
  EXPECT_EQ(supported(matches, {}).size(), 10u);
}

/// Alignment of a wedge with itself shifted, sheared and of other contrast: z of both coordinates
/// over 300 draws of noise in both images; the mean χ² is 2 with a standard deviation of 0.12.
TEST(PatchAlignment, FindsTheShiftAsWellAsItSays) {
  const Eigen::Vector2d tip(30.3, 29.8), shift(0.37, -0.21);
  test::Wedge left{tip, 1.7, 0.4}, right{tip + shift, 1.7, 0.4, 90, 170};
  const cv::Mat clean_left = test::photograph(left, 60), clean_right = test::photograph(right, 60);
  double chi2 = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  constexpr int n = 300;
  for (int i = 0; i < n; ++i) {
    RandomStream draws({.seed = 8, .trial = std::uint32_t(i), .source = 205});
    cv::Mat images[2];
    test::with_noise(clean_left, 2, draws).convertTo(images[0], CV_32F);
    test::with_noise(clean_right, 2, draws).convertTo(images[1], CV_32F);
    const auto aligned = align_patch(images[0], images[1], tip, {30, 30}, {1, 0},
                                     {.noise_left = 2, .noise_right = 2});
    ASSERT_TRUE(aligned);
    EXPECT_GT(aligned->score, 0.9);
    const Eigen::Vector2d error = aligned->right_px - tip - shift;
    mean += error / n;
    chi2 += error.dot(aligned->covariance_px2.inverse() * error) / n;
  }
  RecordProperty("mean_chi2", std::to_string(chi2));
  RecordProperty("bias_px", std::to_string(mean.norm()));
  EXPECT_LT(mean.norm(), 0.03);
  EXPECT_NEAR(chi2, 2, 0.8);
}

TEST(PatchAlignment, FollowsASlantFromNearBy) {
  const Pair& p = pair();
  int settled = 0, near = 0;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d left_px = p.image.left.corners[i].pixel_px;
    const Eigen::Vector2d truth = p.true_right(left_px);
    if (!in_image(p.rig.cameras[1], truth - Eigen::Vector2d(10, 0))) continue;
    const auto aligned = align_patch(p.image.left.grey, p.image.right.grey, left_px,
                                     truth + Eigen::Vector2d(0.4, -0.3), {1, 0});
    if (!aligned) continue;
    ++settled;
    near += (aligned->right_px - truth).norm() < 0.1;
  }
  RecordProperty("settled", settled);
  RecordProperty("near", near);
  EXPECT_GE(settled, 35);
  EXPECT_GE(near, 0.9 * settled);
}

TEST(PatchAlignment, RefusesABlank) {
  const cv::Mat blank(50, 50, CV_32F, cv::Scalar(10));
  EXPECT_FALSE(align_patch(blank, blank, {25, 25}, {25, 25}, {1, 0}));
}

TEST(GreyBetween, IsExactForQuadraticsAndPixels) {
  cv::Mat image(12, 12, CV_32F);
  const auto f = [](double x, double y) {
    return 3 + 2 * x - y + 0.5 * x * x - 0.3 * y * y + 0.2 * x * y;
  };
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) image.at<float>(y, x) = float(f(x, y));
  }
  EXPECT_NEAR(grey_between(image, 5, 6), f(5, 6), 1e-5);
  EXPECT_NEAR(grey_between(image, 5.3, 6.7), f(5.3, 6.7), 1e-4);
}

}  // namespace
}  // namespace vernier
