// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// What rectification leaves of image noise, and what of it moves edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/random.h"
#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification.h"
#include "stereo/rectified_images.h"
#include "tests/support/edge_images.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::stereo;

namespace {

constexpr int noise_width = 240, noise_height = 200;
constexpr double noise = 2;

/// Two pinholes whose axes converge by 1 degree: their images are resampled at all sub-pixel
/// places.
Rig converging_rig() {
  Rig rig;
  for (const char* name : {"left", "right"}) {
    Camera camera;
    camera.name = name;
    camera.model = Pinhole{};
    camera.size_px = {noise_width, noise_height};
    camera.parameters = Eigen::Vector4d(300, 1, 119.5, 99.5);
    rig.cameras.push_back(camera);
  }
  const Eigen::Matrix3d R = rotation_from_vector({0.01, 0.0175, 0.02});
  rig.T_camera_first = {Pose{}, Pose{R, R * Eigen::Vector3d(-0.1, 0.002, 0)}};
  return rig;
}

/// With white noise by seed.
GreyLevels with_noise(GreyLevels image, std::uint64_t seed) {
  vernier::internal::RandomStream draws({.seed = seed});
  const Eigen::VectorXd n = draws.normals(noise_width * noise_height);
  for (int i = 0; i < noise_width * noise_height; ++i)
    image.values[std::size_t(i)] += float(noise * n[i]);
  return image;
}

/// The slanted edge of contrast 60, with white noise by seed; 0: none.
GreyLevels edge_image(std::uint64_t seed) {
  const test::Step step{{120, 100}, 0.3};
  GreyLevels image =
      test::sampled(noise_width, noise_height, [&](const auto& p) { return step.level(p); });
  return seed == 0 ? image : with_noise(std::move(image), seed);
}

/// Edge points against those of the image without noise: errors along the normal in units of sigma.
std::vector<double> normalised_errors(bool of_raw) {
  const Rig rig = converging_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  const GreyLevels clean = edge_image(0);
  const auto truth = canny_edges(rectified_images(rig, g, clean, clean).pair.left);
  std::vector<double> z;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    const GreyLevels raw = edge_image(seed);
    const RectifiedImages images = rectified_images(rig, g, raw, raw);
    EXPECT_NEAR(images.pair.left_noise.levels, noise, 0.1 * noise);
    EXPECT_EQ(images.pair.left_noise.levels, images.pair.right_noise.levels);
    CannyOptions options;
    if (of_raw) options.noise = images.pair.left_noise.per_pixel();
    for (const EdgePoint& e : canny_edges(images.pair.left, options)) {
      for (const EdgePoint& t : truth) {
        if (t.y != e.y || std::abs(t.row_x_px - e.row_x_px) > 2) continue;
        z.push_back(double(t.normal.x() * (e.row_x_px - t.row_x_px)) / e.sigma_px);
      }
    }
  }
  return z;
}

double rms_of(const std::vector<double>& z) {
  double squares = 0;
  for (const double x : z) squares += x * x;
  return std::sqrt(squares / double(z.size()));
}

// About 4,000 points, whose noise is correlated over four: the rms has a standard error of 0.03.
TEST(RectifiedNoise, EdgesScatterByTheNoiseOfTheRawImage) {
  const std::vector<double> z = normalised_errors(true);
  ASSERT_GT(z.size(), 3000u);
  RecordProperty("rms_z", std::to_string(rms_of(z)));
  EXPECT_GT(rms_of(z), 0.85);
  EXPECT_LT(rms_of(z), 1.15);
}

TEST(RectifiedNoise, TheRectifiedImageAloneShowsTooLittle) {
  const std::vector<double> z = normalised_errors(false);
  RecordProperty("rms_z", std::to_string(rms_of(z)));
  EXPECT_GT(rms_of(z), 1.4);
}

/// Bars of contrast 60 and 20 far away, blurred by 1.5 px, as a camera turned by R sees them.
GreyLevels far_bars(const Eigen::Matrix3d& R) {
  const auto level = [&](const Eigen::Vector2d& pixel) {
    const Eigen::Vector3d ray =
        R.transpose() * Eigen::Vector3d((pixel.x() - 119.5) / 300, (pixel.y() - 99.5) / 300, 1);
    const Eigen::Vector2d at = 300 * ray.hnormalized();
    double grey = 60;
    for (int bar = -4; bar <= 4; ++bar) {
      const double contrast = bar % 2 == 0 ? 60 : 20;
      for (const int side : {0, 1}) {
        const test::Step step{{40.0 * bar + 20 * side, 0}, 0.25, 0, 1.5, 0, contrast};
        grey += side == 0 ? step.level(at) : -step.level(at);
      }
    }
    return grey;
  };
  return test::sampled(noise_width, noise_height, level);
}

/// Disparities of far bars, which are 0, in units of their standard deviation.
std::vector<double> normalised_disparities(bool of_raw) {
  const Rig rig = converging_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  EdgeMatcherOptions options;
  const GreyLevels left = far_bars(rig.T_camera_first[0].R),
                   right = far_bars(rig.T_camera_first[1].R);
  options.sigma_floor_px = 0;  // noise is all there is
  std::vector<double> z;
  for (std::uint64_t seed = 100; seed < 112; ++seed) {
    RectifiedImages images =
        rectified_images(rig, g, with_noise(left, 2 * seed), with_noise(right, 2 * seed + 1));
    if (!of_raw) images.pair.left_noise = images.pair.right_noise = {};
    const std::vector<EdgePoint> points = canny_edges(images.pair.left);
    for (const EdgeMatch& match : match_edges(images.pair, points, {-5, 5}, options)) {
      if (match.refined) z.push_back(double(match.at.disparity_px / match.at.sigma_px));
    }
  }
  return z;
}

// Some 12,000 points, correlated over seven rows and the edge's width: the rms of the z of some
// 1,000 independent ones has a standard error of 0.03.
TEST(RectifiedNoise, DisparitiesScatterByTheNoiseOfTheRawImage) {
  const std::vector<double> z = normalised_disparities(true);
  ASSERT_GT(z.size(), 5000u);
  RecordProperty("rms_z", std::to_string(rms_of(z)));
  EXPECT_GT(rms_of(z), 0.75);
  EXPECT_LT(rms_of(z), 1.2);
  EXPECT_GT(rms_of(normalised_disparities(false)), 1.25 * rms_of(z));
}

TEST(RectifiedNoise, EdgesAreTheSameWhateverTheNoise) {
  const GreyLevels image = edge_image(3);
  CannyOptions stated;
  stated.noise = 4;
  const auto a = canny_edges(image), b = canny_edges(image, stated);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].pixel_px, b[i].pixel_px);
    EXPECT_GT(b[i].sigma_px, 1.5 * a[i].sigma_px);
  }
  for (const double wrong : {-1.0, 256.0, std::nan("")}) {
    stated.noise = wrong;
    EXPECT_NE(test::error_message([&] { canny_edges(image, stated); }).find("noise"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace vernier
