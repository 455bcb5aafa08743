// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/canny_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <opencv2/core.hpp>

#include "calib/statistics/random.h"
#include "stereo/grey_levels.h"
#include "tests/support/edge_images.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;

namespace {

constexpr int side = 56, within = 20;  // edges are judged away from the image's border
using std::numbers::pi;

test::Step step_at(int angle_deg, int phase, int phases, double blur_px) {
  test::Step step;
  step.centre = {(side - 1) / 2.0, (side - 1) / 2.0};
  step.angle = angle_deg * pi / 180;
  step.offset_px = std::numbers::sqrt2 * ((phase + 0.37) / phases - 0.5);
  step.blur_px = blur_px;
  return step;
}

GreyLevels image_of(const test::Step& step) {
  return test::sampled(side, side, [&](const Eigen::Vector2d& p) { return step.level(p); });
}

bool judged(const EdgePoint& point, const test::Step& step) {
  return (point.pixel_px.cast<double>() - step.centre).norm() < within;
}

/// Sums over points: of errors, by the truth and by what is stated.
struct Errors {
  void add(const EdgePoint& point, const test::Step& step) {
    const double error = step.distance(point.pixel_px.cast<double>());
    const Eigen::Vector2d n = point.normal.cast<double>();
    const Eigen::Vector2d truth = step.normal();
    const double turn = std::atan2(truth.x() * n.y() - truth.y() * n.x(), truth.dot(n));
    ++count;
    squares += error * error;
    z_squares += error * error / (point.sigma_px * point.sigma_px);
    turn_squares += turn * turn;
  }
  double rms() const { return std::sqrt(squares / count); }
  double z() const { return std::sqrt(z_squares / count); }
  double turn_deg() const { return std::sqrt(turn_squares / count) * 180 / pi; }
  int count = 0;
  double squares = 0, z_squares = 0, turn_squares = 0;
};

TEST(CannyEdges, HasNoBiasOnStraightStepsAtAnyAngleAndPhase) {
  for (const double blur_px : {0.7, 0.8}) {
    for (int angle = 0; angle < 360; angle += 5) {
      Errors errors;
      for (int phase = 0; phase < 5; ++phase) {
        const test::Step step = step_at(angle, phase, 5, blur_px);
        for (const EdgePoint& point : canny_edges(image_of(step))) {
          if (judged(point, step)) errors.add(point, step);
        }
      }
      // One point a row, or a column where the edge is flatter.
      const double slope =
          std::max(std::abs(std::cos(angle * pi / 180)), std::abs(std::sin(angle * pi / 180)));
      EXPECT_NEAR(errors.count / 5.0, 2 * within * slope, 0.05 * 2 * within) << angle;
      EXPECT_LT(errors.rms(), 0.001) << angle << "° " << blur_px;
      EXPECT_LT(errors.turn_deg(), 0.03) << angle << "° " << blur_px;
    }
  }
}

/// 60 grey levels of contrast, noise of 2: the error at every angle, and the stated deviation. An
/// angle has 84 images of 35 points, of which 4.6 px hang together: 640 independent errors, so that
/// an rms is within 12 % of its expectation but once in 10 000.
TEST(CannyEdges, ErrsByNoiseAsMuchAsItStates) {
  Errors all;
  for (int angle = 0; angle <= 90; angle += 5) {
    Errors errors;
    for (int phase = 0; phase < 12; ++phase) {
      const test::Step step = step_at(angle, phase, 12, 0.8);
      const GreyLevels clean = image_of(step);
      for (unsigned trial = 0; trial < 7; ++trial) {
        RandomStream draws({31, trial, static_cast<unsigned>(phase), static_cast<unsigned>(angle)});
        for (const EdgePoint& point : canny_edges(test::with_noise(clean, 2, draws))) {
          if (!judged(point, step)) continue;
          errors.add(point, step);
          all.add(point, step);
        }
      }
    }
    RecordProperty("rms_mpx_at_" + std::to_string(angle), static_cast<int>(1000 * errors.rms()));
    EXPECT_NEAR(errors.rms(), 0.039, 0.005) << angle;
    EXPECT_NEAR(errors.z(), 1.02, 0.12) << angle;
    EXPECT_LT(errors.turn_deg(), 1.6) << angle;
  }
  EXPECT_NEAR(all.z(), 1.02, 0.04);
}

/// The stated deviation has no constant: it goes with noise over contrast.
TEST(CannyEdges, StatesADeviationThatGoesWithNoiseOverContrast) {
  const auto stated = [](double contrast, double noise) {
    test::Step step = step_at(30, 0, 1, 0.8);
    step.bright = step.dark + contrast;
    RandomStream draws({32, 1});
    double sum = 0;
    int count = 0;
    for (const EdgePoint& point : canny_edges(test::with_noise(image_of(step), noise, draws))) {
      if (!judged(point, step)) continue;
      sum += point.sigma_px;
      ++count;
    }
    return sum / count;
  };
  const double one = stated(60, 2);
  EXPECT_NEAR(stated(120, 2) / one, 0.5, 0.03);
  EXPECT_NEAR(stated(60, 4) / one, 2, 0.2);
}

TEST(CannyEdges, CrossesTheRowWhereTheEdgeDoes) {
  for (int angle = -60; angle <= 60; angle += 5) {
    const test::Step step = step_at(angle, 1, 5, 0.8);
    for (const EdgePoint& point : canny_edges(image_of(step))) {
      if (!judged(point, step)) continue;
      EXPECT_NEAR(step.distance({point.row_x_px, point.y}), 0, 0.005) << angle;
    }
  }
  const test::Step flat = step_at(90, 1, 5, 0.8);  // along the rows: nowhere, but not far
  for (const EdgePoint& point : canny_edges(image_of(flat))) {
    EXPECT_LE(std::abs(point.row_x_px - static_cast<float>(point.x)), 1.5F);
  }
}

/// contrast / (√(2π) s), with s² = scale² + blur² + 1/12 of the pixel.
TEST(CannyEdges, HasTheStrengthOfTheGradient) {
  const test::Step step = step_at(20, 2, 5, 0.8);
  const double s = std::sqrt(1 + 0.64 + 1.0 / 12);
  float most = 0;
  for (const EdgePoint& point : canny_edges(image_of(step))) most = std::max(most, point.strength);
  EXPECT_NEAR(most, 60 / (std::sqrt(2 * pi) * s), 0.3);
}

/// An edge whose contrast falls along its length; `factor` times as strong.
GreyLevels fading_step(double factor) {
  return test::sampled(120, 40, [&](const Eigen::Vector2d& p) {
    const double contrast = factor * 60 * (1 - p.x() / 120);
    return 100 + contrast * 0.5 * std::erfc(-(p.y() - 20.3) / (0.8 * std::numbers::sqrt2));
  });
}

TEST(CannyEdges, FollowsAWeakEdgeFromAStrongOneOnly) {
  const auto min_strength = [](const std::vector<EdgePoint>& edges) {
    float least = 1e9F;
    for (const EdgePoint& point : edges) least = std::min(least, point.strength);
    return least;
  };
  const auto strong = canny_edges(fading_step(1));
  ASSERT_GT(strong.size(), 90U);
  EXPECT_NEAR(min_strength(strong), 2, 0.3);            // down to `low`
  EXPECT_TRUE(canny_edges(fading_step(0.25)).empty());  // 4.5 at most, never `high`
  EXPECT_GT(canny_edges(fading_step(0.25), {.high = 4}).size(), 40U);
  EXPECT_NEAR(min_strength(canny_edges(fading_step(1), {.low = 4})), 4, 0.3);
}

/// A picture of everything: blobs and noise.
GreyLevels textured(int width, int height, std::uint64_t seed) {
  RandomStream draws({seed, 3});
  cv::Mat image(height, width, CV_32F);
  for (float& value : cv::Mat_<float>(image)) value = static_cast<float>(draws.uniform(0, 255));
  cv::GaussianBlur(image, image, {0, 0}, 3);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  const GreyLevels smooth{width, height, {image.begin<float>(), image.end<float>()}};
  return test::with_noise(smooth, 2, draws);
}

TEST(CannyEdges, AreSortedOnceAPixelAndInStringsOfTheirLength) {
  const auto edges = canny_edges(textured(160, 120, 1));
  ASSERT_GT(edges.size(), 1000U);
  std::map<int, int> length;
  int strings = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (i > 0) {
      EXPECT_LT(std::pair(edges[i - 1].y, edges[i - 1].x), std::pair(edges[i].y, edges[i].x));
    }
    EXPECT_NEAR(edges[i].normal.norm(), 1, 1e-5);
    EXPECT_LE((edges[i].pixel_px - Eigen::Vector2f(edges[i].x, edges[i].y)).norm(), 1.07F);
    EXPECT_GT(edges[i].sigma_px, 0);
    EXPECT_LE(edges[i].string, strings);  // numbered by their first points
    strings = std::max(strings, edges[i].string + 1);
    ++length[edges[i].string];
  }
  for (const auto& [string, points] : length) EXPECT_GE(points, 10) << string;
}

/// Points of two strings are never neighbours.
TEST(CannyEdges, KeepConnectedPointsInOneString) {
  const auto edges = canny_edges(textured(160, 120, 2));
  std::map<std::pair<int, int>, int> at;
  for (const EdgePoint& point : edges) at[{point.x, point.y}] = point.string;
  for (const EdgePoint& point : edges) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto found = at.find({point.x + dx, point.y + dy});
        if (found != at.end()) {
          EXPECT_EQ(found->second, point.string);
        }
      }
    }
  }
}

/// How many points of `some` are in `others` too, as what `turned` makes of them.
double share_found(const std::vector<EdgePoint>& some,
                   const std::vector<EdgePoint>& others,
                   const std::function<EdgePoint(EdgePoint)>& turned) {
  std::map<std::pair<int, int>, EdgePoint> at;
  for (const EdgePoint& point : others) at[{point.x, point.y}] = point;
  int found = 0;
  for (const EdgePoint& point : some) {
    const EdgePoint expected = turned(point);
    const auto same = at.find({expected.x, expected.y});
    if (same == at.end()) continue;
    EXPECT_NEAR((same->second.pixel_px - expected.pixel_px).norm(), 0, 1e-3);
    EXPECT_NEAR((same->second.normal - expected.normal).norm(), 0, 1e-3);
    EXPECT_NEAR(same->second.sigma_px / expected.sigma_px, 1, 1e-2);
    ++found;
  }
  return static_cast<double>(found) / static_cast<double>(some.size());
}

/// Rows and columns, dark and bright are treated alike, but for the few points that are there only
/// to connect others: which of two stays goes by the order of the pixels.
TEST(CannyEdges, TurnWithTheImage) {
  const GreyLevels image = textured(90, 110, 4);
  GreyLevels turned{110, 90, {}}, negative = image;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 110; ++x) turned.values.push_back(image(y, x));
  }
  for (float& value : negative.values) value = 255 - value;
  const auto edges = canny_edges(image);
  ASSERT_GT(edges.size(), 800U);
  const auto transposed = [](EdgePoint point) {
    std::swap(point.x, point.y);
    point.pixel_px.reverseInPlace();
    point.normal.reverseInPlace();
    return point;
  };
  const auto reversed = [](EdgePoint point) {
    point.normal = -point.normal;
    return point;
  };
  EXPECT_GT(share_found(edges, canny_edges(turned), transposed), 0.98);
  EXPECT_GT(share_found(edges, canny_edges(negative), reversed), 0.995);
}

TEST(CannyEdges, AreTheSameForAnyNumberOfThreads) {
  const GreyLevels image = textured(300, 200, 5);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto one = canny_edges(image);
  cv::setNumThreads(4);
  const auto four = canny_edges(image);
  cv::setNumThreads(threads);
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].pixel_px, four[i].pixel_px);
    EXPECT_EQ(one[i].sigma_px, four[i].sigma_px);
    EXPECT_EQ(one[i].string, four[i].string);
  }
}

TEST(CannyEdges, HasNoneInAnImageThatIsEmptyBlankTooSmallOrNoiseOnly) {
  EXPECT_TRUE(canny_edges({}).empty());
  EXPECT_TRUE(canny_edges({0, 5, {}}).empty());
  EXPECT_TRUE(canny_edges({100, 80, std::vector<float>(8000, 128)}).empty());
  EXPECT_TRUE(canny_edges({100, 80, std::vector<float>(8000, 255)}).empty());
  for (int size = 1; size <= 9; ++size) {
    GreyLevels image{size, size, std::vector<float>(static_cast<std::size_t>(size * size), 10)};
    for (int y = 0; y < size; ++y) image.values[static_cast<std::size_t>(y * size + size / 2)] = 99;
    EXPECT_TRUE(canny_edges(image).empty()) << size;
  }
  GreyLevels narrow{400, 6, std::vector<float>(2400, 10)};
  EXPECT_TRUE(canny_edges(narrow).empty());
  RandomStream draws({34});
  const GreyLevels grey{200, 200, std::vector<float>(40000, 128)};
  EXPECT_TRUE(canny_edges(test::with_noise(grey, 1, draws)).empty());
}

TEST(CannyEdges, RefusesBadArguments) {
  const GreyLevels image{30, 30, std::vector<float>(900, 7)};
  const auto error = [&](const GreyLevels& of, const CannyOptions& options) {
    return test::error_message([&] { canny_edges(of, options); });
  };
  EXPECT_NE(error({30, 30, std::vector<float>(899, 7)}, {}).find("size"), std::string::npos);
  EXPECT_NE(error({-30, -30, std::vector<float>(900, 7)}, {}).find("size"), std::string::npos);
  GreyLevels broken = image;
  broken.values[77] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(error(broken, {}).find("finite"), std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double scale : {0.0, -1.0, 0.4, 21.0, nan}) {
    EXPECT_NE(error(image, {.scale_px = scale}).find("scale"), std::string::npos) << scale;
  }
  EXPECT_NE(error(image, {.low = 0}).find("thresholds"), std::string::npos);
  EXPECT_NE(error(image, {.low = 6}).find("thresholds"), std::string::npos);
  EXPECT_NE(error(image, {.high = nan}).find("thresholds"), std::string::npos);
  EXPECT_EQ(error(image, {}), "");
}

}  // namespace
}  // namespace vernier
