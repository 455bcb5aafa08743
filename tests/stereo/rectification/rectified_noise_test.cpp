// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// What rectification leaves of image noise, and what of it moves edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/random.h"
#include "stereo/canny_edges.h"
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

/// The slanted edge of contrast 60, with white noise by seed; 0: none.
GreyLevels edge_image(std::uint64_t seed) {
  const test::Step step{{120, 100}, 0.3};
  GreyLevels image =
      test::sampled(noise_width, noise_height, [&](const auto& p) { return step.level(p); });
  if (seed == 0) return image;
  vernier::internal::RandomStream draws({.seed = seed});
  const Eigen::VectorXd n = draws.normals(noise_width * noise_height);
  for (int i = 0; i < noise_width * noise_height; ++i)
    image.values[std::size_t(i)] += float(noise * n[i]);
  return image;
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
    EXPECT_NEAR(images.left_noise, noise, 0.1 * noise);
    EXPECT_EQ(images.left_noise, images.right_noise);
    CannyOptions options;
    if (of_raw) options.noise = images.left_noise;
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
