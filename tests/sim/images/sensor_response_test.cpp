// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/sensor_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calib/camera.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "sim/images/poisson.h"
#include "tests/support/error_message.h"
#include "tests/support/small_office.h"

namespace vernier::test {
namespace {

using namespace vernier::internal;
using stereo::GreyLevels;

GreyLevels flat(int width, int height, float value) {
  return {width, height, std::vector<float>(static_cast<std::size_t>(width) * height, value)};
}

/// Each of the tests below fails by chance with this probability, at most, in either tail.
constexpr double false_alarm = 1e-5;

TEST(Poisson, FollowsItsDistribution) {
  for (const double mean : {0.3, 4.0, 9.99, 10.01, 60.0, 2500.0}) {
    constexpr int n = 40'000, bins = 12;
    // Bins of about equal probability, by the cumulative distribution.
    std::vector<double> upper, probability;
    double sum = 0, in_bin = 0;
    const double low = std::max(0.0, mean - 40 * std::sqrt(mean));
    for (double k = std::floor(low); sum < 1 - 1e-9 && k < mean + 60 * std::sqrt(mean) + 60; ++k) {
      const double p = std::exp(k * std::log(mean) - mean - std::lgamma(k + 1));
      sum += p;
      in_bin += p;
      if (in_bin >= 1.0 / bins && sum < 1 - 1e-3) {
        upper.push_back(k);
        probability.push_back(in_bin);
        in_bin = 0;
      }
    }
    upper.push_back(1e300);
    double before = 0;
    for (const double p : probability) before += p;
    probability.push_back(1 - before);
    std::vector<int> counts(upper.size(), 0);
    for (int i = 0; i < n; ++i) {
      RandomStream draws({.seed = 11, .feature = static_cast<std::uint32_t>(i)});
      const double k = draw_poisson(draws, mean);
      ASSERT_EQ(k, std::floor(k));
      ++counts[std::lower_bound(upper.begin(), upper.end(), k) - upper.begin()];
    }
    double chi2 = 0;
    for (std::size_t b = 0; b < upper.size(); ++b) {
      chi2 += std::pow(counts[b] - n * probability[b], 2) / (n * probability[b]);
    }
    const double dof = static_cast<double>(upper.size()) - 1;
    EXPECT_GT(chi_squared_survival(chi2, dof), false_alarm) << mean;
    EXPECT_GT(chi_squared_cdf(chi2, dof), false_alarm) << mean;
  }
}

TEST(Sensor, VarianceFollowsTheMeanByThePhotonTransferCurve) {
  SensorOptions options;
  options.exposure = 1;
  options.whole_levels = false;
  const double limit = -normal_quantile(false_alarm);
  for (const double share : {0.01, 0.05, 0.2, 0.5, 0.8}) {
    const GreyLevels image =
        sensed(flat(200, 200, static_cast<float>(share)), options, {.seed = 4});
    const double n = 40'000, gain = 255 / options.full_well_e;
    double mean = 0, variance = 0;
    for (const float v : image.values) mean += v / n;
    for (const float v : image.values) variance += (v - mean) * (v - mean) / (n - 1);
    const double photons = options.full_well_e * share;
    const double expected = photons + options.read_noise_e * options.read_noise_e;
    // Fourth central moment of a Poisson and a normal number together.
    const double fourth = 3 * expected * expected + photons;
    const double z_mean = (mean / gain - photons) / std::sqrt(expected / n);
    const double z_variance =
        (variance / (gain * gain) - expected) / std::sqrt((fourth - expected * expected) / n);
    EXPECT_LT(std::abs(z_mean), limit) << share;
    EXPECT_LT(std::abs(z_variance), limit) << share;
  }
}

TEST(Sensor, EyesPixelsAndImagesAreIndependent) {
  SensorOptions options;
  options.exposure = 1;
  options.whole_levels = false;
  const GreyLevels light = flat(100, 100, 0.5F);
  const GreyLevels left = sensed(light, options, {1, 0, 0}),
                   right = sensed(light, options, {1, 0, 1});
  const GreyLevels next = sensed(light, options, {1, 1, 0});
  const auto correlation = [](const std::vector<float>& a, const std::vector<float>& b) {
    double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
    const auto n = static_cast<double>(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      sa += a[i];
      sb += b[i];
      saa += a[i] * a[i];
      sbb += b[i] * b[i];
      sab += a[i] * b[i];
    }
    return (sab - sa * sb / n) / std::sqrt((saa - sa * sa / n) * (sbb - sb * sb / n));
  };
  std::vector<float> shifted(left.values.begin() + 1, left.values.end());
  shifted.push_back(left.values.front());
  for (const std::vector<float>& other : {right.values, next.values, shifted}) {
    EXPECT_LT(std::abs(correlation(left.values, other)), 0.045);  // 4.5 standard deviations
  }
  EXPECT_EQ(sensed(light, options, {1, 0, 0}).values, left.values);
}

TEST(Sensor, LensDarkensByThePowerOfTheCosine) {
  const Camera camera = nominal_rig().rig.cameras[0];
  SensorOptions options;
  for (const double vignetting : {0.0, 0.3, 1.0}) {
    options.vignetting = vignetting;
    const GreyLevels image = through_lens(flat(640, 480, 0.7F), camera, options);
    for (const auto& [x, y] : {std::pair{0, 0}, {320, 240}, {639, 100}, {50, 470}}) {
      const Eigen::Vector3d ray = unproject(camera, {double(x), double(y)}).normalized();
      EXPECT_NEAR(image(x, y), 0.7 * (1 - vignetting * (1 - std::pow(ray.z(), 4))), 1e-5);
    }
  }
}

TEST(Sensor, PointSpreadIsAGaussianThatKeepsTheSum) {
  const Camera camera = nominal_rig().rig.cameras[0];
  SensorOptions options;
  options.vignetting = 0;
  options.point_spread_px = 1.2;
  GreyLevels point = flat(640, 480, 0);
  point.values[640 * 200 + 300] = 1;
  const GreyLevels spread = through_lens(point, camera, options);
  double sum = 0, xx = 0, yy = 0;
  for (int y = 190; y <= 210; ++y) {
    for (int x = 290; x <= 310; ++x) {
      sum += spread(x, y);
      xx += spread(x, y) * (x - 300) * (x - 300);
      yy += spread(x, y) * (y - 200) * (y - 200);
    }
  }
  EXPECT_NEAR(sum, 1, 1e-5);
  EXPECT_NEAR(std::sqrt(xx), 1.2, 0.01);
  EXPECT_NEAR(std::sqrt(yy), 1.2, 0.01);
}

TEST(Sensor, ExposureAndGammaScaleAsDefined) {
  SensorOptions options;
  options.noise = options.whole_levels = false;
  options.exposure = 0.5;
  EXPECT_NEAR(sensed(flat(2, 2, 0.6F), options)(0, 0), 255 * 0.3, 1e-4);
  options.exposure = 1;
  EXPECT_NEAR(sensed(flat(2, 2, 0.6F), options)(0, 0), 255 * 0.6, 1e-4);
  options.gamma = 2.2;
  EXPECT_NEAR(sensed(flat(2, 2, 0.6F), options)(0, 0), 255 * std::pow(0.6, 1 / 2.2), 1e-3);
  EXPECT_EQ(sensed(flat(2, 2, 7.0F), options)(0, 0), 255);
  options.whole_levels = true;
  EXPECT_EQ(sensed(flat(2, 2, 0.6F), options)(0, 0), std::round(255 * std::pow(0.6F, 1 / 2.2)));
  GreyLevels ramp = flat(101, 1, 0);
  for (int i = 0; i <= 100; ++i) ramp.values[static_cast<std::size_t>(i)] = 0.02F * i;
  EXPECT_NEAR(automatic_exposure(ramp), 0.8 / 1.9, 1e-6);
}

TEST(Sensor, RefusesOptionsOutOfRange) {
  const auto refused = [](auto change, const char* words) {
    SensorOptions options;
    change(options);
    return error_message([&] { check_sensor(options); }).find(words) != std::string::npos;
  };
  EXPECT_TRUE(refused([](SensorOptions& o) { o.point_spread_px = -1; }, "point spread"));
  EXPECT_TRUE(refused([](SensorOptions& o) { o.vignetting = NAN; }, "vignetting"));
  EXPECT_TRUE(refused([](SensorOptions& o) { o.exposure = INFINITY; }, "exposure"));
  EXPECT_TRUE(refused([](SensorOptions& o) { o.full_well_e = 0; }, "full well"));
  EXPECT_TRUE(refused([](SensorOptions& o) { o.read_noise_e = -3; }, "read noise"));
  EXPECT_TRUE(refused([](SensorOptions& o) { o.gamma = 0; }, "gamma"));
}

}  // namespace
}  // namespace vernier::test
