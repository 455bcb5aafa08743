// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Histograms against brute force, for every type, front end and blur.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "calib/statistics/random.h"
#include "localise/pgh.h"
#include "localise/place.h"
#include "stereo/segment.h"
#include "tests/localise/sampled_pgh.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::stereo;

namespace {

std::vector<ImageSegment> random_image_lines(std::uint64_t seed, int count) {
  std::vector<ImageSegment> lines;
  for (int i = 0; i < count; ++i) {
    RandomStream d({.seed = seed, .feature = static_cast<std::uint32_t>(i)});
    const Eigen::Vector2d a{d.uniform(0, 640), d.uniform(0, 480)};
    lines.push_back({a, a + Eigen::Vector2d{d.uniform(-120, 120), d.uniform(-120, 120)}});
  }
  return lines;
}

/// Lines with errors that differ from line to line.
std::vector<PlaceLine> uncertain_room(std::uint64_t seed, int count) {
  std::vector<PlaceLine> room = test::random_room(seed, count);
  for (std::size_t i = 0; i < room.size(); ++i) room[i].sigma_m = 0.03 * (1 + i % 4);
  return room;
}

enum class Front { image, ground, space };

using Case = std::tuple<Front, PghType, PghBlur>;

class SampledPgh : public testing::TestWithParam<Case> {};

/// A stretch counts as even in distance, and its blur as the same all along, which for lines that
/// pass at an angle in space and for errors that grow along a line is not quite so.
TEST_P(SampledPgh, IsTheHistogram) {
  const auto [front, type, blur] = GetParam();
  double least = 1, largest = 0;
  for (const std::uint64_t seed : {3, 21, 22}) {
    PghOptions options = front == Front::image ? image_pgh_options() : PghOptions{};
    options.type = type;
    options.blur = blur;
    options.endpoint_sigma_px = 4;
    Pgh pgh;
    HistogramRows oracle;
    if (front == Front::image) {
      const auto lines = random_image_lines(seed, 10);
      pgh = image_histograms(lines, options);
      oracle = test::sampled_image(lines, options);
    } else if (front == Front::ground) {
      const auto lines = uncertain_room(seed, 12);
      pgh = ground_histograms(lines, options);
      oracle = test::sampled_ground(lines, options);
    } else {
      const auto lines = uncertain_room(seed, 12);
      pgh = spatial_histograms(lines, options);
      oracle = test::sampled_spatial(lines, options);
    }
    ASSERT_EQ(pgh.rows.rows(), oracle.rows());
    ASSERT_EQ(pgh.rows.cols(), oracle.cols());
    ASSERT_EQ(pgh.rows.cols(), pgh.axes.bins());
    const HistogramRows plain = plain_histograms(pgh);
    for (Eigen::Index r = 0; r < oracle.rows(); ++r) {
      least = std::min<double>(least, pgh.rows.row(r).dot(oracle.row(r).cwiseSqrt()));
      largest = std::max<double>(largest, (plain.row(r) - oracle.row(r)).cwiseAbs().sum() / 2);
    }
  }
  RecordProperty("least_coefficient", std::to_string(least));
  RecordProperty("largest_mass_elsewhere", std::to_string(largest));
  EXPECT_GT(least, 0.999);
  EXPECT_LT(largest, 0.02);
}

std::string case_name(const testing::TestParamInfo<Case>& info) {
  const auto [front, type, blur] = info.param;
  const std::string fronts[] = {"image", "ground", "space"};
  const std::string types[] = {"mirror", "rotation", "directed"};
  return fronts[static_cast<int>(front)] + "_" + types[static_cast<int>(type)] +
         (blur == PghBlur::fixed ? "_fixed" : "_per_entry");
}

INSTANTIATE_TEST_SUITE_P(
    All,
    SampledPgh,
    testing::Combine(testing::Values(Front::image, Front::ground, Front::space),
                     testing::Values(PghType::mirror, PghType::rotation, PghType::directed),
                     testing::Values(PghBlur::fixed, PghBlur::per_entry)),
    case_name);

/// The blur of an entry is the spread of what erroneous end points give: mean and standard
/// deviation of angle and distance, over trials and along the line.
TEST(PghBlur, IsThatOfErroneousEnds) {
  const PghOptions options{.type = PghType::directed,
                           .angle_bins = 360,
                           .distance_bins = 400,
                           .max_distance = 200,
                           .blur = PghBlur::per_entry,
                           .endpoint_sigma_px = 2,
                           .max_weight_m = 1e9};
  const ImageSegment reference{{100, 100}, {160, 120}}, other{{180, 60}, {200, 140}};
  const std::vector<ImageSegment> both{reference, other};
  const Pgh pgh = image_histograms(both, options);
  const HistogramRows plain = plain_histograms(pgh);
  Eigen::Vector4d moments = Eigen::Vector4d::Zero();  // means, then mean squares
  for (int a = 0; a < pgh.axes.angle_bins; ++a) {
    for (int d = 0; d < pgh.axes.distance_bins; ++d) {
      const Eigen::Vector2d x((a + 0.5) * pgh.axes.max_angle_rad / pgh.axes.angle_bins,
                              (d + 0.5) * 400 / pgh.axes.distance_bins - 200);
      moments += plain(0, pgh.axes.column(0, a, d)) *
                 Eigen::Vector4d(x.x(), x.y(), x.x() * x.x(), x.y() * x.y());
    }
  }
  Eigen::Vector4d sampled = Eigen::Vector4d::Zero();
  const int trials = 20000;
  RandomStream draw({.seed = 5});
  for (int i = 0; i < trials; ++i) {
    const auto moved = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
      return x + 2 * Eigen::Vector2d{draw.normal(), draw.normal()};
    };
    const Eigen::Vector2d a = moved(reference.a_px), b = moved(reference.b_px);
    const Eigen::Vector2d c = moved(other.a_px), e = moved(other.b_px);
    const Eigen::Vector2d u = (b - a).normalized(), v = (e - c).normalized();
    const double angle = std::atan2(u.x() * v.y() - u.y() * v.x(), u.dot(v));
    const Eigen::Vector2d x = c + draw.uniform() * (e - c) - a;
    const double distance = u.x() * x.y() - u.y() * x.x();
    sampled += Eigen::Vector4d(angle, distance, angle * angle, distance * distance) / trials;
  }
  const auto deviation = [](const Eigen::Vector4d& m, int i) {
    return std::sqrt(m[2 + i] - m[i] * m[i]);
  };
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(moments[i], sampled[i], 0.05 * deviation(sampled, i));
    EXPECT_NEAR(deviation(moments, i), deviation(sampled, i), 0.03 * deviation(sampled, i));
  }
}

}  // namespace
}  // namespace vernier
